"""The figures of 4.2 again: executions, SNR, throughput, hops and bit error rate of each follower.

Constant and variable k_rho are laid over each other, so that one sees in one panel what the thesis shows
in two.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from onehop.analysis.log import Log
from onehop.analysis.palette import BAD, FAINT, INK
from onehop.analysis.report.canvas import save, styled
from onehop.analysis.report.follower_chart import (
    BER_FLOOR,
    ROLLING_S,
    Series,
    of_next,
    rolling_mean,
    snr,
    thesis_bit_errors,
    throughput,
)
from onehop.analysis.report.report_data import ReportData, gather
from onehop.analysis.trajectory import draw_mission
from onehop.study.chapter4.claims import ROUTING_WORD
from onehop.study.chapter4.missions import CONSTANT, VARIABLE
from onehop.study.chapter4.reported import REPORTED
from onehop.study.chapter4.shown import Place
from onehop.study.page import Picture
from radio_proxy.core.error_rates import thesis_ber
from radio_proxy.core.link_budget import link_budget

COLOURS = {CONSTANT: "#D55E00", VARIABLE: "#0072B2"}
NAMES = {CONSTANT: "constant k_rho", VARIABLE: "variable k_rho"}

_ROW_HEIGHT = 1.5
"""Of one follower's panels [inch]."""

_BIN_DB = 1.0
"""Width of a step of received power [dB]."""


Reports = Mapping[str, ReportData]
"""Of each policy."""


def draw(shown: Mapping[Place, Mapping[str, Log]], folder: Path) -> Iterator[Picture]:
    """Write the figures of every place, and say what they show."""
    for (ground, routing), of_policy in shown.items():
        reports = {policy: gather(log) for policy, log in of_policy.items()}
        seed = next(iter(reports.values())).log.scenario.seed
        with styled():
            for kind, title, note, figure in (
                ("executions", "executions", _EXECUTIONS, executions),
                ("links", "SNR, throughput and hops", _LINKS, links),
                ("ber", "bit error rate", _BER, bit_errors),
            ):
                path = save(figure(reports), folder, f"{ground}-{routing}-{kind}")
                thesis = REPORTED[ground, routing, CONSTANT].figure.partition(",")[0].rstrip(" a")
                where = f"{ground}, {ROUTING_WORD[routing]}: {title}"
                told = f"{note} Seed {seed}." + (f" Thesis: {thesis}." if kind == "executions" else "")
                yield Picture(where, told, path)


_EXECUTIONS = (
    "Left constant, right variable k_rho, along the same way of the leader. Squares: where followers "
    "were held. Crosses: where lost robots were last. Every 20 s the formation is drawn."
)
_LINKS = (
    "Each row a follower; orange constant, blue variable k_rho, over each other. Thin: each value; "
    f"thick: its mean over {ROLLING_S:g} s. Grey: the followers are held. Dashed: the receive threshold "
    "of 32 dB, and the throughput below which a follower hurries. A line ends where the robot is lost; "
    "throughput 0 is a Next that did not come."
)
_BER = (
    "The bit error rate of eq. 3.24 and 3.25, read literally, of each Next that came: the thesis's own "
    "curve, which decides nothing here (the modulation's is 0 at these SNRs). Left against time. Right "
    "against received power: the curve, and which share of the Nexts came with that power."
)


def executions(reports: Reports) -> Figure:
    """Where everybody drove, one panel a policy."""
    figure = Figure(figsize=(11.5, 6.3))
    figure.subplots_adjust(left=0.045, right=0.995, top=0.955, bottom=0.12, wspace=0.1)
    for axes, (policy, report) in zip(figure.subplots(1, 2), reports.items(), strict=True):
        axes.grid(visible=False)
        draw_mission(axes, report.log, report.tables, name_holds=False)
        _mark_lost(axes, report)
        axes.set_title(f"{NAMES[policy]}: {_ending(report)}", loc="left", fontsize=10)
    handles = [
        Line2D([], [], color=colour, linewidth=2.5, label=f"robot {robot}")
        for robot, colour in next(iter(reports.values())).colours.items()
    ]
    figure.legend(handles=handles, loc="lower center", ncols=len(handles), frameon=False)
    return figure


def _mark_lost(axes: Axes, report: ReportData) -> None:
    """A cross where a robot of those that were lost was last."""
    for robot in _lost(report):
        own = report.tables["poses"].of(robot)
        if len(own):
            spot = float(own["x"][-1]), float(own["y"][-1])
            axes.plot(*spot, marker="x", markersize=11, color=BAD, markeredgewidth=3.0, zorder=10)
            axes.annotate(
                f"{robot} lost", spot, textcoords="offset points", xytext=(9, -12), fontsize=9,
                fontweight="bold", color=BAD, zorder=10,
            )  # fmt: skip


def _lost(report: ReportData) -> list[int]:
    summary = report.log.summary or {}
    return [one["robot"] for one in summary.get("lost", ())]


def _ending(report: ReportData) -> str:
    lost, sim_s = _lost(report), (report.log.summary or {}).get("sim_s", 0.0)
    who = f"robot{'s' if len(lost) > 1 else ''} {', '.join(map(str, lost))} lost"
    return f"{who if lost else 'nobody lost'}, {sim_s:.0f} s"


def links(reports: Reports) -> Figure:
    """SNR, throughput and hops against time, a row for each follower."""
    followers = _followers(reports)
    figure = _rows_of(len(followers))
    panels: tuple[tuple[str, Callable[[ReportData, int], Series]], ...] = (
        ("SNR of Next [dB]", snr), ("throughput [kb/s]", throughput), ("hops of Next", hops),
    )  # fmt: skip
    grid = figure.subplots(len(followers), len(panels), sharex=True, sharey="col", squeeze=False)
    for row, robot in zip(grid, followers, strict=True):
        for axes, (name, values) in zip(row, panels, strict=True):
            _shade_holds(axes, reports)
            for policy, report in reports.items():
                _line(axes, values(report, robot), COLOURS[policy], smooth=values is not hops)
            axes.set_title(name if robot == followers[0] else "", fontsize=10)
        row[0].set_ylabel(f"robot {robot}", fontweight="bold")
        _threshold(row[0], _receive_threshold_db(reports))
        _threshold(row[1], _hurry_kbps(reports, robot))
        row[2].set_yticks(range(1, 1 + max(2, _most_hops(reports))))
    for axes in grid[-1]:
        axes.set_xlabel("time [s]")
    _legend(figure, reports)
    return figure


def bit_errors(reports: Reports) -> Figure:
    """The thesis's bit error rate against time, and against received power."""
    followers = _followers(reports)
    figure = _rows_of(len(followers))
    grid = figure.subplots(len(followers), 2, sharex="col", sharey=True, squeeze=False)
    for row, robot in zip(grid, followers, strict=True):
        _shade_holds(row[0], reports)
        for policy, report in reports.items():
            _line(row[0], thesis_bit_errors(report, robot), COLOURS[policy], smooth=False)
        row[0].set_yscale("log")
        row[0].set_ylim(BER_FLOOR, 1.0)
        row[0].set_yticks([1e-6, 1e-4, 1e-2, 1.0], ["1e-6", "1e-4", "1e-2", "1"])
        row[0].minorticks_off()
        row[0].set_ylabel(f"robot {robot}", fontweight="bold")
        _against_power(row[1], reports, robot)
    grid[0][0].set_title("BER of Next (eq. 3.25) against time", fontsize=10)
    grid[0][1].set_title("BER against received power, and share of the Nexts", fontsize=10)
    grid[-1][0].set_xlabel("time [s]")
    grid[-1][1].set_xlabel("received power [dBm]")
    _legend(figure, reports)
    return figure


def _rows_of(count: int) -> Figure:
    """An empty figure with room for so many rows. Laid out by hand: it takes a fifth of the time."""
    height = 0.95 + _ROW_HEIGHT * count
    figure = Figure(figsize=(11.5, height))
    figure.subplots_adjust(
        left=0.055, right=0.955, top=1.0 - 0.55 / height, bottom=0.42 / height, hspace=0.14, wspace=0.13
    )
    return figure


def hops(report: ReportData, robot: int) -> Series:
    """Of each Next that came."""
    return of_next(report, robot, lambda trace: float(len(trace.path) - 1))


def _against_power(axes: Axes, reports: Reports, robot: int) -> None:
    scenario = next(iter(reports.values())).log.scenario
    noise_dbm = link_budget(scenario.radio).noise_dbm
    powers = {
        policy: values[np.isfinite(values)] + noise_dbm
        for policy, (_, values) in ((name, snr(one, robot)) for name, one in reports.items())
    }
    known = np.concatenate(list(powers.values()))
    if not len(known):
        return
    low, high = np.floor(known.min()), np.ceil(known.max()) + _BIN_DB
    curve = np.linspace(low, high, 200)
    bits = 8 * scenario.team.next_msdu_bytes
    axes.plot(curve, [thesis_ber(power - noise_dbm, bits) for power in curve], color=INK, linewidth=1.2)
    shares: Axes = axes.twinx()
    shares.grid(visible=False)
    shares.spines["right"].set_visible(True)
    for policy, values in powers.items():
        if len(values):
            weights = np.full(len(values), 100.0 / len(values))
            shares.hist(
                values, bins=np.arange(low, high + _BIN_DB, _BIN_DB).tolist(), weights=weights,
                histtype="step", color=COLOURS[policy], linewidth=1.3,
            )  # fmt: skip
    shares.set_ylabel("share [%]", fontsize=8)
    shares.set_ylim(0.0, max(shares.get_ylim()[1], 1.0))


def _followers(reports: Reports) -> list[int]:
    """All but who leads first."""
    report = next(iter(reports.values()))
    first = report.main_terms[0].leader if report.main_terms else 0
    return [robot for robot in report.robots if robot != first]


def _line(axes: Axes, series: Series, colour: str, smooth: bool) -> None:
    """smooth: the values thin, and their mean over some seconds thick above them."""
    times, values = series
    axes.plot(
        times, values, color=colour, linewidth=0.7 if smooth else 1.1, alpha=0.4 if smooth else 0.9
    )
    if smooth and len(times):
        axes.plot(times, rolling_mean(times, values), color=colour, linewidth=1.6)


def _shade_holds(axes: Axes, reports: Reports) -> None:
    for start_s, end_s in sorted(
        {
            (round(span.start_s), round(span.end_s))
            for report in reports.values()
            for span in report.faults
            if span.what.startswith("hold")
        }
    ):
        axes.axvspan(start_s, end_s, color="#ECECEC", linewidth=0, zorder=0)


def _threshold(axes: Axes, value: float) -> None:
    axes.axhline(value, color=FAINT, linewidth=1.0, linestyle="--", zorder=1)


def _receive_threshold_db(reports: Reports) -> float:
    return link_budget(next(iter(reports.values())).log.scenario.radio).receive_threshold_db


def _hurry_kbps(reports: Reports, robot: int) -> float:
    """The threshold that the robot named first as a follower [kb/s]."""
    own = next(iter(reports.values())).tables["status"].of(robot)
    said = own["threshold_bps"][(own["leader"] != robot) & (own["threshold_bps"] > 0)]
    return float(said[0]) / 1e3 if len(said) else np.nan


def _most_hops(reports: Reports) -> int:
    return max(
        (len(t.path) - 1 for one in reports.values() for t in one.traces if t.delivered), default=1
    )


def _legend(figure: Figure, reports: Reports) -> None:
    handles = [
        Line2D([], [], color=COLOURS[policy], linewidth=2.0, label=f"{NAMES[policy]}: {_ending(report)}")
        for policy, report in reports.items()
    ]
    figure.legend(handles=handles, loc="upper left", ncols=2, frameon=False, fontsize=10)
