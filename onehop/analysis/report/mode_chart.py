"""The timeline: who led in which shape, what every robot was doing, which faults were in force."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from onehop.analysis.palette import BAD, FAINT, INK
from onehop.analysis.report.report_data import ReportData
from onehop.analysis.timeline import Span, spans
from onehop.contracts.printable import printable
from onehop.contracts.team import Mode

SHORTEST_S = 1.0
"""Modes that last less are drawn as part of the one before [s]: border following comes and goes."""

_HEIGHT = 0.62
_LETTER = 0.0085
"""Width of a letter in a band, as a share of the axis; a name that does not fit is left out."""

_LOOKS: dict[str, tuple[float, str, str]] = {
    Mode.LEADING: (1.0, "", "leading"),
    Mode.ALONE: (1.0, "xx", "alone"),
    Mode.FOLLOWING: (0.32, "", "following"),
    Mode.NARROW: (0.32, "....", "in column"),
    Mode.BORDER: (0.62, "", "around obstacle"),
    Mode.GIVING_WAY: (0.32, "//", "giving way"),
    Mode.SETUP: (0.10, "", "setup"),
    Mode.STOPPED: (0.10, "||", "stopped"),
}
"""Mode -> opacity of the robot's own colour, hatch, and name in the legend."""

_ALARM = {Mode.LOST_LEADER: ("#F4A6A0", "lost leader"), Mode.JOINING: ("#F6D776", "asking to join")}
"""Modes without a leader have a colour of their own."""


def mode_chart(report: ReportData) -> Figure:
    """The figure; one row a robot, above them leader, shape and faults."""
    rows = len(report.robots)
    lanes = _lanes(report.faults)
    top = 2 + len(lanes)
    height = 0.85 + 0.34 * (rows + top)
    figure = Figure(figsize=(10.0, height))
    axes = figure.add_axes((0.085, 0.45 / height, 0.895, 1.0 - 0.85 / height))
    axes.set_xlim(0.0, max(report.end_s, report.period_s))
    place = {robot: rows - 1 - number for number, robot in enumerate(report.robots)}
    seen: set[str] = set()
    for robot in report.robots:
        _draw_modes(axes, report, robot, place[robot], seen)
    _draw_leaders(axes, report, rows)
    for lane, content in enumerate(lanes):
        _draw_bands(axes, content, rows + 2 + lane, "#F3D6D6", BAD)
    for one in report.gone:
        axes.plot(one.at_s, place[one.robot], marker="X", color=BAD, markersize=9, zorder=5)
        axes.annotate(
            printable(one.why, 80), (one.at_s, place[one.robot]), textcoords="offset points",
            xytext=(8, -3), fontsize=8, color=BAD, zorder=6,
        )  # fmt: skip
    _label(axes, report, rows, top)
    _explain_looks(figure, report, seen)
    return figure


def _lanes(faults: list[Span]) -> list[list[Span]]:
    """Faults in as few rows as they need not to cover each other."""
    lanes: list[list[Span]] = []
    for span in faults:
        for lane in lanes:
            if lane[-1].end_s < span.start_s:
                lane.append(span)
                break
        else:
            lanes.append([span])
    return lanes


def _draw_modes(axes: Axes, report: ReportData, robot: int, row: int, seen: set[str]) -> None:
    own = report.tables["status"].of(robot)
    colour = report.colours[robot]
    by_mode: dict[str, list[tuple[float, float]]] = {}
    for span in spans(own["time_s"], own["mode"], 1.5 * report.period_s, SHORTEST_S):
        length = span.end_s - span.start_s + report.period_s
        by_mode.setdefault(span.what, []).append((span.start_s, length))
    for mode, ranges in sorted(by_mode.items()):
        seen.add(mode)
        face, hatch = _look(mode, colour)
        axes.broken_barh(
            ranges, (row - _HEIGHT / 2, _HEIGHT), facecolor=face, edgecolor=colour if hatch else "none",
            hatch=hatch, linewidth=0, zorder=3,
        )  # fmt: skip


def _look(mode: str, colour: str) -> tuple[tuple[float, float, float, float], str]:
    if mode in _ALARM:
        return to_rgba(_ALARM[Mode(mode)][0]), ""
    opacity, hatch, _ = _LOOKS[mode]
    return to_rgba(colour, opacity), hatch


def _draw_leaders(axes: Axes, report: ReportData, rows: int) -> None:
    terms = report.main_terms
    ends = [*(term.at_s for term in terms[1:]), report.end_s] if terms else []
    times = np.array([term.at_s for term in terms])
    for names, row in (
        ([f"{term.leader}" for term in terms], rows),
        ([str(term.shape) for term in terms], rows + 1),
    ):
        merged: list[Span] = []
        for start_s, end_s, name in zip(times.tolist(), ends, names, strict=True):
            if merged and merged[-1].what == name:
                merged[-1] = Span(merged[-1].start_s, end_s, name)
            else:
                merged.append(Span(start_s, end_s, name))
        for name in sorted({span.what for span in merged}):
            leading = row == rows
            face = report.colours[int(name)] if leading else "#E9E6DF"
            own = [span for span in merged if span.what == name]
            _draw_bands(axes, own, row, face, "white" if leading else INK)


def _draw_bands(axes: Axes, bands: list[Span], row: float, face: str, ink: str) -> None:
    """Bands of one look; each with its name, if there is room for it."""
    ranges = [(span.start_s, max(span.end_s - span.start_s, 0.2)) for span in bands]
    axes.broken_barh(
        ranges, (row - _HEIGHT / 2, _HEIGHT), facecolor=face, edgecolor="white", linewidth=0.8, zorder=3
    )
    for span, (start_s, length) in zip(bands, ranges, strict=True):
        room = length / (_LETTER * axes.get_xlim()[1])
        name = next((text for text in (span.what, span.what.split(" at ")[0]) if len(text) <= room), "")
        if name:
            axes.text(
                start_s + length / 2, row, name, ha="center", va="center", fontsize=8, color=ink,
                clip_on=True, zorder=4, fontweight="bold" if ink == "white" else "normal",
            )  # fmt: skip


def _label(axes: Axes, report: ReportData, rows: int, top: int) -> None:
    names = [f"robot {robot}" for robot in reversed(report.robots)]
    names += ["leader", "shape", *["faults"] * (top - 2)]
    axes.set_yticks(range(rows + top), names)
    for robot, text in zip(reversed(report.robots), axes.get_yticklabels(), strict=False):
        text.set_color(report.colours[robot])
        text.set_fontweight("bold")
        if robot in report.dead:
            row = rows - 1 - report.robots.index(robot)
            axes.annotate(
                "", (-0.070, row), (-0.006, row), xycoords=("axes fraction", "data"),
                arrowprops={"arrowstyle": "-", "color": BAD, "linewidth": 1.6}, annotation_clip=False,
            )  # fmt: skip
    axes.axhline(rows - 0.5, color=FAINT, linewidth=0.8)
    axes.set_ylim(-0.6, rows + top - 0.4)
    axes.set_xlabel("time [s]")
    axes.grid(axis="y", visible=False)
    axes.tick_params(axis="y", length=0)


def _explain_looks(figure: Figure, report: ReportData, seen: set[str]) -> None:
    colour = "#777777"
    handles = []
    for mode, (_, _, name) in _LOOKS.items():
        if mode in seen:
            face, hatch = _look(mode, colour)
            handles.append(
                Patch(facecolor=face, edgecolor=colour, hatch=hatch, linewidth=0.4, label=name)
            )
    handles += [
        Patch(facecolor=face, label=name) for mode, (face, name) in _ALARM.items() if mode in seen
    ]
    if report.gone:
        handles.append(Patch(facecolor=BAD, label="gone"))
    figure.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(0.08, 1.0), ncols=12,
        frameon=False, fontsize=8, handlelength=1.6, columnspacing=0.8,
    )  # fmt: skip
