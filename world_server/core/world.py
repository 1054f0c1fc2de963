"""The world of one mission, tick by tick: who is where, what each sees, what is broken, how it ends.

Every driver calls, in this order and once a tick: truth(), observe(), advance(). Faults, departures and
returns take effect in the next truth(). A robot that is stopped takes part in none of them, and its
body and its NIC stay. The body of a robot whose process is gone stays where it was:
others see it and can touch it, and a restarted process wakes up in it. A robot with a real base is
where that has measured itself to be (bases.py).
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from onehop.contracts.fault_section import FaultSection
from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.hardware import Measured
from onehop.contracts.messages import (
    Action,
    Contact,
    Departure,
    Observation,
    Outcome,
    Presence,
    TransmitRequest,
    Truth,
    running,
)
from onehop.contracts.scenario import Scenario
from onehop.contracts.team import Status
from onehop.maps.walls import WallMap
from world_server.core.bases import Bases
from world_server.core.contacts import ContactDetector
from world_server.core.faults import Faults
from world_server.core.kidnapping import landing, require_free_targets
from world_server.core.laser import Lasers
from world_server.core.late_actions import LateActions
from world_server.core.mission_events import EventDetector
from world_server.core.motion import Motion, Rows
from world_server.core.orders import Judge
from world_server.core.placement import start_poses
from world_server.core.referee import Referee, TickSummary
from world_server.core.sensor_noise import sensor_noise

KILLED = "killed by a fault"
RESTARTED = "restarted by a fault"

NOTHING_MEASURED: Mapping[int, Measured] = {}
"""Of a team without real bases."""

_AT_REST = (0.0, 0.0)
"""v [m/s] and w [rad/s] of a robot that was told nothing, or is held."""


class World:
    """Ground truth of one mission. Raises ScenarioError when the team cannot start on this map."""

    def __init__(self, scenario: Scenario, walls: WallMap) -> None:
        self._robots = scenario.team.robots
        self._row = {robot: row for row, robot in enumerate(self._robots)}
        bodies = scenario.bodies
        self._motors = [(body.max_speed, body.max_turn_rate) for body in bodies]
        self._period_ns = scenario.clock.period_ns
        self._poses = start_poses(scenario, walls)
        self._walls, self._inflation = walls, scenario.planner.inflation
        require_free_targets(scenario.faults, walls, self._inflation)
        self.bases = Bases(scenario, walls)
        self._judge = Judge(self._robots, walls, self._inflation, frozenset(self.bases))
        self._twists = np.zeros((len(self._robots), 2))
        self._lasers = Lasers(walls, bodies)
        self._noise = {
            robot: noise
            for robot, body in zip(self._robots, bodies, strict=True)
            if robot not in self.bases
            and (noise := sensor_noise(scenario.seed, robot, body)) is not None
        }
        self._motion = Motion(walls, bodies, self._period_ns)
        self._contact_detector = ContactDetector(self._robots, self._motion)
        self._faults = Faults(scenario.faults, self._robots)
        self._late_actions = LateActions()
        self._events = EventDetector()
        self._referee = Referee(scenario)
        self._incarnation = dict.fromkeys(self._robots, 0)
        self._present = dict.fromkeys(self._robots, True)
        self._statuses: dict[int, Status | None] = {}
        self._transmit_requests: dict[int, TransmitRequest] = {}
        self._departures: list[Departure] = []
        self._contacts: tuple[Contact, ...] = ()
        self._collisions = 0
        self._outcome: Outcome | None = None
        self.tick = 0
        self._truth: Truth | None = None
        self._observations: dict[int, Observation] | None = None
        self._present_now: tuple[Presence, ...] | None = None
        self._begin_tick()

    @property
    def time_ns(self) -> int:
        """Simulated time at the current tick [ns]."""
        return self.tick * self._period_ns

    def truth(self) -> Truth:
        """Ground truth of this tick: the same value until advance()."""
        if self._truth is None:
            present, requests = self._presences(), self._transmit_requests
            self._truth = Truth(
                tick=self.tick,
                time_ns=self.time_ns,
                present=present,
                transmit_requests=tuple(
                    [requests[one.robot] for one in present if one.robot in requests]
                ),
                cuts=self._faults.cuts,
                jams=self._faults.jams,
                contacts=self._contacts,
                departures=tuple(sorted(self._departures, key=lambda gone: gone.robot)),
                faults=self._begun,
                stopped=self._present_among(self._faults.stopped),
                blind=self._present_among(self._faults.blind),
                slow=self._faults.slow,
                corruptions=self._faults.corruptions,
            )
            self._departures = []
        return self._truth

    def observe(self) -> dict[int, Observation]:
        """What each robot that runs at this tick sees now, by id, ids ascending.

        Pose and scan are what its sensors say, with their noise if they have any. The same values until
        advance().
        """
        if self._observations is None:
            self._observations = self._observed()
        return self._observations

    def _observed(self) -> dict[int, Observation]:
        truth = self.truth()
        tick, time_ns, observers = truth.tick, truth.time_ns, running(truth)
        scans = self._lasers.scans(self._poses, [self._row[one.robot] for one in observers])
        if self.bases:
            scans = [
                self.bases.scan(one.robot, self._poses) if one.robot in self.bases else scan
                for one, scan in zip(observers, scans, strict=True)
            ]
        for one, scan in zip(observers, scans, strict=True):
            if one.robot in truth.blind:
                scan[:] = math.inf
            if one.robot in self._noise:
                self._noise[one.robot].blur(scan)
            scan.flags.writeable = False
        return {
            one.robot: Observation(tick, time_ns, one.incarnation, self._told_pose(one), one.twist, scan)
            for one, scan in zip(observers, scans, strict=True)
        }

    def _told_pose(self, one: Presence) -> Pose:
        """Where a robot takes itself to be."""
        noise = self._noise.get(one.robot)
        return one.pose if noise is None else noise.pose(one.pose)

    def place(self, measured: Mapping[int, Measured]) -> None:
        """Put the robots with real bases where these are, before the first truth."""
        self.bases.place(measured, self._poses, self._twists)
        self._present_now = None

    def no_start(self) -> str | None:
        """Why the team cannot start where its real bases stand, in one line; None if it can."""
        return self.bases.no_start(self._poses)

    def drives(self) -> dict[int, Twist]:
        """By what real bases are to drive from now on: what would have moved a simulated robot.

        Who is held, stopped or not in the mission rests at once.
        """
        rests = self._faults.held | self._faults.stopped
        return {
            robot: self.bases.command(robot)
            if self._present[robot] and robot not in rests
            else STANDSTILL
            for robot in self.bases
        }

    def advance(
        self,
        actions: Mapping[int, Action],
        by_hand: Sequence[FaultSection] = (),
        measured: Mapping[int, Measured] = NOTHING_MEASURED,
    ) -> None:
        """Let one period pass. A present robot without an action stands still.

        by_hand: faults that begin with the next tick, beside those of the script. measured: by real
        bases, since the last tick; one without stands where it was. Actions of robots that
        are not present or are stopped, or of an earlier incarnation, are ignored. Raises ValueError for
        a twist that is not a number: a broken robot, not a state of the world.
        """
        faults = self._faults
        self._take_over(self._late_actions.effective(actions, self.tick, faults.delays, faults.stopped))
        if self.bases:
            touched = self._advance_with_bases(measured)
        else:
            touched = self._motion.advance(self._poses, self._twists)
        self._contacts = self._contact_detector.onsets(self._poses, touched)
        self._collisions += len(self._contacts)
        self.tick += 1
        self._begin_tick(by_hand)
        if self._outcome is None:
            self._outcome = self._referee.judge(self._tick_summary(), self._faults.will_restart)

    def _advance_with_bases(self, measured: Mapping[int, Measured]) -> Rows:
        """Move who is simulated, with real bodies where they were; then these are where they are."""
        bases, poses, twists = self.bases, self._poses, self._twists
        bases.set_off(twists)
        touched = self._motion.advance(poses, twists, bases.radii(poses))
        bases.place(measured, poses, twists)
        bases.touch(poses, touched)
        return touched

    def refusal(self, fault: FaultSection) -> str | None:
        """Why a fault that is ordered by hand cannot be carried out; None if it can."""
        return self._judge.refusal(fault, self.truth())

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

    def outcome(self) -> Outcome | None:
        """How the mission ended, or None while it goes on."""
        return self._outcome

    def aborted(self, reason: str) -> Outcome:
        """The account of a mission that is broken off now."""
        return self._referee.close("aborted", reason, self._tick_summary())

    def _begin_tick(self, by_hand: Sequence[FaultSection] = ()) -> None:
        self._truth = self._present_now = self._observations = None
        self._faults.expire(self.time_ns)
        self._begun = self._faults.due(self.time_ns, by_hand)
        for fault in self._begun:
            self._faults.begin(fault, self.time_ns)
            self._carry_out(fault)

    def _carry_out(self, fault: FaultSection) -> None:
        """Carry out what of a fault concerns who is present and where, as of the next truth()."""
        for robot in fault.robots:
            if fault.kind == "kill":
                self.fence(robot, KILLED)
            elif fault.kind == "restart":
                self.fence(robot, RESTARTED)
                self.admit(robot)
            elif fault.kind == "kidnap":
                self._kidnap(robot, fault)

    def _kidnap(self, robot: int, fault: FaultSection) -> None:
        """Put the body of a robot elsewhere, at rest."""
        row = self._row[robot]
        others = np.arange(len(self._poses)) != row
        radii = self._motion.radii
        bodies = self._poses[others, :2], radii[others]
        self._poses[row] = landing(fault, self._walls, self._inflation, float(radii[row]), *bodies)
        self._twists[row] = 0.0
        self._present_now = None

    def _present_among(self, robots: frozenset[int]) -> tuple[int, ...]:
        return tuple(sorted(robot for robot in robots if self._present[robot])) if robots else ()

    def _forget(self, robot: int) -> None:
        """Drop what the last process of a robot said and did."""
        self._present_now = None
        if robot in self.bases:
            self.bases.rest(robot)
        else:
            self._twists[self._row[robot]] = 0.0
        self._transmit_requests.pop(robot, None)
        self._statuses.pop(robot, None)
        self._faults.forget(robot)
        self._late_actions.forget(robot)
        self._events.forget(robot)

    def _take_over(self, actions: Mapping[int, Action]) -> None:
        """Take over twists, transmit requests, statuses and notes of the robots that are present."""
        self._transmit_requests = {}
        held = self._faults.held
        driven = [_AT_REST] * len(self._robots)
        for robot, row in self._row.items():
            action = actions.get(robot)
            if (
                action is None
                or not self._present[robot]
                or robot in self._faults.stopped
                or action.incarnation != self._incarnation[robot]
            ):
                continue
            self._transmit_requests[robot] = TransmitRequest(
                robot, action.speed, action.remaining_distance, action.outbox
            )
            self._statuses[robot] = action.status
            if action.notes:
                self._referee.on_notes(robot, action.notes)
            for event in self._events.on_action(robot, action):
                self._faults.on_event(event, self.time_ns + self._period_ns)
            if robot not in held:
                driven[row] = self._driven(robot, row, action.twist)
        self._twists[:] = driven

    def _driven(self, robot: int, row: int, twist: Twist) -> tuple[float, float]:
        """What a robot's motors make of a command: no more than they can."""
        v, w = twist.v, twist.w
        if not (math.isfinite(v) and math.isfinite(w)):
            raise ValueError(f"robot {robot} commands the twist ({v}, {w})")
        speed, rate = self._motors[row]
        return max(-speed, min(speed, v)), max(-rate, min(rate, w))

    def _presences(self) -> tuple[Presence, ...]:
        """Who is present now, ids ascending; kept until somebody moves, leaves or returns."""
        if self._present_now is None:
            poses, twists = self._poses.tolist(), self._twists.tolist()
            held, incarnation = self._faults.held, self._incarnation
            self._present_now = tuple(
                [
                    Presence(
                        robot, incarnation[robot], Pose(*poses[row]), Twist(*twists[row]), robot in held
                    )
                    for robot, row in self._row.items()
                    if self._present[robot]
                ]
            )
        return self._present_now

    def _tick_summary(self) -> TickSummary:
        return TickSummary(
            self.tick,
            self.time_ns,
            self._presences(),
            self._statuses,
            self._faults.resting,
            self._collisions,
        )
