"""Each follower over time: distance to its leader, throughput, k_rho, SNR, BER and formation error."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from onehop.analysis.message_traces import MessageTrace
from onehop.analysis.palette import BAD, INK
from onehop.analysis.report.canvas import mark_turns
from onehop.analysis.report.report_data import ReportData
from onehop.analysis.tables import Table
from radio_proxy.core.error_rates import thesis_ber
from robot_agent.core.team.team_messages import Command

Series = tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]
"""Times [s] and values."""

ROLLING_S = 10.0
"""Width of the rolling mean [s]: five periods of Next."""

BER_FLOOR = 1e-6
"""Bit error rates below this are drawn at it: the axis is logarithmic, and a frame of 800 B with so few
bit errors is lost once in 150 times by them."""

_GRID_S = 0.5

_SHARE = 0.01
"""A threshold that fewer of all statuses name is not drawn: a robot can say another one every tick."""


def follower_chart(report: ReportData) -> Figure:
    """Six panels over one time axis."""
    panels: tuple[tuple[str, Callable[[ReportData, int], Series], bool], ...] = (
        ("distance to\nleader [m]", leader_distance, False),
        ("throughput\n[kb/s]", throughput, True),
        ("k_rho [1/s]", k_rho, False),
        ("SNR of Next\n[dB]", snr, True),
        ("BER of Next", thesis_bit_errors, True),
        ("error to\nslot [m]", formation_error, True),
    )
    figure = Figure(figsize=(10.0, 11.0))
    all_axes = figure.subplots(len(panels), 1, sharex=True)
    figure.subplots_adjust(left=0.085, right=0.98, top=0.945, bottom=0.04, hspace=0.12)
    for number, (axes, (name, values, rolling)) in enumerate(zip(all_axes, panels, strict=True)):
        axes.set_ylabel(name)
        mark_turns(axes, report, named=number == 0)
        for robot in report.robots:
            _draw(axes, values(report, robot), report.colours[robot], rolling)
    _draw_threshold(all_axes[1], report)
    _draw_modulation_errors(all_axes[4], report)
    all_axes[-1].set_xlabel("time [s]")
    all_axes[-1].set_xlim(0.0, max(report.end_s, report.period_s))
    _draw_legend(figure, report)
    return figure


def _draw_modulation_errors(axes: Axes, report: ReportData) -> None:
    """Beside the thesis's bit error rate that of the modulation, and which of the two decides."""
    for robot in report.robots:
        times, values = modulation_bit_errors(report, robot)
        axes.plot(times, values, color=report.colours[robot], linewidth=1.6, linestyle=":", zorder=4)
    axes.set_yscale("log")
    axes.set_ylim(BER_FLOOR / 2, 1.0)
    axes.set_yticks([1e-6, 1e-4, 1e-2, 1.0], ["1e-6", "1e-4", "1e-2", "1"])
    axes.minorticks_off()
    axes.legend(
        handles=[
            Line2D([], [], color=INK, linewidth=1.5, label="thesis eq. 3.25: only drawn"),
            Line2D(
                [], [], color=INK, linewidth=1.6, linestyle=":",
                label="the modulation's own: decides loss (drawn at 1e-6 when lower)",
            ),
        ],
        loc="lower left", bbox_to_anchor=(0.0, 0.09), ncols=2, fontsize=7.5, framealpha=0.8,
        edgecolor="none", borderpad=0.2, handlelength=2.2,
    )  # fmt: skip


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


def _stride(report: ReportData) -> int:
    """Ticks between two steps of the figure."""
    return max(1, round(_GRID_S / report.period_s))


def _following(report: ReportData, robot: int) -> Table:
    """Status of a robot while it obeys another one, at the steps of the figure."""
    own = report.tables["status"].of(robot)
    own = own.where(own["tick"] % _stride(report) == 0)
    return own.where((own["leader"] != robot) & (own["leader"] != 0))


def _gapped(times: npt.NDArray[np.float64], values: npt.NDArray[np.float64], gap_s: float) -> Series:
    """The series with a nan where time jumps, so that no line bridges an absence."""
    jumps = np.flatnonzero(np.diff(times) > gap_s) + 1
    return np.insert(times, jumps, times[jumps] - 1e-6), np.insert(values, jumps, np.nan)


def leader_distance(report: ReportData, robot: int) -> Series:
    """To the leader that the robot obeys, from ground truth [m]."""
    own, poses = _following(report, robot), report.tables["poses"]
    poses = poses.where(poses["tick"] % _stride(report) == 0)
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


def throughput(report: ReportData, robot: int) -> Series:
    """As the robot measured it on Next [kb/s]; 0 when that Next is missing."""
    own = _following(report, robot)
    return _gapped(own["time_s"], own["throughput_bps"] / 1e3, 2 * _GRID_S)


def k_rho(report: ReportData, robot: int) -> Series:
    """Gain in force [1/s]."""
    own = _following(report, robot)
    return _gapped(own["time_s"], own["k_rho"], 2 * _GRID_S)


def formation_error(report: ReportData, robot: int) -> Series:
    """Distance to its slot, as the robot sees it [m]."""
    own = _following(report, robot)
    return _gapped(own["time_s"], own["error"], 2 * _GRID_S)


def snr(report: ReportData, robot: int) -> Series:
    """Of each Next that came [dB]."""
    return of_next(report, robot, lambda trace: trace.snr_db)


def modulation_bit_errors(report: ReportData, robot: int) -> Series:
    """Bit error rate of the modulation on each Next that came, at least BER_FLOOR: it decides loss."""
    return of_next(report, robot, lambda trace: max(trace.bit_error_rate, BER_FLOOR))


def thesis_bit_errors(report: ReportData, robot: int) -> Series:
    """The thesis's bit error rate (eq. 3.24, 3.25 read literally) of each Next that came.

    At least BER_FLOOR. The bits of a packet are those of its MSDU, as in `onehop link`.
    """
    return of_next(
        report, robot, lambda trace: max(thesis_ber(trace.snr_db, 8 * trace.msdu_bytes), BER_FLOOR)
    )


def of_next(report: ReportData, robot: int, value: Callable[[MessageTrace], float]) -> Series:
    """A value of each Next that came to a robot, at its arrival; a gap where several did not come."""
    period = report.log.scenario.team.next_period
    chosen = [
        (trace.arrival_s, value(trace))
        for trace in report.traces
        if trace.receiver == robot and trace.delivered and isinstance(trace.message, Command)
    ]
    if not chosen:
        return np.empty(0), np.empty(0)
    times, values = (np.array(column) for column in zip(*sorted(chosen), strict=True))
    return _gapped(times, values, 2.5 * period)


def _draw_threshold(axes: Axes, report: ReportData) -> None:
    status = report.tables["status"]
    followers = status["leader"] != status["robot"]
    said = status["threshold_bps"][followers & (status["threshold_bps"] > 0)]
    thresholds, counts = np.unique(said[np.isfinite(said)], return_counts=True)
    for threshold in thresholds[counts >= _SHARE * len(said)].tolist():
        axes.axhline(threshold / 1e3, color=BAD, linewidth=1.2, linestyle=(0, (6, 3)), zorder=4)
        axes.annotate(
            f"threshold {threshold / 1e3:.0f}: below it the robot hurries", (1.0, threshold / 1e3),
            xycoords=("axes fraction", "data"), xytext=(-4, 3), textcoords="offset points", ha="right",
            fontsize=8, color=BAD,
        )  # fmt: skip


def _draw_legend(figure: Figure, report: ReportData) -> None:
    handles = []
    for robot, colour in report.colours.items():
        dead = report.dead.get(robot)
        name = f"{robot} (gone at {dead.at_s:.0f} s)" if dead else f"{robot}"
        handles.append(Line2D([], [], color=colour, linewidth=2.5, label=name))
    handles.append(Line2D([], [], color=INK, linewidth=0.6, alpha=0.4, label="each value"))
    handles.append(Line2D([], [], color=INK, linewidth=1.5, label=f"mean over {ROLLING_S:g} s"))
    figure.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(0.08, 0.998), ncols=10, frameon=False,
        fontsize=8.5, handlelength=1.4, columnspacing=1.2,
    )  # fmt: skip
