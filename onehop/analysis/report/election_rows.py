"""What was sent and noted in an election, in order of time, for the sequence chart."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

from onehop.analysis.message_traces import MessageTrace
from onehop.analysis.report.report_data import ReportData
from onehop.contracts.messages import LeadershipTerm
from onehop.contracts.printable import in_words, printable

AFTER_S = 0.5
"""How long after the election its messages are followed [s]."""

SILENCE_S = 0.5
"""A longer stretch in which nobody sends is a silence [s]."""


class RowNote(NamedTuple):
    """What happens to a robot, or what it notes. departed: it leaves the mission."""

    robot: int
    text: str
    departed: bool


@dataclass(slots=True)
class Row:
    """One line of the chart: a message (all copies of a broadcast), or what happens at one moment."""

    at_s: float
    traces: list[MessageTrace] = field(default_factory=list)
    notes: list[RowNote] = field(default_factory=list)


class Led(Protocol):
    """A mission of which it is known who led most of its team, and when."""

    @property
    def main_terms(self) -> list[LeadershipTerm]: ...


def elections(report: Led) -> list[tuple[LeadershipTerm, LeadershipTerm]]:
    """Each change of who leads most of the team: (last roster of the old leader, first of the new)."""
    return [
        (before, after)
        for before, after in zip(report.main_terms, report.main_terms[1:], strict=False)
        if before.leader != after.leader
    ]


def election_rows(report: ReportData, before: LeadershipTerm, after: LeadershipTerm) -> list[Row]:
    """Messages and notes from the old leader's last command to the new leader's first answers."""
    start_s, end_s = _window(report, before, after)
    rows: dict[tuple[float, int, int], Row] = {}
    for trace in report.traces:
        if start_s <= trace.offered_s <= end_s and trace.receiver in report.robots:
            row = rows.setdefault((trace.offered_s, trace.source, trace.number), Row(trace.offered_s))
            row.traces.append(trace)
    noted: dict[float, Row] = {}
    for at_s, note in _notes(report):
        if start_s <= at_s <= end_s:
            _add_note(noted.setdefault(at_s, Row(at_s)).notes, note)
    ordered = [*noted.values(), *rows.values()]
    return sorted(ordered, key=lambda row: (row.at_s, not row.notes, _arrival(row)))


def _add_note(notes: list[RowNote], note: RowNote) -> None:
    """What a robot notes at the same moment goes into the same box."""
    if notes and notes[-1].robot == note.robot:
        last = notes.pop()
        note = RowNote(note.robot, f"{last.text},\n{note.text}", last.departed or note.departed)
    notes.append(note)


def _arrival(row: Row) -> float:
    times = [trace.arrival_s for trace in row.traces if not math.isnan(trace.arrival_s)]
    return min(times, default=row.at_s + 1.0)


def _window(report: ReportData, before: LeadershipTerm, after: LeadershipTerm) -> tuple[float, float]:
    """From the last command of the old leader that was delivered."""
    commands = [
        trace.offered_s
        for trace in report.traces
        if trace.source == before.leader and trace.delivered and trace.offered_s < after.at_s - 1e-6
        and not trace.broadcast and trace.kind != "Ack"
    ]  # fmt: skip
    return max(commands, default=after.at_s - 2.0) - 1e-6, after.at_s + AFTER_S


def _notes(report: ReportData) -> Iterator[tuple[float, RowNote]]:
    for one in report.gone:
        yield one.at_s, RowNote(one.robot, one.why, departed=True)
    for at_s, robot, kind, data in report.tables["notes"].rows("time_s", "robot", "kind", "data"):
        text = _note_text(kind, data)
        if text:
            yield at_s, RowNote(robot, text, departed=False)


def _note_text(kind: str, data: dict[str, Any]) -> str:
    verb, key = _NOTED.get(kind, ("", ""))
    return f"{verb} {printable(in_words(data.get(key, '?')), _LONGEST)}" if verb else ""


_NOTED = {
    "lost_leader": ("gives up", "leader"),
    "lost_follower": ("gives up", "robots"),
    "elected": ("leads, epoch", "epoch"),
    "yielded": ("obeys", "leader"),
    "joined": ("takes in", "robots"),
}
"""Kind of note -> what the robot does, and the key that says whom it does it to."""

_LONGEST = 40
"""Letters of a value that find room in the chart."""


def silences(rows: list[Row]) -> dict[int, float]:
    """Rows before which nothing was said for long, with the length of the silence [s]."""
    return {
        number: row.at_s - rows[number - 1].at_s
        for number, row in enumerate(rows)
        if number and row.at_s - rows[number - 1].at_s > SILENCE_S
    }
