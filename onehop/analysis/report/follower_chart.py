"""Each follower over time: distance to its leader, throughput, k_rho, SNR, BER and formation error."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from onehop.analysis.palette import BAD, INK
from onehop.analysis.report.canvas import mark_turns
from onehop.analysis.report.report_data import ReportData
from onehop.analysis.tables import Table
from robot_agent.core.team.team_messages import Command

Series = tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]
"""Times [s] and values."""

ROLLING_S = 10.0
"""Width of the rolling mean [s]: five periods of Next."""

BER_FLOOR = 1e-9
"""Bit error rates below this are drawn at it: the axis is logarithmic, and most are 0."""

_GRID_S = 0.5


def follower_chart(material: ReportData) -> Figure:
    """Six panels over one time axis."""
    panels: tuple[tuple[str, Callable[[ReportData, int], Series], bool], ...] = (
        ("distance to\nleader [m]", leader_distance, False),
        ("throughput\n[kb/s]", throughput, True),
        ("k_rho [1/s]", k_rho, False),
        ("SNR of Next\n[dB]", snr, True),
        ("BER of Next", bit_errors, False),
        ("error to\nslot [m]", formation_error, True),
    )
    figure = Figure(figsize=(10.0, 11.0))
    all_axes = figure.subplots(len(panels), 1, sharex=True)
    figure.subplots_adjust(left=0.085, right=0.98, top=0.945, bottom=0.04, hspace=0.12)
    for number, (axes, (name, values, rolling)) in enumerate(zip(all_axes, panels, strict=True)):
        axes.set_ylabel(name)
        mark_turns(axes, material, named=number == 0)
        for robot in material.robots:
            _draw(axes, values(material, robot), material.colours[robot], rolling)
    _draw_threshold(all_axes[1], material)
    _scale_errors(all_axes[4])
    all_axes[4].annotate(
        "0 is drawn at 1e-9", (1.0, 0.0), xycoords="axes fraction", xytext=(-4, 5), ha="right",
        textcoords="offset points", fontsize=7.5, color=INK,
    )  # fmt: skip
    all_axes[-1].set_xlabel("time [s]")
    all_axes[-1].set_xlim(0.0, max(material.end_s, material.period_s))
    _draw_legend(figure, material)
    return figure


def _scale_errors(axes: Axes) -> None:
    axes.set_yscale("log")
    axes.set_ylim(BER_FLOOR / 2, 1.0)
    axes.set_yticks([1e-9, 1e-6, 1e-3, 1.0], ["1e-9", "1e-6", "1e-3", "1"])
    axes.minorticks_off()


def _draw(axes: Axes, series: Series, colour: str, rolling: bool) -> None:
    times, values = series
    if not len(times):
        return
    if not rolling:
        axes.plot(times, values, color=colour, linewidth=1.2, zorder=3)
        return
    axes.plot(times, values, color=colour, linewidth=0.6, alpha=0.3, zorder=2)
    axes.plot(times, rolling_mean(times, values), color=colour, linewidth=1.5, zorder=3)


def rolling_mean(
    times: npt.NDArray[np.float64], values: npt.NDArray[np.float64], width_s: float = ROLLING_S
) -> npt.NDArray[np.float64]:
    """Mean of the values within width_s around each time; gaps (nan) stay gaps."""
    known = np.isfinite(values)
    total = np.concatenate(([0.0], np.cumsum(np.where(known, values, 0.0))))
    count = np.concatenate(([0], np.cumsum(known)))
    first = np.searchsorted(times, times - width_s / 2, side="left")
    last = np.searchsorted(times, times + width_s / 2, side="right")
    number = count[last] - count[first]
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = (total[last] - total[first]) / number
    return np.where(known, mean, np.nan)


def _stride(material: ReportData) -> int:
    """Ticks between two steps of the figure."""
    return max(1, round(_GRID_S / material.period_s))


def _following(material: ReportData, robot: int) -> Table:
    """Status of a robot while it obeys another one, at the steps of the figure."""
    own = material.tables["status"].of(robot)
    own = own.where(own["tick"] % _stride(material) == 0)
    return own.where((own["leader"] != robot) & (own["leader"] != 0))


def _gapped(times: npt.NDArray[np.float64], values: npt.NDArray[np.float64], gap_s: float) -> Series:
    """The series with a nan where time jumps, so that no line bridges an absence."""
    jumps = np.flatnonzero(np.diff(times) > gap_s) + 1
    return np.insert(times, jumps, times[jumps] - 1e-6), np.insert(values, jumps, np.nan)


def leader_distance(material: ReportData, robot: int) -> Series:
    """To the leader that the robot obeys, from ground truth [m]."""
    own, poses = _following(material, robot), material.tables["poses"]
    poses = poses.where(poses["tick"] % _stride(material) == 0)
    keys = zip(poses["tick"].tolist(), poses["robot"].tolist(), strict=True)
    place = {key: row for row, key in enumerate(keys)}
    rows = [
        (time_s, place[tick, robot], place[tick, leader])
        for time_s, tick, leader in zip(
            own["time_s"].tolist(), own["tick"].tolist(), own["leader"].tolist(), strict=True
        )
        if (tick, leader) in place and (tick, robot) in place
    ]
    if not rows:
        return np.empty(0), np.empty(0)
    times, mine, theirs = (np.array(column) for column in zip(*rows, strict=True))
    x, y = poses["x"], poses["y"]
    return _gapped(times, np.hypot(x[mine] - x[theirs], y[mine] - y[theirs]), 2 * _GRID_S)


def throughput(material: ReportData, robot: int) -> Series:
    """As the robot measured it on Next [kb/s]; 0 when that Next is missing."""
    own = _following(material, robot)
    return _gapped(own["time_s"], own["throughput_bps"] / 1e3, 2 * _GRID_S)


def k_rho(material: ReportData, robot: int) -> Series:
    """Gain in force [1/s]."""
    own = _following(material, robot)
    return _gapped(own["time_s"], own["k_rho"], 2 * _GRID_S)


def formation_error(material: ReportData, robot: int) -> Series:
    """Distance to its slot, as the robot sees it [m]."""
    own = _following(material, robot)
    return _gapped(own["time_s"], own["error"], 2 * _GRID_S)


def snr(material: ReportData, robot: int) -> Series:
    """Of each Next that came [dB]."""
    return _of_next(material, robot, lambda frame: frame.snr_db)


def bit_errors(material: ReportData, robot: int) -> Series:
    """Of each Next that came, at least BER_FLOOR."""
    return _of_next(material, robot, lambda frame: max(frame.bit_error_rate, BER_FLOOR))


def _of_next(material: ReportData, robot: int, value: Callable[..., float]) -> Series:
    period = material.log.scenario.team.next_period
    chosen = [
        (frame.arrival_s, value(frame))
        for frame in material.frames
        if frame.receiver == robot and frame.delivered and isinstance(frame.message, Command)
    ]
    if not chosen:
        return np.empty(0), np.empty(0)
    times, values = (np.array(column) for column in zip(*sorted(chosen), strict=True))
    return _gapped(times, values, 2.5 * period)


def _draw_threshold(axes: Axes, material: ReportData) -> None:
    status = material.tables["status"]
    followers = status["leader"] != status["robot"]
    thresholds = np.unique(status["threshold_bps"][followers & (status["threshold_bps"] > 0)])
    for threshold in thresholds.tolist():
        axes.axhline(threshold / 1e3, color=BAD, linewidth=1.2, linestyle=(0, (6, 3)), zorder=4)
        axes.annotate(
            f"threshold {threshold / 1e3:.0f}: below it the robot hurries", (1.0, threshold / 1e3),
            xycoords=("axes fraction", "data"), xytext=(-4, 3), textcoords="offset points", ha="right",
            fontsize=8, color=BAD,
        )  # fmt: skip


def _draw_legend(figure: Figure, material: ReportData) -> None:
    handles = []
    for robot, colour in material.colours.items():
        dead = material.dead.get(robot)
        name = f"{robot} (gone at {dead.at_s:.0f} s)" if dead else f"{robot}"
        handles.append(Line2D([], [], color=colour, linewidth=2.5, label=name))
    handles.append(Line2D([], [], color=INK, linewidth=0.6, alpha=0.4, label="as it was"))
    handles.append(Line2D([], [], color=INK, linewidth=1.5, label=f"mean over {ROLLING_S:g} s"))
    figure.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(0.08, 0.998), ncols=10, frameon=False,
        fontsize=8.5, handlelength=1.4, columnspacing=1.2,
    )  # fmt: skip
