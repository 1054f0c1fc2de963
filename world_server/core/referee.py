"""Judges a mission from ground truth and from what the robots say of themselves.

Arrived: a leader stands at the goal and everyone who is left stands still. Failed: nobody is left,
everyone has stopped elsewhere, or the time is up. Whoever obeys a leader at the goal and is within the
reach of its formation has arrived; the rest is lost, and the referee says since when and why.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from onehop.contracts.messages import Lost, Note, Outcome, Reign
from onehop.contracts.scenario import Scenario
from onehop.contracts.team import Mode, Shape, Status

STILL = 0.02
"""Speed below which a robot stands still [m/s]."""

_REST_S = 2.0
"""Standing still this long counts as having stopped [s]; a Next period of the thesis (3.3.2)."""

_MARGIN = 0.1
"""What a robot may stand beyond the goal's tolerance, for the last tick of its braking [m]."""


class Standing(NamedTuple):
    """One present robot: where it is [m], how fast [m/s], and its last word, if it has said any.

    waiting: it is held by a fault that will end by itself, so its standing still means nothing.
    """

    robot: int
    x: float
    y: float
    speed: float
    status: Status | None
    waiting: bool


class Referee:
    """Watches one mission, tick by tick."""

    def __init__(self, scenario: Scenario) -> None:
        self._goal = scenario.goal
        self._spacing = scenario.team.spacing
        self._robots = scenario.team.robots
        self._limit_ns = round(scenario.clock.limit_s * 1e9)
        self._moved_ns = 0
        self._reigns: list[Reign] = []
        self._crowned: dict[int, Status] = {}
        self._departed: dict[int, Lost] = {}
        self._last_words: dict[int, str] = {}

    def on_departure(self, robot: int, why: str, time_ns: int) -> None:
        """A robot has left the mission."""
        self._departed[robot] = Lost(robot=robot, at_s=time_ns / 1e9, why=why)
        self._crowned.pop(robot, None)

    def on_return(self, robot: int) -> None:
        """A robot takes part again."""
        self._departed.pop(robot, None)

    def on_notes(self, robot: int, notes: tuple[Note, ...]) -> None:
        """Remember a robot's last note: the reason it gives should it stop."""
        if notes:
            self._last_words[robot] = notes[-1].kind.replace("_", " ")

    def judge(
        self, ticks: int, time_ns: int, standing: Sequence[Standing], hope: bool, collisions: int
    ) -> Outcome | None:
        """The outcome after `ticks` ticks, if there is one. hope: somebody will yet be restarted."""
        self._watch(time_ns, standing)
        verdict = self._verdict(time_ns, standing, hope)
        if verdict is None:
            return None
        outcome, reason = verdict
        return self.close(outcome, reason, ticks, time_ns, standing, collisions)

    def close(
        self, outcome: str, reason: str, ticks: int, time_ns: int,
        standing: Sequence[Standing], collisions: int,
    ) -> Outcome:  # fmt: skip
        """The final account, whatever ended the mission."""
        arrived = self._arrived(standing) if outcome == "arrived" else ()
        return Outcome(
            outcome=outcome,
            reason=reason,
            arrived=arrived,
            lost=tuple(
                self._loss(robot, time_ns / 1e9, standing)
                for robot in self._robots
                if robot not in arrived
            ),
            leaders=tuple(self._reigns),
            ticks=ticks,
            sim_s=time_ns / 1e9,
            collisions=collisions,
        )

    def _watch(self, time_ns: int, standing: Sequence[Standing]) -> None:
        """Note who moves, and who begins to act as a leader with which roster."""
        for one in standing:
            if one.speed > STILL or one.waiting:
                self._moved_ns = time_ns
            status = one.status
            if status is None or status.leader != one.robot:
                self._crowned.pop(one.robot, None)
                continue
            before = self._crowned.get(one.robot)
            self._crowned[one.robot] = status
            if before is not None and _roster(before) == _roster(status):
                continue
            self._reigns.append(
                Reign(
                    at_s=time_ns / 1e9,
                    leader=status.leader,
                    epoch=status.epoch,
                    members=status.members,
                    shape=status.shape.value,
                )
            )

    def _verdict(self, time_ns: int, standing: Sequence[Standing], hope: bool) -> tuple[str, str] | None:
        if not standing:
            return None if hope else ("failed", "no robot is left")
        if time_ns >= self._limit_ns:
            if self._arrived(standing):
                return "arrived", self._arrival(standing) + " when the time was up"
            return "failed", f"time limit of {self._limit_ns / 1e9:g} s"
        if self._moved_ns == time_ns:
            return None
        stopped = all(one.status is not None and one.status.mode is Mode.STOPPED for one in standing)
        rested = time_ns - self._moved_ns >= _REST_S * 1e9
        if (stopped or rested) and self._arrived(standing):
            return "arrived", self._arrival(standing)
        if stopped and rested:
            return "failed", self._stop_reason(standing)
        return None

    def _arrival(self, standing: Sequence[Standing]) -> str:
        leaders = ", ".join(str(one.robot) for one in self._leaders_at_goal(standing))
        return f"robot {leaders} at the goal with {len(self._arrived(standing))} of {len(self._robots)}"

    def _stop_reason(self, standing: Sequence[Standing]) -> str:
        words = [
            f"robot {one.robot}: {self._last_words[one.robot]}"
            for one in standing
            if one.robot in self._last_words
        ]
        return "everyone stopped before the goal" + (f" ({'; '.join(words)})" if words else "")

    def _leaders_at_goal(self, standing: Sequence[Standing]) -> list[Standing]:
        reach = self._goal.tolerance + _MARGIN
        return [
            one
            for one in standing
            if one.status is not None
            and one.status.leader == one.robot
            and math.hypot(one.x - self._goal.x, one.y - self._goal.y) <= reach
        ]

    def _arrived(self, standing: Sequence[Standing]) -> tuple[int, ...]:
        """Ids of those who obey a leader at the goal, are on its roster and within its formation."""
        arrived = set()
        for leader in self._leaders_at_goal(standing):
            roster = self._crowned[leader.robot]
            reach = _extent(roster, self._spacing) + self._goal.tolerance + _MARGIN
            for one in standing:
                obeys = one.status is not None and one.status.leader == leader.robot
                near = math.hypot(one.x - self._goal.x, one.y - self._goal.y) <= reach
                if obeys and near and one.robot in roster.members:
                    arrived.add(one.robot)
        return tuple(sorted(arrived))

    def _loss(self, robot: int, end_s: float, standing: Sequence[Standing]) -> Lost:
        if robot in self._departed:
            return self._departed[robot]
        dropped = self._dropped(robot, [one.robot for one in self._leaders_at_goal(standing)])
        return dropped or Lost(robot=robot, at_s=end_s, why="did not arrive")

    def _dropped(self, robot: int, arrived_leaders: list[int]) -> Lost | None:
        """When the last leader's line of rosters lost a robot for good, and by whom."""
        leaders = arrived_leaders or [reign.leader for reign in self._reigns[-1:]]
        dropped: Lost | None = None
        for reign in self._reigns:
            if leaders[0] not in reign.members:
                continue
            if robot in reign.members:
                dropped = None
            elif dropped is None:
                why = f"dropped from the roster of robot {reign.leader}"
                dropped = Lost(robot=robot, at_s=reign.at_s, why=why)
        return dropped


def _roster(status: Status) -> tuple[int, tuple[int, ...], Shape]:
    return status.epoch, status.members, status.shape


def _extent(status: Status, spacing: float) -> float:
    """How far behind its leader the last slot of a formation may lie, and half a spacing more [m]."""
    followers = len(status.members) - 1
    ranks = followers if status.shape is Shape.COLUMN else (followers + 1) // 2
    return (ranks + 0.5) * spacing
