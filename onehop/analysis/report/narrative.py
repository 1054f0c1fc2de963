"""A mission told in sentences: what happened, when, and why, for somebody who was not there."""

from collections.abc import Iterator
from itertools import groupby
from typing import Any, NamedTuple

from onehop.analysis.report.report_data import ReportData
from onehop.contracts.messages import LeadershipTerm

_TOLD_LEADERS = 6
"""A longer line of leaders is only counted."""


class NarrativeEvent(NamedTuple):
    """One sentence of the story. weight: 2 = turns the mission, 1 = ordinary, 0 = detail."""

    at_s: float
    weight: int
    text: str


def narrative(material: ReportData) -> list[NarrativeEvent]:
    """All events in order of time."""
    events = [
        *_beginning(material),
        *_notes(material),
        *_columns(material),
        *_losses_of_leaders(material),
        *_departures(material),
        *(
            NarrativeEvent(span.start_s, 2, _fault(span.what, span.end_s - span.start_s))
            for span in material.faults
        ),
        *_collisions(material),
        *_ending(material),
    ]
    return sorted(events, key=lambda event: event.at_s)


def summary_sentence(material: ReportData) -> str:
    """The mission in one or two sentences."""
    summary, robots = material.log.summary, material.robots
    team = f"A team of {len(robots)} robots" if len(robots) > 1 else "One robot"
    if summary is None:
        return (
            f"{team} was under way; the log ends after {material.end_s:.0f} s, before the mission did."
        )
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
    leaders = [leader for leader, _ in groupby(reign.leader for reign in material.line)]
    led = ""
    if 1 < len(leaders) <= _TOLD_LEADERS:
        led = " The lead passed from robot " + " to ".join(map(str, leaders)) + "."
    elif len(leaders) > _TOLD_LEADERS:
        led = f" The lead changed {len(leaders) - 1} times."
    reason = "" if summary["outcome"] == "arrived" else f" Reason: {summary['reason']}."
    return f"{sentence}{counted}{': ' + lost if lost else ''}.{led}{reason}"


def _ids(robots: Any) -> str:
    return ", ".join(map(str, robots))


def _beginning(material: ReportData) -> Iterator[NarrativeEvent]:
    if material.reigns:
        first = material.reigns[0]
        yield NarrativeEvent(
            first.at_s, 1,
            f"Robots {_ids(first.members)} gather around robot {first.leader}, the median of their ids, "
            f"in a {first.shape}.",
        )  # fmt: skip


def _notes(material: ReportData) -> Iterator[NarrativeEvent]:
    notes = material.tables["notes"]
    for at_s, robot, kind, data in zip(
        notes["time_s"].tolist(),
        notes["robot"].tolist(),
        notes["kind"].tolist(),
        notes["data"],
        strict=True,
    ):
        told = _TOLD.get(kind)
        if told is not None:
            weight, sentence = told
            yield NarrativeEvent(at_s, weight, sentence.format(robot=robot, **_words(data)))
        elif kind == "mode" and data.get("on") == "formed":
            yield NarrativeEvent(
                at_s, 1, f"The formation stands: robot {robot} sets off towards the goal."
            )


_TOLD = {
    "lost_follower": (2, "Leader {robot} gives robot {robots} up: its commands stayed unanswered."),
    "joined": (2, "Leader {robot} takes in robot {robots}."),
    "yielded": (2, "Robot {robot} obeys robot {leader} from now on (epoch {epoch} beats its own)."),
    "roster": (1, "Robot {robot} announces a new roster: {members} (epoch {epoch})."),
    "arrived": (2, "Robot {robot} reaches the goal."),
    "no_way": (2, "Robot {robot} finds no way on."),
}
"""Kind of note -> weight and sentence; the robot's own data fill the blanks."""


def _words(data: dict[str, Any]) -> dict[str, str]:
    return {
        key: _ids(value)
        if isinstance(value, list)
        else f"{value:.1f}"
        if isinstance(value, float)
        else str(value)
        for key, value in data.items()
    }


def _columns(material: ReportData) -> Iterator[NarrativeEvent]:
    """Each narrow passage as one event, from the order to drive in column to its end."""
    notes = material.tables["notes"]
    begun: dict[int, float] = {}
    for at_s, robot, kind in zip(
        notes["time_s"].tolist(), notes["robot"].tolist(), notes["kind"].tolist(), strict=True
    ):
        if kind == "narrow":
            begun[robot] = at_s
        elif kind == "wide" and robot in begun:
            yield _column(begun.pop(robot), robot, f", until {at_s:.0f} s")
    for robot, at_s in begun.items():
        yield _column(at_s, robot, "")


def _column(at_s: float, leader: int, until: str) -> NarrativeEvent:
    return NarrativeEvent(at_s, 1, f"Too narrow for the shape: leader {leader} orders a column{until}.")


def _losses_of_leaders(material: ReportData) -> Iterator[NarrativeEvent]:
    """Lost_Leader of several robots within a Next period is one event; the election follows from it."""
    notes = material.tables["notes"]
    period = material.log.scenario.team.next_period
    open_group: tuple[float, int, list[int]] | None = None
    rows = notes.where(notes["kind"] == "lost_leader")
    for at_s, robot, data in zip(
        rows["time_s"].tolist(), rows["robot"].tolist(), rows["data"], strict=True
    ):
        if open_group and data["leader"] == open_group[1] and at_s - open_group[0] <= period:
            open_group[2].append(robot)
            continue
        if open_group:
            yield _lost_leader(material, *open_group)
        open_group = at_s, data["leader"], [robot]
    if open_group:
        yield _lost_leader(material, *open_group)


def _lost_leader(material: ReportData, at_s: float, leader: int, robots: list[int]) -> NarrativeEvent:
    team = material.log.scenario.team
    who = f"Robots {_ids(sorted(robots))} have" if len(robots) > 1 else f"Robot {robots[0]} has"
    silence = f"not heard leader {leader} for {team.leader_timeout:g} s"
    text = f"{who} {silence} and give{'s' if len(robots) == 1 else ''} it up"
    successor = _successor(material.reigns, at_s, leader)
    if successor is None:
        return NarrativeEvent(at_s, 2, f"{text}.")
    return NarrativeEvent(
        at_s, 2,
        f"{text}. Each strikes it from the same list and comes, without a message, to the same leader, "
        f"robot {successor.leader}, median of {_ids(successor.members)}, and shape, {successor.shape}.",
    )  # fmt: skip


def _successor(reigns: list[LeadershipTerm], at_s: float, leader: int) -> LeadershipTerm | None:
    later = (r for r in reigns if at_s - 1e-6 <= r.at_s <= at_s + 1.0 and r.leader != leader)
    return next(later, None)


def _departures(material: ReportData) -> Iterator[NarrativeEvent]:
    for one in material.gone:
        leads = [reign.leader for reign in material.line if reign.at_s < one.at_s]
        part = ", the leader," if leads and leads[-1] == one.robot else ""
        yield NarrativeEvent(one.at_s, 2, f"Robot {one.robot}{part} is gone: {one.why}.")


def _fault(what: str, lasted_s: float) -> str:
    return f"Fault: {what}, for {lasted_s:.0f} s."


def _collisions(material: ReportData) -> Iterator[NarrativeEvent]:
    contacts = material.tables["contacts"]
    seen: set[tuple[int, int]] = set()
    for at_s, robot, other in zip(
        contacts["time_s"].tolist(), contacts["robot"].tolist(), contacts["other"].tolist(), strict=True
    ):
        pair = min(robot, other), max(robot, other)
        if pair not in seen:
            seen.add(pair)
            yield NarrativeEvent(
                at_s, 2, f"Robot {robot} touches {f'robot {other}' if other else 'an obstacle'}."
            )


def _ending(material: ReportData) -> Iterator[NarrativeEvent]:
    summary = material.log.summary
    if summary is not None:
        yield NarrativeEvent(
            summary["sim_s"], 2, f"The mission has {summary['outcome']}: {summary['reason']}."
        )
