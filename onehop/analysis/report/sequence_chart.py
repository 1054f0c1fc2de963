"""The messages of an election as a sequence diagram: one lifeline a robot, time downwards.

Only rows in which something was sent or noted are drawn; a stretch without any is one grey band with its
length, because the silence is what elects.
"""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from onehop.analysis.message_traces import MessageTrace
from onehop.analysis.palette import BAD, INK
from onehop.analysis.report.election_rows import Row, election_rows, silences
from onehop.analysis.report.report_data import ReportData
from onehop.contracts.messages import LeadershipTerm

MAX_CHARTS = 3
"""Elections drawn at most; the narrative has them all."""

MAX_ROWS = 46
"""Rows of a chart at most; the later ones are left out."""


def sequence_chart(report: ReportData, before: LeadershipTerm, after: LeadershipTerm) -> Figure:
    """From the old leader's last command to the new leader's first acknowledgements."""
    rows = election_rows(report, before, after)[:MAX_ROWS]
    height = 0.7 + 0.235 * (len(rows) + len(silences(rows)))
    figure = Figure(figsize=(10.0, height))
    axes = figure.add_axes((0.075, 0.1 / height, 0.905, 1.0 - 0.15 / height))
    places = {robot: float(number) for number, robot in enumerate(report.robots)}
    ends = _draw_rows(axes, report, rows, places)
    bottom = ends + 0.6
    for robot, x in places.items():
        colour = report.colours[robot]
        dead_row = _death_row(report, rows, robot)
        axes.plot(
            [x, x],
            [-0.6, bottom if dead_row is None else dead_row],
            color=colour,
            linewidth=1.4,
            zorder=1,
        )
        axes.text(x, -1.0, f"robot {robot}", ha="center", fontsize=9, fontweight="bold", color=colour)
    axes.set_xlim(-0.55, len(places) - 0.45)
    axes.set_ylim(bottom, -1.6)
    axes.set_axis_off()
    return figure


def _draw_rows(axes: Axes, report: ReportData, rows: list[Row], places: dict[int, float]) -> float:
    pauses = silences(rows)
    y, labelled_s = 0.0, -1.0
    for number, row in enumerate(rows):
        if number in pauses:
            axes.axhspan(y - 0.45, y + 0.45, color="#EFEFEF", zorder=0)
            axes.text(
                (len(places) - 1) / 2, y, f"silence, {pauses[number]:.2f} s", ha="center", va="center",
                fontsize=8.5, style="italic", color=INK,
            )  # fmt: skip
            y += 1.0
        if row.at_s != labelled_s:
            axes.text(-0.5, y, f"{row.at_s:.2f} s", ha="right", va="center", fontsize=8, color=INK)
            labelled_s = row.at_s
        for robot, text, departed in row.notes:
            colour = BAD if departed else INK
            box = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": colour}
            axes.text(
                places[robot], y, text, ha="center", va="center", fontsize=8, color=colour, zorder=5,
                bbox=box,
            )  # fmt: skip
        for trace in row.traces:
            _draw_trace(axes, trace, y, places, report.colours)
        if row.traces:
            _name_trace(axes, row.traces, y, places)
        y += 1.0
    return y - 1.0


def _draw_trace(
    axes: Axes, trace: MessageTrace, y: float, places: dict[int, float], colours: dict[int, str]
) -> None:
    start, end = places[trace.source], places[trace.receiver]
    colour = colours[trace.source] if trace.delivered else BAD
    if not trace.delivered:
        end = start + 0.8 * (end - start)
    axes.annotate(
        "", (end, y), (start, y),
        arrowprops={
            "arrowstyle": "-|>" if trace.delivered else "-", "color": colour, "linewidth": 1.2,
            "linestyle": "-" if trace.delivered else "--", "shrinkA": 0, "shrinkB": 2,
        },
        zorder=3,
    )  # fmt: skip
    if not trace.delivered:
        axes.plot(end, y, marker="x", color=BAD, markersize=6, markeredgewidth=1.6, zorder=4)


def _name_trace(axes: Axes, traces: list[MessageTrace], y: float, places: dict[int, float]) -> None:
    """The name of the message near its sender, and the reason if it was lost."""
    first = traces[0]
    start, end = places[first.source], places[first.receiver]
    lost = [trace for trace in traces if not trace.delivered]
    reason = (
        ""
        if not lost
        else f": {lost[0].status}" + (f", {len(lost)} of {len(traces)}" if first.broadcast else "")
    )
    text = f"{first.kind}{' to all' if first.broadcast else ''}{reason}"
    side = 1 if end > start else -1
    axes.text(
        start + side * 0.5, y, text, ha="center", va="center", fontsize=7.5,
        color=BAD if lost else INK, zorder=4,
        bbox={"boxstyle": "square,pad=0.08", "facecolor": "white", "edgecolor": "none"},
    )  # fmt: skip


def _death_row(report: ReportData, rows: list[Row], robot: int) -> float | None:
    """Where the lifeline of a robot that is gone ends."""
    pauses = silences(rows)
    y = 0.0
    for number, row in enumerate(rows):
        y += number in pauses
        if any(note.robot == robot and note.departed for note in row.notes):
            return y
        y += 1.0
    return -0.6 if robot in report.dead and rows and report.dead[robot].at_s < rows[0].at_s else None
