"""The world of one mission, tick by tick: who is where, what each sees, what is broken, how it ends.

Every driver calls, in this order and once a tick: truth(), observe(), advance(). Faults, departures and
returns take effect in the next truth(). The body of a robot whose process is gone stays where it was:
others see it and can touch it, and a restarted process wakes up in it.
"""

import math
from collections.abc import Mapping

import numpy as np

from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.messages import (
    Action,
    Contact,
    Departure,
    Observation,
    Offer,
    Outcome,
    Presence,
    Truth,
)
from onehop.contracts.scenario import FaultSection, Scenario
from onehop.contracts.team import Status
from world_server.core.contacts import Touches
from world_server.core.faults import Faults
from world_server.core.laser import Laser
from world_server.core.motion import Motion
from world_server.core.placement import start_poses
from world_server.core.referee import Referee, Standing
from world_server.core.walls import WallMap

KILLED = "killed (scenario)"
RESTARTED = "restarted (scenario)"


class World:
    """Ground truth of one mission. Raises ScenarioError when the team cannot start on this map."""

    def __init__(self, scenario: Scenario, walls: WallMap) -> None:
        self._robots = scenario.team.robots
        self._row = {robot: row for row, robot in enumerate(self._robots)}
        self._body = scenario.robot
        self._period_ns = scenario.clock.period_ns
        self._poses = start_poses(scenario, walls)
        self._twists = np.zeros((len(self._robots), 2))
        self._laser = Laser(walls, scenario.robot)
        self._motion = Motion(walls, scenario.robot, self._period_ns)
        self._touches = Touches(self._robots, self._motion, scenario.robot.radius)
        self._faults = Faults(scenario.faults, self._robots)
        self._referee = Referee(scenario)
        self._incarnation = dict.fromkeys(self._robots, 0)
        self._present = dict.fromkeys(self._robots, True)
        self._statuses: dict[int, Status] = {}
        self._offers: dict[int, Offer] = {}
        self._departures: list[Departure] = []
        self._contacts: tuple[Contact, ...] = ()
        self._collisions = 0
        self._outcome: Outcome | None = None
        self._truth: Truth | None = None
        self.tick = 0
        self._begin_tick()

    @property
    def time_ns(self) -> int:
        """Simulated time at the current tick [ns]."""
        return self.tick * self._period_ns

    def due_faults(self) -> tuple[FaultSection, ...]:
        """Faults of the script that this tick's truth shows for the first time.

        The world has already carried them out on itself; a driver with processes ends and starts those
        that a kill or restart names before it lets this tick go on.
        """
        return self._due

    def truth(self) -> Truth:
        """Ground truth of this tick: the same value until advance()."""
        if self._truth is None:
            present = self._presences()
            self._truth = Truth(
                tick=self.tick,
                time_ns=self.time_ns,
                present=present,
                offers=tuple(self._offers[one.robot] for one in present if one.robot in self._offers),
                cuts=self._faults.cuts,
                jams=self._faults.jams,
                contacts=self._contacts,
                departures=tuple(sorted(self._departures, key=lambda gone: gone.robot)),
            )
            self._departures = []
        return self._truth

    def observe(self) -> dict[int, Observation]:
        """What each robot that this tick's truth calls present sees now, by id, ids ascending."""
        truth = self.truth()
        looking = np.array([self._row[one.robot] for one in truth.present], dtype=np.int32)
        scans = self._laser.scans(self._poses, looking)
        scans.flags.writeable = False
        return {
            one.robot: Observation(truth.tick, truth.time_ns, one.incarnation, one.pose, one.twist, scan)
            for one, scan in zip(truth.present, scans, strict=True)
        }

    def advance(self, actions: Mapping[int, Action]) -> None:
        """Let one period pass. A present robot without an action stands still.

        Actions of robots that are not present, or of an earlier incarnation, are ignored. Raises
        ValueError for a twist that is not a number: a broken robot, not a state of the world.
        """
        self._take(actions)
        touched = self._motion.advance(self._poses, self._twists)
        self._contacts = self._touches.begun(self._poses, touched)
        self._collisions += len(self._contacts)
        self.tick += 1
        self._truth = None
        if self._outcome is None:
            self._outcome = self._referee.judge(
                self.tick, self.time_ns, self._standing(), self._faults.will_restart, self._collisions
            )
        self._begin_tick()

    def fence(self, robot: int, why: str) -> None:
        """Take a robot out of the mission, as of the next truth(): its process died or fell silent."""
        if self._present[robot]:
            self._present[robot] = False
            self._departures.append(Departure(robot, why))
            self._forget(robot)
            self._referee.on_departure(robot, why, self.time_ns)

    def admit(self, robot: int) -> None:
        """Let a robot take part again, as of the next truth(), where its body stands."""
        if not self._present[robot]:
            self._present[robot] = True
            self._incarnation[robot] += 1
            self._forget(robot)
            self._referee.on_return(robot)

    def inject(self, fault: FaultSection) -> None:
        """Carry out a fault that is not in the script, as of the next truth(); its at_s is ignored."""
        self._faults.begin(fault, self.time_ns)
        self._strike(fault)

    def outcome(self) -> Outcome | None:
        """How the mission ended, or None while it goes on."""
        return self._outcome

    def aborted(self, reason: str) -> Outcome:
        """The account of a mission that is broken off now."""
        return self._referee.close(
            "aborted", reason, self.tick, self.time_ns, self._standing(), self._collisions
        )

    def _begin_tick(self) -> None:
        self._faults.expire(self.time_ns)
        self._due = self._faults.due(self.time_ns)
        for fault in self._due:
            self._strike(fault)

    def _strike(self, fault: FaultSection) -> None:
        if fault.kind == "kill":
            for robot in sorted(fault.robots):
                self.fence(robot, KILLED)
        elif fault.kind == "restart":
            for robot in sorted(fault.robots):
                self.fence(robot, RESTARTED)
                self.admit(robot)

    def _forget(self, robot: int) -> None:
        """Drop what the last process of a robot said and did."""
        self._twists[self._row[robot]] = 0.0
        self._offers.pop(robot, None)
        self._statuses.pop(robot, None)

    def _take(self, actions: Mapping[int, Action]) -> None:
        """Take over twists, offers and words of the robots that are present."""
        self._twists[:] = 0.0
        self._offers = {}
        for robot in self._robots:
            action = actions.get(robot)
            if (
                action is None
                or not self._present[robot]
                or action.incarnation != self._incarnation[robot]
            ):
                continue
            self._offers[robot] = Offer(robot, action.speed, action.remaining_distance, action.outbox)
            self._statuses[robot] = action.status
            self._referee.on_notes(robot, action.notes)
            if robot not in self._faults.held:
                self._twists[self._row[robot]] = self._driven(robot, action.twist)

    def _driven(self, robot: int, twist: Twist) -> tuple[float, float]:
        """What the motors make of a command: no more than they can."""
        if not (math.isfinite(twist.v) and math.isfinite(twist.w)):
            raise ValueError(f"robot {robot} commands the twist ({twist.v}, {twist.w})")
        speed, rate = self._body.max_speed, self._body.max_turn_rate
        return max(-speed, min(speed, twist.v)), max(-rate, min(rate, twist.w))

    def _presences(self) -> tuple[Presence, ...]:
        poses, twists = self._poses.tolist(), self._twists.tolist()
        held = self._faults.held
        return tuple(
            Presence(
                robot,
                self._incarnation[robot],
                Pose(*poses[row]),
                Twist(*twists[row]) if twists[row] != [0.0, 0.0] else STANDSTILL,
                robot in held,
            )
            for robot, row in self._row.items()
            if self._present[robot]
        )

    def _standing(self) -> list[Standing]:
        poses, twists = self._poses.tolist(), self._twists.tolist()
        released = self._faults.released
        return [
            Standing(
                robot,
                poses[row][0],
                poses[row][1],
                abs(twists[row][0]),
                self._statuses.get(robot),
                robot in released,
            )
            for robot, row in self._row.items()
            if self._present[robot]
        ]
