"""The messages of an election as a sequence diagram: one lifeline a robot, time downwards.

Only rows in which something was said or noticed are drawn; a stretch without any is one grey band with
its length, because the silence is what elects.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from onehop.analysis.message_traces import MessageTrace
from onehop.analysis.palette import BAD, INK
from onehop.analysis.report.report_data import ReportData
from onehop.contracts.messages import LeadershipTerm

MAX_CHARTS = 3
"""Elections drawn at most; the rest is in the story."""

MAX_ROWS = 46
AFTER_S = 0.5
"""How long after the election its messages are followed [s]."""

SILENCE_S = 0.5
"""A longer stretch without a word gets a band [s]."""


@dataclass(slots=True)
class _Row:
    """One line of the diagram: a message, its copies in a broadcast, or something that a robot notes."""

    at_s: float
    frames: list[MessageTrace] = field(default_factory=list)
    notes: list[tuple[int, str, str]] = field(default_factory=list)


def elections(material: ReportData) -> list[tuple[LeadershipTerm, LeadershipTerm]]:
    """Each change of who leads most of the team: (last roster of the old leader, first of the new)."""
    return [
        (before, after)
        for before, after in zip(material.line, material.line[1:], strict=False)
        if before.leader != after.leader
    ]


def sequence_chart(material: ReportData, before: LeadershipTerm, after: LeadershipTerm) -> Figure:
    """From the old leader's last word to the new leader's first acknowledgements."""
    rows = _rows(material, before, after)[:MAX_ROWS]
    height = 0.7 + 0.235 * (len(rows) + len(_silences(rows)))
    figure = Figure(figsize=(10.0, height))
    axes = figure.add_axes((0.075, 0.1 / height, 0.905, 1.0 - 0.15 / height))
    places = {robot: float(number) for number, robot in enumerate(material.robots)}
    ends = _draw_rows(axes, material, rows, places)
    bottom = ends + 0.6
    for robot, x in places.items():
        colour = material.colours[robot]
        dead_row = _death_row(material, rows, robot)
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


def _rows(material: ReportData, before: LeadershipTerm, after: LeadershipTerm) -> list[_Row]:
    start_s, end_s = _window(material, before, after)
    rows: dict[tuple[float, int, int], _Row] = {}
    for frame in material.frames:
        if start_s <= frame.offered_s <= end_s:
            row = rows.setdefault((frame.offered_s, frame.source, frame.number), _Row(frame.offered_s))
            row.frames.append(frame)
    noted: dict[float, _Row] = {}
    for at_s, robot, text, colour in _noted(material, start_s, end_s):
        notes = noted.setdefault(at_s, _Row(at_s)).notes
        if notes and notes[-1][0] == robot:
            notes[-1] = robot, f"{notes[-1][1]},\n{text}", colour
        else:
            notes.append((robot, text, colour))
    ordered = [*noted.values(), *rows.values()]
    return sorted(ordered, key=lambda row: (row.at_s, not row.notes, _arrival(row)))


def _arrival(row: _Row) -> float:
    times = [frame.arrival_s for frame in row.frames if not math.isnan(frame.arrival_s)]
    return min(times, default=row.at_s + 1.0)


def _window(material: ReportData, before: LeadershipTerm, after: LeadershipTerm) -> tuple[float, float]:
    """From the last command of the old leader that anybody heard."""
    spoken = [
        frame.offered_s
        for frame in material.frames
        if frame.source == before.leader and frame.delivered and frame.offered_s < after.at_s - 1e-6
        and not frame.broadcast and frame.kind != "Ack"
    ]  # fmt: skip
    return max(spoken, default=after.at_s - 2.0) - 1e-6, after.at_s + AFTER_S


def _noted(material: ReportData, start_s: float, end_s: float) -> Iterator[tuple[float, int, str, str]]:
    for one in material.gone:
        if start_s <= one.at_s <= end_s:
            yield one.at_s, one.robot, one.why, BAD
    notes = material.tables["notes"]
    for at_s, robot, kind, data in zip(
        notes["time_s"].tolist(),
        notes["robot"].tolist(),
        notes["kind"].tolist(),
        notes["data"],
        strict=True,
    ):
        text = _note_text(kind, data)
        if text and start_s <= at_s <= end_s:
            yield at_s, robot, text, INK


def _note_text(kind: str, data: dict[str, Any]) -> str:
    if kind == "lost_leader":
        return f"gives {data['leader']} up"
    if kind == "lost_follower":
        return f"gives {' '.join(map(str, data['robots']))} up"
    if kind == "elected":
        return f"leads, epoch {data['epoch']}"
    if kind == "yielded":
        return f"obeys {data['leader']}"
    if kind == "joined":
        return f"takes in {' '.join(map(str, data['robots']))}"
    return ""


def _silences(rows: list[_Row]) -> dict[int, float]:
    """Rows before which nothing was said for long, with the length of the silence [s]."""
    return {
        number: row.at_s - rows[number - 1].at_s
        for number, row in enumerate(rows)
        if number and row.at_s - rows[number - 1].at_s > SILENCE_S
    }


def _draw_rows(axes: Axes, material: ReportData, rows: list[_Row], places: dict[int, float]) -> float:
    silences = _silences(rows)
    y, said_s = 0.0, -1.0
    for number, row in enumerate(rows):
        if number in silences:
            axes.axhspan(y - 0.45, y + 0.45, color="#EFEFEF", zorder=0)
            axes.text(
                (len(places) - 1) / 2, y, f"silence, {silences[number]:.2f} s", ha="center", va="center",
                fontsize=8.5, style="italic", color=INK,
            )  # fmt: skip
            y += 1.0
        if row.at_s != said_s:
            axes.text(-0.5, y, f"{row.at_s:.2f} s", ha="right", va="center", fontsize=8, color=INK)
            said_s = row.at_s
        for robot, text, colour in row.notes:
            box = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": colour}
            axes.text(
                places[robot], y, text, ha="center", va="center", fontsize=8, color=colour, zorder=5,
                bbox=box,
            )  # fmt: skip
        for frame in row.frames:
            _draw_frame(axes, frame, y, places, material.colours)
        if row.frames:
            _name_frame(axes, row.frames, y, places)
        y += 1.0
    return y - 1.0


def _draw_frame(
    axes: Axes, frame: MessageTrace, y: float, places: dict[int, float], colours: dict[int, str]
) -> None:
    start, end = places[frame.source], places[frame.receiver]
    colour = colours[frame.source] if frame.delivered else BAD
    if not frame.delivered:
        end = start + 0.8 * (end - start)
    axes.annotate(
        "", (end, y), (start, y),
        arrowprops={
            "arrowstyle": "-|>" if frame.delivered else "-", "color": colour, "linewidth": 1.2,
            "linestyle": "-" if frame.delivered else "--", "shrinkA": 0, "shrinkB": 2,
        },
        zorder=3,
    )  # fmt: skip
    if not frame.delivered:
        axes.plot(end, y, marker="x", color=BAD, markersize=6, markeredgewidth=1.6, zorder=4)


def _name_frame(axes: Axes, frames: list[MessageTrace], y: float, places: dict[int, float]) -> None:
    """The name of the message near its sender, and the reason if it was lost."""
    first = frames[0]
    start, end = places[first.source], places[first.receiver]
    lost = [frame for frame in frames if not frame.delivered]
    reason = (
        ""
        if not lost
        else f": {lost[0].status}" + (f", {len(lost)} of {len(frames)}" if first.broadcast else "")
    )
    text = f"{first.kind}{' to all' if first.broadcast else ''}{reason}"
    side = 1 if end > start else -1
    axes.text(
        start + side * 0.5, y, text, ha="center", va="center", fontsize=7.5,
        color=BAD if lost else INK, zorder=4,
        bbox={"boxstyle": "square,pad=0.08", "facecolor": "white", "edgecolor": "none"},
    )  # fmt: skip


def _death_row(material: ReportData, rows: list[_Row], robot: int) -> float | None:
    """Where the lifeline of a robot that is gone ends."""
    silences = _silences(rows)
    y = 0.0
    for number, row in enumerate(rows):
        y += number in silences
        if any(who == robot and colour == BAD for who, _, colour in row.notes):
            return y
        y += 1.0
    return -0.6 if robot in material.dead and rows and material.dead[robot].at_s < rows[0].at_s else None
