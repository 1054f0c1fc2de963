"""Judges a mission from ground truth and from what the robots say of themselves.

Arrived: a leader stands at the goal and everyone who is left stands still. Failed: nobody is left,
everyone has stopped elsewhere, or the time is up. Whoever obeys a leader at the goal and is within the
reach of its formation has arrived; the rest is lost, and the referee says since when and why.

A robot whose program says nothing of a team is judged by where it is, alone: it has arrived when it is
within the goal's tolerance, and within the room that as many robots as there are need around it. Without
a link (radio.link) every robot leads itself, and has arrived within that room as well.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

from onehop.contracts.geometry import Pose
from onehop.contracts.leadership import LeadershipHistory
from onehop.contracts.messages import LeadershipTerm, Lost, Note, Outcome, Presence
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import beside_goal
from onehop.contracts.team import Mode, Shape, Status, loss_in_words

STILL = 0.02
"""Speed below which a robot stands still [m/s]; of one without a team its turning too [rad/s]."""

_REST_S = 2.0
"""Standing still this long counts as having stopped [s]; a Next period of the thesis (3.3.2)."""

_PATIENCE_S = 30.0
"""When a robot without a team takes part, so long nobody moves before nobody will any more [s]: such a
robot does not say that it has stopped, and may wait for something."""

_MARGIN = 0.1
"""What a robot may stand beyond the goal's tolerance, for the last tick of its braking [m]."""


class TickSummary(NamedTuple):
    """What the referee looks at after a tick.

    statuses: the last word of those who have said any; None of a robot without a team. waiting: robots
    held or stopped by a fault that will end by itself, whose standing still means nothing. collisions:
    contacts so far.
    """

    ticks: int
    time_ns: int
    present: tuple[Presence, ...]
    statuses: Mapping[int, Status | None]
    waiting: frozenset[int]
    collisions: int

    def mode(self, robot: int) -> Mode | None:
        """What a robot says it is doing, if it has said anything."""
        status = self.statuses.get(robot)
        return None if status is None else status.mode

    def is_teamless(self, robot: int) -> bool:
        """Whether a robot has spoken, and not of a team."""
        return robot in self.statuses and self.statuses[robot] is None


class Referee:
    """Watches one mission, tick by tick.

    _given_up: for each robot why it was given up, by (who did, terms that had begun by then); of what a
    robot says between two terms the last word counts.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._goal = scenario.goal
        self._beside = {
            robot: beside_goal(scenario.goal, scenario.body_of(robot), scenario.planner)
            for robot in scenario.team.robots
        }
        self._spacing = scenario.team.spacing
        self._robots = scenario.team.robots
        self._room = scenario.room_at_goal + _MARGIN
        self._alone = scenario.radio.link == "none"
        self._limit_ns = round(scenario.clock.limit_s * 1e9)
        self._moved_ns = 0
        self._leadership = LeadershipHistory()
        self._departed: dict[int, Lost] = {}
        self._given_up: dict[int, dict[tuple[int, int], str]] = {robot: {} for robot in self._robots}
        self._last_notes: dict[int, str] = {}

    def on_departure(self, robot: int, why: str, time_ns: int) -> None:
        """A robot has left the mission."""
        self._departed[robot] = Lost(robot=robot, at_s=time_ns / 1e9, why=why)
        self._leadership.on_departure(robot)

    def on_return(self, robot: int) -> None:
        """A robot takes part again."""
        self._departed.pop(robot, None)

    def on_notes(self, robot: int, notes: tuple[Note, ...]) -> None:
        """Remember whom a leader gave up and why, and the last note about the robot itself."""
        for note in notes:
            if note.kind not in ("mode", "garbled"):
                self._last_notes[robot] = note.kind.replace("_", " ")
            if note.kind == "lost_follower":
                self._on_given_up(robot, note)

    def _on_given_up(self, leader: int, note: Note) -> None:
        reason, lost = note.data.get("reason", ""), note.data.get("robots", ())
        after = len(self._leadership.terms)
        for robot in lost if isinstance(lost, tuple) else ():
            if robot in self._given_up:
                records = self._given_up[robot]
                records.pop((leader, after), None)
                records[leader, after] = str(reason)

    def judge(self, now: TickSummary, hope: bool) -> Outcome | None:
        """The outcome, if the mission has one by now. hope: somebody will yet be restarted."""
        self._watch(now)
        verdict = self._verdict(now, hope)
        return None if verdict is None else self.close(*verdict, now)

    def close(self, outcome: str, reason: str, now: TickSummary) -> Outcome:
        """The final account, whatever ended the mission."""
        arrived = self._arrived(now) if outcome == "arrived" else ()
        return Outcome(
            outcome=outcome,
            reason=reason,
            arrived=arrived,
            lost=tuple(self._loss(robot, now) for robot in self._robots if robot not in arrived),
            leaders=tuple(self._leadership.terms),
            ticks=now.ticks,
            sim_s=now.time_ns / 1e9,
            collisions=now.collisions,
        )

    def _watch(self, now: TickSummary) -> None:
        """Note who moves, and who acts as leader on which roster."""
        for one in now.present:
            robot = one.robot
            if not -STILL < one.twist.v < STILL or robot in now.waiting:
                self._moved_ns = now.time_ns
            elif now.is_teamless(robot) and not -STILL < one.twist.w < STILL:
                self._moved_ns = now.time_ns  # it may look around for its way
            status = now.statuses.get(robot)
            if status is not None:
                self._leadership.on_status(
                    now.time_ns / 1e9, robot, status.leader, status.epoch, status.members,
                    status.shape.value,
                )  # fmt: skip

    def _verdict(self, now: TickSummary, hope: bool) -> tuple[str, str] | None:
        if not now.present:
            return None if hope else ("failed", "no robot is left")
        if now.time_ns >= self._limit_ns:
            if self._arrived(now):
                return "arrived", self._arrival(now) + " when the time was up"
            return "failed", f"time limit of {self._limit_ns / 1e9:g} s"
        if self._moved_ns == now.time_ns:
            return None
        stopped = all(now.mode(one.robot) is Mode.STOPPED for one in now.present)
        rested = now.time_ns - self._moved_ns >= _REST_S * 1e9
        if (stopped or rested) and self._arrived(now):
            return "arrived", self._arrival(now)
        if stopped and rested:
            return "failed", self._stop_reason(now)
        if now.time_ns - self._moved_ns >= _PATIENCE_S * 1e9 and any(
            now.is_teamless(one.robot) for one in now.present
        ):
            return "failed", f"nobody has moved for {_PATIENCE_S:g} s"
        return None

    def _arrival(self, now: TickSummary) -> str:
        leaders = ", ".join(str(one.robot) for one in self._leaders_at_goal(now))
        count = f"{len(self._arrived(now))} of {len(self._robots)}"
        return f"robot {leaders} at the goal with {count}" if leaders else f"{count} at the goal"

    def _stop_reason(self, now: TickSummary) -> str:
        """Why nobody drives any more, by the last notes of those who lead."""
        notes = [
            f"robot {one.robot}: {self._last_notes[one.robot]}"
            for one in now.present
            if one.robot in self._last_notes and one.robot in self._leadership.acting
        ]
        return "everyone stopped before the goal" + (f" ({'; '.join(notes)})" if notes else "")

    def _from_goal(self, pose: Pose) -> float:
        return math.hypot(pose.x - self._goal.x, pose.y - self._goal.y)

    def _leaders_at_goal(self, now: TickSummary) -> list[Presence]:
        acting = self._leadership.acting
        return [one for one in now.present if one.robot in acting and self._is_at_goal(one)]

    def _is_at_goal(self, leader: Presence) -> bool:
        """Whether a leader stands at the goal, or beside what occupies it and says that it arrived."""
        says_so = self._last_notes.get(leader.robot) == "arrived"
        if self._alone:
            return self._from_goal(leader.pose) <= self._room
        reach = self._beside[leader.robot] if says_so else self._goal.tolerance
        return self._from_goal(leader.pose) <= reach + _MARGIN

    def _arrived(self, now: TickSummary) -> tuple[int, ...]:
        """Ids of those who obey a leader at the goal, are on its roster and within its formation.

        And of those at the goal who have no team.
        """
        arrived = [
            one.robot
            for one in now.present
            if now.is_teamless(one.robot) and self._from_goal(one.pose) <= self._room
        ]
        for front in self._leaders_at_goal(now):
            leader = front.robot
            term = self._leadership.acting[leader]
            off = max(self._goal.tolerance, self._from_goal(front.pose))
            reach = _extent(term, self._spacing) + off + _MARGIN
            for one in now.present:
                status = now.statuses.get(one.robot)
                obeys = status is not None and status.leader == leader
                if obeys and one.robot in term.members and self._from_goal(one.pose) <= reach:
                    arrived.append(one.robot)
        return tuple(sorted(arrived))

    def _loss(self, robot: int, now: TickSummary) -> Lost:
        if robot in self._departed:
            return self._departed[robot]
        if now.is_teamless(robot):
            return Lost(robot=robot, at_s=now.time_ns / 1e9, why="did not arrive")
        leaders = [one.robot for one in self._leaders_at_goal(now)]
        leaders = leaders or [term.leader for term in self._leadership.terms[-1:]]
        dropped = self._dropped(robot, leaders[0]) if leaders else None
        return dropped or Lost(robot=robot, at_s=now.time_ns / 1e9, why="did not arrive")

    def _dropped(self, robot: int, leader: int) -> Lost | None:
        """When the rosters that led to `leader` lost a robot for good, and why."""
        dropped: Lost | None = None
        last_with_robot = -1
        for number, term in enumerate(self._leadership.terms):
            if leader not in term.members:
                continue
            if robot in term.members:
                dropped, last_with_robot = None, number
            elif dropped is None:
                why = self._why_dropped(robot, term, range(last_with_robot + 1, number + 1))
                dropped = Lost(robot=robot, at_s=term.at_s, why=why)
        return dropped

    def _why_dropped(self, robot: int, term: LeadershipTerm, between: range) -> str:
        """The word of the member of a roster who gave up a robot that the roster lacks.

        between: how many terms had begun at any time from the last roster with the robot to this one.
        """
        for (by, after), reason in reversed(self._given_up[robot].items()):
            if by in term.members and after in between:
                return f"given up by robot {by}{loss_in_words(reason)}"
        return f"dropped from the roster of robot {term.leader}"


def _extent(term: LeadershipTerm, spacing: float) -> float:
    """How far behind its leader the last slot of a formation may lie, and half a spacing more [m]."""
    followers = len(term.members) - 1
    ranks = followers if term.shape == Shape.COLUMN else (followers + 1) // 2
    return (ranks + 0.5) * spacing
