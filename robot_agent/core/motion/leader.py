"""How a leader drives: it plans (planning/), watches for passages, and gets out of jams of its own team.

The leader never waits for its followers (thesis 3.8.2), unless the scenario says that it slows down for
stragglers.

Differs: a planner knows no team mates, they are left out of what it sees (mates.py); where they stand in
its way nevertheless, the leader steers around them like a follower until it moves again.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, to_map, wrap_angle
from onehop.contracts.messages import Note
from onehop.contracts.sections import GainsSection
from onehop.contracts.team import Mode
from onehop.contracts.units import NANOSECONDS
from robot_agent.core.motion.follower_detector import FollowerDetector, painted
from robot_agent.core.motion.lane import LaneRequest
from robot_agent.core.motion.steering import LOOKAHEAD, Steering
from robot_agent.core.motion.tracking import turn_towards
from robot_agent.core.motion.trail import Trail
from robot_agent.core.planning import Guidance, Pathfinder, PlannerStatus
from robot_agent.core.team.formation import formation, width
from robot_agent.core.team.part import Leading
from robot_agent.core.team.state import TeamState

PathfinderMaker = Callable[[Briefing, Pose, np.random.Generator], Pathfinder]

ALIGNED = 0.05
"""The leader faces the goal within this angle before it gathers the team [rad] (thesis 3.4.1)."""

MATE_TOLERANCE = 1.0
"""A round thing this near to where a follower can be by its last report is that follower [m]."""

WIDEST_PASSAGE = 9.0
"""Passages wider than this never make a column, whatever the shape [m]: almost the laser's range."""

NARROW_AFTER = 0.5
"""A passage is narrow once it was for this long [s]; one look past a corner is not enough."""

JAMMED_AFTER, UNJAM_FOR = 1.5, 1.5
"""Time without getting anywhere after which the leader steers around its mates, and for how long [s]."""

JAM_RADIUS = 0.15
"""Moving less than this is getting nowhere [m]."""

MATES_NEAR = 1.0
"""Something this near is needed for a jam [m]."""


class LeaderDecision(NamedTuple):
    """What a leader does at a tick, and what it wants of its team."""

    twist: Twist
    narrow: bool
    passage: float = math.inf
    lane: tuple[tuple[float, float], ...] = ()
    lane_is_news: bool = False
    status: PlannerStatus = PlannerStatus.DRIVING
    notes: tuple[Note, ...] = ()


class Leader:
    """Drives one robot while it leads. `begin` at each election."""

    def __init__(
        self,
        briefing: Briefing,
        gains: GainsSection,
        fan: Beams,
        make_pathfinder: PathfinderMaker,
        rng: np.random.Generator,
    ) -> None:
        self._briefing = briefing
        self._gains = gains
        self._make_pathfinder = make_pathfinder
        self._rng = rng
        self._lookout = FollowerDetector(briefing.body, fan)
        self._steering = Steering(briefing.body, fan)
        self._request = LaneRequest(fan, briefing.period_ns / NANOSECONDS)
        self._period = briefing.period_ns / NANOSECONDS
        self._pathfinder: Pathfinder | None = None
        self.trail = Trail()
        self.remaining = 0.0
        self._narrow_for = 0.0
        self._wide_for = 0.0
        self._still_at = (0.0, 0.0)
        self._still_for = 0.0
        self._unjam = 0.0

    def begin(self) -> None:
        """A leadership begins: with a new pathfinder and a new trail."""
        self._pathfinder = None
        self.trail = Trail()
        self._request.begin()
        self._still_for = self._unjam = self._narrow_for = 0.0

    def step(
        self, state: TeamState, part: Leading, now_ns: int, pose: Pose, scan: Ranges, nearest: float,
        makes_room: bool,
    ) -> LeaderDecision:  # fmt: skip
        """What to do at this tick."""
        goal, body = self._briefing.goal, self._briefing.body
        self.trail.mark(pose)
        if state.mode is Mode.SETUP:
            bearing = wrap_angle(elementary.atan2(goal.y - pose.y, goal.x - pose.x) - pose.heading)
            turn = turn_towards(bearing, self._gains, body) if abs(bearing) >= ALIGNED else STANDSTILL
            return LeaderDecision(turn, state.narrow)
        if state.mode is Mode.STOPPED:
            return LeaderDecision(STANDSTILL, state.narrow)
        if self._pathfinder is None:
            self._pathfinder = self._make_pathfinder(self._briefing, pose, self._rng)
        mates = self._mates(part, now_ns, pose, scan)
        guidance = self._pathfinder.step(pose, painted(scan, mates))
        self.remaining = guidance.remaining
        if guidance.progress is not PlannerStatus.DRIVING:
            return LeaderDecision(
                STANDSTILL, state.narrow, status=guidance.progress, notes=guidance.notes
            )
        narrow = self._watch_passage(state, guidance.passage)
        decision = LeaderDecision(guidance.twist, narrow, guidance.passage, notes=guidance.notes)
        if makes_room:
            say = self._request.watch(pose, scan, mates, guidance.waypoint)
            decision = decision._replace(lane=self._request.lane, lane_is_news=say)
            if self._request.wait:
                return decision._replace(twist=Twist(0.0, guidance.twist.w))
        if self._jammed(pose, nearest):
            return decision._replace(twist=self._around(pose, scan, guidance))
        return decision._replace(twist=self._waiting(state, part, guidance.twist))

    def _mates(self, part: Leading, now_ns: int, pose: Pose, scan: Ranges) -> frozenset[int]:
        """Beams that hit followers, as far as their reports say where they may be by now."""
        reports = part.ledger.reports
        if not reports:
            return frozenset()
        age = (now_ns - part.schedule.commanded_ns) / NANOSECONDS
        reach = self._briefing.body.max_speed * age + MATE_TOLERANCE
        places = [(report.pose.x, report.pose.y) for report in reports.values()]
        return self._lookout.beams(pose, scan, places, reach)

    def _watch_passage(self, state: TeamState, passage: float) -> bool:
        """Narrow and back: column while the passage is too tight for the shape (thesis 3.3.1)."""
        team, body, members = self._briefing.team, self._briefing.body, state.roster.members
        if len(members) < 3:
            return False
        if 2.0 * body.radius < passage < WIDEST_PASSAGE and passage < self._needed(members):
            self._wide_for = 0.0
            self._narrow_for += self._period
            return state.narrow or self._narrow_for >= NARROW_AFTER
        self._narrow_for = 0.0
        self._wide_for += self._period
        column = team.narrow_spacing * len(members)
        return state.narrow and self._wide_for * body.leader_speed <= column

    def _needed(self, members: tuple[int, ...]) -> float:
        """Free width that the shape of the team needs [m]."""
        shape = formation(members, False, self._briefing.team.spacing)
        return width(shape) + 4.0 * self._briefing.body.radius

    def _jammed(self, pose: Pose, nearest: float) -> bool:
        """Whether the leader stands among its mates for too long, or is still on its way out."""
        if self._unjam > 0.0:
            self._unjam -= self._period
            return True
        if math.dist(self._still_at, (pose.x, pose.y)) > JAM_RADIUS or nearest > MATES_NEAR:
            self._still_at, self._still_for = (pose.x, pose.y), 0.0
            return False
        self._still_for += self._period
        if self._still_for < JAMMED_AFTER:
            return False
        self._still_for, self._unjam = 0.0, UNJAM_FOR
        return True

    def _around(self, pose: Pose, scan: Ranges, guidance: Guidance) -> Twist:
        """Towards the virtual goal through whatever gap there is."""
        body = self._briefing.body
        x, y = guidance.waypoint
        bearing = wrap_angle(elementary.atan2(y - pose.y, x - pose.x) - pose.heading)
        if abs(bearing) > 1.2:
            return turn_towards(bearing, self._gains, body)
        self._steering.look(scan)
        choice = self._steering.choose(bearing, LOOKAHEAD / 3.0, 0)
        if choice is None:
            return turn_towards(math.copysign(0.4, bearing), self._gains, body)
        direction, free = choice
        facing = max(0.0, elementary.cos(direction))
        speed = min(body.leader_speed, max(0.0, free))
        return Twist(speed * facing * facing, turn_towards(direction, self._gains, body).w)

    def _waiting(self, state: TeamState, part: Leading, twist: Twist) -> Twist:
        """The same arc, slower while somebody straggles, if the scenario says so."""
        share = self._briefing.team.straggler_speed
        if share >= 1.0:
            return twist
        spacing = self._briefing.team.spacing
        for slot in formation(state.roster.members, state.narrow, spacing).slots:
            report = part.ledger.reports.get(slot.robot)
            if report is not None:
                x, y = to_map(part.told, slot.x, slot.y)
                if math.hypot(report.pose.x - x, report.pose.y - y) > spacing:
                    return Twist(share * twist.v, share * twist.w)
        return twist
