"""One robot: everything that it knows in, everything that it does out (`Percept -> Action`).

Order of a tick: hear (protocol), drive (planner when leading, tracking when following), speak.
"""

import math
from collections.abc import Callable

import numpy as np

from onehop.contracts.geometry import STANDSTILL, Pose, Twist, to_map, wrap_angle
from onehop.contracts.messages import Action, Note, Percept, Ranges
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import Briefing
from onehop.contracts.team import Mode, Status
from robot_agent.core.follower import IN_POSITION, Follower
from robot_agent.core.formation import Formation, formation, width
from robot_agent.core.gains import make_policy
from robot_agent.core.mates import Lookout
from robot_agent.core.messages import Phase
from robot_agent.core.modes import Event
from robot_agent.core.planning import Pathfinder, Progress, make_pathfinder
from robot_agent.core.protocol import NANOSECONDS, Protocol
from robot_agent.core.safety import SafetyFilter
from robot_agent.core.scan import Fan
from robot_agent.core.tracking import sampled, turn_towards
from robot_agent.core.trail import behind

PathfinderMaker = Callable[[Briefing, Pose, np.random.Generator], Pathfinder]

THESIS_THRESHOLD_BPS = 0.5333e6
"""Minimum acceptable throughput [bit/s] (thesis 3.8.3)."""

ALIGNED = 0.05
"""The leader faces the goal within this angle before it gathers the team [rad] (thesis 3.4.1)."""

MATE_TOLERANCE = 1.0
"""A round thing this near to where a follower can be by its last report is that follower [m]."""

TRAIL_STEP, TRAIL_POINTS = 1.0, 24
"""Spacing [m] and number of the points of its way that a leader tells."""

SETTLING_TICKS = 100
"""Ticks without coming nearer to its last slot after which a follower stops where it is."""

FOLLOWER_MODES = (Mode.FOLLOWING, Mode.NARROW, Mode.BORDER)


class Robot:
    """One incarnation of one robot."""

    def __init__(self, briefing: Briefing, make_pathfinder: PathfinderMaker = make_pathfinder) -> None:
        self._briefing = briefing
        self._make_pathfinder = make_pathfinder
        self._rng = generator(briefing.seed, f"robot/{briefing.robot}/{briefing.incarnation}")
        body = briefing.body
        fan = Fan(body)
        period = briefing.period_ns / NANOSECONDS
        self._gains = sampled(briefing.gains, period)
        dodge = tuple(float(share) for share in self._rng.random(64))
        self._follower = Follower(body, self._gains, fan, dodge)
        self._lookout = Lookout(body, fan)
        self._safety = SafetyFilter(body, fan, period)
        self._threshold = THESIS_THRESHOLD_BPS
        self._policy = make_policy(briefing.gains, self._threshold)
        self._protocol: Protocol | None = None
        self._pathfinder: Pathfinder | None = None
        self._formation: Formation | None = None
        self._formation_key: tuple[tuple[int, ...], bool] | None = None
        self._period_ns = round(briefing.team.next_period * NANOSECONDS)
        self._slot_key: tuple[Pose, tuple[int, ...], bool, bool] | None = None
        self._slot = Pose(0.0, 0.0, 0.0)
        self._trail: list[tuple[float, float]] = []
        self._in_position = False
        self._next_ns = 0
        self._k_rho = briefing.gains.k_rho_min
        self._throughput = 0.0
        self._error = 0.0
        self._target = (0.0, 0.0)
        self._remaining = 0.0
        self._best_error = math.inf
        self._settling = 0
        self._wide_since_m = 0.0
        self._notes: list[Note] = []

    def step(self, percept: Percept) -> Action:
        """Everything that the robot does at this tick. Bad messages are counted, never raised."""
        protocol = self._protocol
        if protocol is None:
            protocol = self._protocol = Protocol(self._briefing, percept.time_ns)
        now_ns, pose = percept.time_ns, percept.pose
        protocol.receive(now_ns, pose, self._in_position, percept.inbox)
        nearest = float(percept.scan.min())
        if protocol.leading:
            twist = self._lead(protocol, now_ns, pose, percept.scan)
        else:
            twist = self._follow(protocol, now_ns, pose, percept.scan, nearest)
        twist = self._safety.filtered(twist, percept.scan, nearest)
        if not (protocol.leading and protocol.mode is Mode.SETUP and twist.w):
            protocol.speak(now_ns, pose, tuple(self._trail))
        notes = (*self._notes, *protocol.take_notes())
        self._notes = []
        return Action(
            tick=percept.tick,
            incarnation=self._briefing.incarnation,
            twist=twist,
            outbox=protocol.take_outbox(),
            speed=abs(twist.v),
            remaining_distance=self._remaining,
            status=self._status(protocol),
            notes=notes,
        )

    @property
    def ignored(self) -> dict[str, int]:
        """How many messages were ignored so far, by why: garbled, stale, foreign."""
        return dict(self._protocol.counters) if self._protocol is not None else {}

    def _status(self, protocol: Protocol) -> Status:
        leading = protocol.leading
        return Status(
            mode=protocol.mode,
            epoch=protocol.epoch,
            leader=protocol.leader,
            members=protocol.members,
            shape=self._shape(protocol).shape,
            throughput_bps=-1.0 if leading else self._throughput,
            threshold_bps=self._threshold,
            k_rho=self._k_rho,
            error=self._error,
            target_x=self._target[0],
            target_y=self._target[1],
        )

    def _shape(self, protocol: Protocol) -> Formation:
        """Formation of the roster in force."""
        key = (protocol.members, protocol.narrow)
        if self._formation is None or key != self._formation_key:
            team = self._briefing.team
            spacing = team.narrow_spacing if protocol.narrow else team.spacing
            self._formation = formation(protocol.members, protocol.narrow, spacing)
            self._formation_key = key
        return self._formation

    # leading

    def _lead(self, protocol: Protocol, now_ns: int, pose: Pose, scan: Ranges) -> Twist:
        briefing = self._briefing
        goal = briefing.goal
        self._target = (goal.x, goal.y)
        self._error = self._remaining = math.hypot(goal.x - pose.x, goal.y - pose.y)
        self._mark(pose)
        if protocol.mode is Mode.SETUP:
            bearing = wrap_angle(math.atan2(goal.y - pose.y, goal.x - pose.x) - pose.heading)
            return (
                STANDSTILL
                if abs(bearing) < ALIGNED
                else turn_towards(bearing, self._gains, briefing.body)
            )
        if protocol.mode is Mode.STOPPED:
            return STANDSTILL
        if self._pathfinder is None:
            self._pathfinder = self._make_pathfinder(briefing, pose, self._rng)
            self._follower.halt()
        guidance = self._pathfinder.step(pose, scan, self._mates(protocol, now_ns, pose, scan))
        self._notes.extend(guidance.notes)
        self._remaining = guidance.remaining
        if guidance.progress is not Progress.DRIVING:
            protocol.phase = Phase.FINAL
            protocol.fire(Event.ARRIVED)
            protocol.note("arrived" if guidance.progress is Progress.ARRIVED else "no_way")
            return STANDSTILL
        self._watch_passage(protocol, guidance.passage)
        return guidance.twist

    def _mates(self, protocol: Protocol, now_ns: int, pose: Pose, scan: Ranges) -> frozenset[int]:
        """Beams that hit followers, as far as their reports say where they may be by now."""
        leadership = protocol.leadership
        if leadership is None or not leadership.reports:
            return frozenset()
        age = (now_ns - leadership.opened_ns) / NANOSECONDS
        reach = self._briefing.body.max_speed * age + MATE_TOLERANCE
        places = [(report.pose.x, report.pose.y) for report in leadership.reports.values()]
        return self._lookout.beams(pose, scan, places, reach)

    def _mark(self, pose: Pose) -> None:
        """Remember the leader's own way."""
        trail = self._trail
        if not trail or math.hypot(pose.x - trail[-1][0], pose.y - trail[-1][1]) >= TRAIL_STEP:
            trail.append((pose.x, pose.y))
            del trail[:-TRAIL_POINTS]

    def _watch_passage(self, protocol: Protocol, passage: float) -> None:
        """Narrow and back: column while the passage is too tight for the shape (thesis 3.3.1)."""
        team, body = self._briefing.team, self._briefing.body
        if len(protocol.members) < 3:
            protocol.narrow = False
            return
        open_shape = formation(protocol.members, False, team.spacing)
        needed = min(width(open_shape) + 4.0 * body.radius, 9.0)
        if passage < needed:
            self._wide_since_m = 0.0
            if not protocol.narrow:
                protocol.narrow = True
                protocol.note("narrow", passage=passage)
        elif protocol.narrow:
            self._wide_since_m += body.leader_speed * self._briefing.period_ns / NANOSECONDS
            if self._wide_since_m > team.narrow_spacing * len(protocol.members):
                protocol.narrow = False
                protocol.note("wide", passage=passage)

    # following

    def _follow(
        self, protocol: Protocol, now_ns: int, pose: Pose, scan: Ranges, nearest: float
    ) -> Twist:
        self._pathfinder = None
        self._trail.clear()
        self._measure(protocol, now_ns)
        link = protocol.link
        leader = link.pose
        if leader is None:
            self._in_position = False
            self._target = (pose.x, pose.y)
            return STANDSTILL
        target = self._slot_pose(protocol, leader)
        self._target = (target.x, target.y)
        self._error = math.hypot(target.x - pose.x, target.y - pose.y)
        goal = self._briefing.goal
        self._remaining = math.hypot(goal.x - pose.x, goal.y - pose.y)
        self._in_position = self._error <= IN_POSITION
        if self._at_rest(protocol):
            return STANDSTILL
        standoff = math.hypot(target.x - leader.x, target.y - leader.y)
        twist = self._follower.step(pose, scan, nearest, target, link.trail, standoff, self._k_rho)
        self._tell_border(protocol)
        return twist

    def _slot_pose(self, protocol: Protocol, leader: Pose) -> Pose:
        """This robot's slot in the map frame, from the leader's last pose."""
        key = (leader, protocol.members, protocol.narrow, protocol.mode is Mode.JOINING)
        if key != self._slot_key:
            self._slot_key, self._slot = key, self._placed(protocol, leader)
        return self._slot

    def _placed(self, protocol: Protocol, leader: Pose) -> Pose:
        shape = self._shape(protocol)
        if protocol.mode is Mode.JOINING or shape.leader == self._briefing.robot:
            x, y = to_map(leader, -self._briefing.team.spacing, 0.0)
        else:
            slot = shape.slot(self._briefing.robot)
            if protocol.narrow and len(protocol.link.trail) > 1:
                return behind(leader, protocol.link.trail, -slot.x)
            x, y = to_map(leader, slot.x, slot.y)
        return Pose(x, y, leader.heading)

    def _measure(self, protocol: Protocol, now_ns: int) -> None:
        """Throughput of each Next, 0 for a missing one, and the gain that follows (thesis 3.5)."""
        link = protocol.link
        if link.next_ns > self._next_ns:
            self._next_ns = link.next_ns
            self._throughput = link.throughput_bps
            self._k_rho = self._policy.heard(link.throughput_bps)
        elif now_ns - self._next_ns > self._period_ns * 5 // 4:
            self._next_ns += self._period_ns
            self._throughput = 0.0
            self._k_rho = self._policy.heard(0.0)

    def _at_rest(self, protocol: Protocol) -> bool:
        """At the end of the mission: stop in the slot, or where nothing more is gained."""
        if protocol.mode is Mode.STOPPED and protocol.phase is not Phase.FINAL:
            return True
        if protocol.phase is not Phase.FINAL:
            self._best_error, self._settling = math.inf, 0
            return False
        if self._error < self._best_error - 0.05:
            self._best_error, self._settling = self._error, 0
        else:
            self._settling += 1
        rest = self._in_position or self._settling > SETTLING_TICKS
        if protocol.mode in FOLLOWER_MODES and rest:
            protocol.fire(Event.ARRIVED)
        return protocol.mode is Mode.STOPPED

    def _tell_border(self, protocol: Protocol) -> None:
        """Border following interrupts Algorithm 1 and resumes it (thesis 3.3.4)."""
        border = self._follower.border
        if border and protocol.mode in (Mode.FOLLOWING, Mode.NARROW):
            protocol.fire(Event.OBSTRUCTED)
        elif not border and protocol.mode is Mode.BORDER:
            protocol.fire(Event.CLEARED_NARROW if protocol.narrow else Event.CLEARED)
