"""A mission told in sentences: what happened, when, and why, for somebody who was not there."""

from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import Any, NamedTuple, Protocol

from onehop.analysis.report.election_rows import elections
from onehop.analysis.timeline import LastSeen
from onehop.contracts.fault_section import FaultSection, fault_in_words, in_toml
from onehop.contracts.messages import LeadershipTerm
from onehop.contracts.printable import in_words, printable
from onehop.contracts.scenario import Scenario
from onehop.contracts.team import loss_in_words

MOST_NOTES = 50
"""Notes of one robot and kind that are told."""

MOST_HANDOVERS = 50
"""Changes of the leader that are told."""

MOST_FAULTS = 200
"""Faults that are told."""

_LONGEST_FAULT = 400
"""Characters of a fault that are shown."""

_NAMED_LEADERS = 6
"""More leaders than this are only counted."""


class NarrativeEvent(NamedTuple):
    """One sentence of the narrative. weight: 2 = turns the mission, 1 = ordinary, 0 = detail.

    robot: whom it is about first of all, 0 for nobody.
    """

    at_s: float
    weight: int
    text: str
    robot: int = 0


class Narrated(Protocol):
    """What of a mission is told; see ReportData.

    noted: time [s], robot, kind and data of each note. touched: time [s], robot, and the other or 0.
    """

    @property
    def scenario(self) -> Scenario: ...
    @property
    def summary(self) -> dict[str, Any] | None: ...
    @property
    def robots(self) -> tuple[int, ...]: ...
    @property
    def end_s(self) -> float: ...
    @property
    def terms(self) -> list[LeadershipTerm]: ...
    @property
    def main_terms(self) -> list[LeadershipTerm]: ...
    @property
    def gone(self) -> list[LastSeen]: ...
    @property
    def begun(self) -> list[FaultSection]: ...
    @property
    def noted(self) -> Iterable[tuple[Any, ...]]: ...
    @property
    def touched(self) -> Iterable[tuple[Any, ...]]: ...


def narrative(report: Narrated) -> list[NarrativeEvent]:
    """All events in order of time."""
    notes, going_on = _told_notes(report)
    events = [
        *_beginning(report),
        *_sentences(notes),
        *going_on,
        *_columns(notes),
        *_losses_of_leaders(report, notes),
        *_handovers(report, notes),
        *_faults(report),
        *_departures(report),
        *_collisions(report),
        *_ending(report),
    ]
    return sorted(events, key=lambda event: event.at_s)


def summary_sentence(report: Narrated) -> str:
    """The mission in one or two sentences."""
    summary, robots = report.summary, report.robots
    team = f"A team of {len(robots)} robots" if len(robots) > 1 else "One robot"
    if summary is None:
        return f"{team} was under way; the log ends after {report.end_s:.0f} s, before the mission did."
    sentence = {
        "arrived": f"{team} reached the goal after {summary['sim_s']:.0f} s",
        "failed": f"{team} did not reach the goal in {summary['sim_s']:.0f} s",
        "aborted": f"The mission of {len(robots)} robots was aborted after {summary['sim_s']:.0f} s",
    }[summary["outcome"]]
    counted = f" with {len(summary['arrived'])} of {len(robots)}" if summary["arrived"] else ""
    lost = "; ".join(
        f"robot {one['robot']} was lost at {one['at_s']:.0f} s, {one['why']}"
        for one in summary["lost"]
        if one["why"] != "did not arrive"
    )
    leaders = [leader for leader, _ in groupby(term.leader for term in report.main_terms)]
    led = ""
    if 1 < len(leaders) <= _NAMED_LEADERS:
        led = " The lead passed from robot " + " to ".join(map(str, leaders)) + "."
    elif len(leaders) > _NAMED_LEADERS:
        led = f" The lead changed {len(leaders) - 1} times."
    reason = "" if summary["outcome"] == "arrived" else f" Reason: {summary['reason']}."
    return f"{sentence}{counted}{': ' + lost if lost else ''}.{led}{reason}"


def _robots(robots: Any) -> str:
    several = isinstance(robots, tuple) and len(robots) > 1
    return f"robot{'s' if several else ''} {in_words(robots)}"


class _Blanks(dict[str, str]):
    """What fills the blanks of a sentence; a robot's note may lack what ours have."""

    def __missing__(self, key: str) -> str:
        return "?"


def _beginning(report: Narrated) -> Iterator[NarrativeEvent]:
    if report.terms:
        first = report.terms[0]
        if len(first.members) == 1:
            yield NarrativeEvent(first.at_s, 1, f"Robot {first.leader} sets out alone.", first.leader)
            return
        yield NarrativeEvent(
            first.at_s, 1,
            f"Robots {in_words(first.members)} gather around robot {first.leader}, the median of their "
            f"ids, in a {first.shape}.",
            first.leader,
        )  # fmt: skip


class _Noted(NamedTuple):
    """One note of a robot."""

    at_s: float
    robot: int
    kind: str
    data: dict[str, Any]


def _told_notes(report: Narrated) -> tuple[list[_Noted], list[NarrativeEvent]]:
    """Notes that the narrative is made of, and who noted one kind more often than that is told."""
    told: list[_Noted] = []
    going_on: list[NarrativeEvent] = []
    number: Counter[tuple[int, str]] = Counter()
    for note in map(_Noted._make, report.noted):
        if note.kind == "mode" and note.data.get("on") != "formed":
            continue
        number[note.robot, note.kind] += 1
        if number[note.robot, note.kind] <= MOST_NOTES:
            told.append(note)
        elif number[note.robot, note.kind] == MOST_NOTES + 1 and note.kind in _TOLD_KINDS:
            what = f"Robot {note.robot} notes {note.kind.replace('_', ' ')!r} again and again."
            going_on.append(NarrativeEvent(note.at_s, 0, what, note.robot))
    return told, going_on


def _sentences(notes: list[_Noted]) -> Iterator[NarrativeEvent]:
    """Each note that is told by itself."""
    for at_s, robot, kind, data in notes:
        if kind == "mode":
            yield NarrativeEvent(
                at_s, 1, f"The formation stands: robot {robot} sets off towards the goal.", robot
            )
        elif kind in _SENTENCES:
            weight, sentence = _SENTENCES[kind]
            blanks = _Blanks((key, in_words(value)) for key, value in data.items())
            blanks["robot"] = str(robot)
            blanks["robots"] = _robots(data.get("robots", ()))
            blanks["why"] = loss_in_words(in_words(data.get("reason", "")))
            yield NarrativeEvent(at_s, weight, sentence.format_map(blanks), robot)


_SENTENCES = {
    "lost_follower": (2, "Leader {robot} gives up {robots}{why}."),
    "joined": (2, "Leader {robot} takes in {robots}."),
    "yielded": (2, "Robot {robot} obeys robot {leader} from now on (epoch {epoch} beats its own)."),
    "roster": (1, "Robot {robot} announces a new roster: {members} (epoch {epoch})."),
    "arrived": (2, "Robot {robot} reaches the goal."),
    "no_way": (2, "Robot {robot} finds no way on."),
}
"""Kind of note -> weight and sentence; the robot's own data fill the blanks."""

_TOLD_KINDS = (*_SENTENCES, "mode", "narrow", "lost_leader")
"""Kinds of notes of which the narrative is made."""


def _columns(notes: list[_Noted]) -> Iterator[NarrativeEvent]:
    """Each narrow passage as one event, from the order to drive in column to its end."""
    begun: dict[int, float] = {}
    for at_s, robot, kind, _ in notes:
        if kind == "narrow":
            begun[robot] = at_s
        elif kind == "wide" and robot in begun:
            yield _column(begun.pop(robot), robot, f", until {at_s:.0f} s")
    for robot, at_s in begun.items():
        yield _column(at_s, robot, "")


def _column(at_s: float, leader: int, until: str) -> NarrativeEvent:
    text = f"Too narrow for the shape: leader {leader} orders a column{until}."
    return NarrativeEvent(at_s, 1, text, leader)


def _losses_of_leaders(report: Narrated, notes: list[_Noted]) -> Iterator[NarrativeEvent]:
    """Lost_Leader of several robots within a Next period is one event; the election follows from it."""
    period = report.scenario.team.next_period
    open_group: tuple[float, str, list[int]] | None = None
    for at_s, robot, _, data in (note for note in notes if note.kind == "lost_leader"):
        leader = in_words(data.get("leader", "?"))
        if open_group and leader == open_group[1] and at_s - open_group[0] <= period:
            open_group[2].append(robot)
            continue
        if open_group:
            yield _lost_leader(report, *open_group)
        open_group = at_s, leader, [robot]
    if open_group:
        yield _lost_leader(report, *open_group)


def _lost_leader(report: Narrated, at_s: float, leader: str, robots: list[int]) -> NarrativeEvent:
    team = report.scenario.team
    who = f"Robots {in_words(sorted(robots))} have" if len(robots) > 1 else f"Robot {robots[0]} has"
    silence = f"not heard leader {leader} for {team.leader_timeout:g} s"
    text = f"{who} {silence} and give{'s' if len(robots) == 1 else ''} it up"
    successor = _successor(report.terms, at_s, leader)
    if successor is None:
        return NarrativeEvent(at_s, 2, f"{text}.", robots[0])
    if len(successor.members) == 1:
        alone = f"{text}. Robot {successor.leader} goes on alone."
        return NarrativeEvent(at_s, 2, alone, successor.leader)
    return NarrativeEvent(
        at_s, 2,
        f"{text}. Each strikes it from the roster and finds, without a vote, the same leader, "
        f"robot {successor.leader}, median of {in_words(successor.members)}, and shape, "
        f"{successor.shape}.",
        successor.leader,
    )  # fmt: skip


def _successor(terms: list[LeadershipTerm], at_s: float, leader: str) -> LeadershipTerm | None:
    later = (t for t in terms if at_s - 1e-6 <= t.at_s <= at_s + 1.0 and str(t.leader) != leader)
    return next(later, None)


def _handovers(report: Narrated, notes: list[_Noted]) -> Iterator[NarrativeEvent]:
    """Changes of the leader without a loss of the old one: a new roster has another median."""
    lost = [(note.at_s, note.data.get("leader")) for note in notes if note.kind == "lost_leader"]
    for before, after in elections(report)[:MOST_HANDOVERS]:
        if any(who == before.leader and 0.0 <= after.at_s - at_s <= 1.0 for at_s, who in lost):
            continue
        yield NarrativeEvent(
            after.at_s, 2,
            f"Robot {after.leader}, median of {in_words(after.members)}, leads from now on; "
            f"shape: {after.shape}.",
            after.leader,
        )  # fmt: skip


def _departures(report: Narrated) -> Iterator[NarrativeEvent]:
    for one in report.gone:
        leads = [term.leader for term in report.main_terms if term.at_s < one.at_s]
        part = ", the leader," if leads and leads[-1] == one.robot else ""
        text = f"Robot {one.robot}{part} leaves the mission: {one.why}."
        yield NarrativeEvent(one.at_s, 2, text, one.robot)


def _faults(report: Narrated) -> Iterator[NarrativeEvent]:
    """Each fault as it began, with the line that repeats it in a scenario."""
    for fault in report.begun[:MOST_FAULTS]:
        words = f"Fault: {fault_in_words(fault)}. In a scenario: faults = [{in_toml(fault)}]"
        robot = fault.robots[0] if fault.robots else 0
        yield NarrativeEvent(fault.at_s or 0.0, 2, printable(words, _LONGEST_FAULT), robot)


def _collisions(report: Narrated) -> Iterator[NarrativeEvent]:
    seen: set[tuple[int, int]] = set()
    for at_s, robot, other in report.touched:
        pair = min(robot, other), max(robot, other)
        if pair not in seen:
            seen.add(pair)
            yield NarrativeEvent(
                at_s, 2, f"Robot {robot} touches {f'robot {other}' if other else 'an obstacle'}.", robot
            )


def _ending(report: Narrated) -> Iterator[NarrativeEvent]:
    summary = report.summary
    if summary is not None:
        yield NarrativeEvent(
            summary["sim_s"], 2, f"The mission ends: {summary['outcome']}, {summary['reason']}."
        )
