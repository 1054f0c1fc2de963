"""How a leader drives: it plans (planning/), watches for passages, and gets past its own team.

The leader never waits for its followers (thesis 3.8.2), unless the scenario says that it slows down for
stragglers.

Differs: a planner knows no followers, they are removed from what it sees (follower_detector.py); where
they stand in its way nevertheless, the leader asks them for a lane (lane.py), and steers around them
like a follower until it moves again (jam.py).
"""

import math
from collections.abc import Callable, Mapping

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, to_map, wrap_angle
from onehop.contracts.messages import Note
from onehop.contracts.sections import GainsSection
from onehop.contracts.values import Value
from robot_agent.core.motion.column import SMALLEST_SHAPE, ColumnWatch
from robot_agent.core.motion.follower_detector import (
    BeamNumbers,
    FollowerDetector,
    without_followers,
)
from robot_agent.core.motion.jam import LeaderJam
from robot_agent.core.motion.lane import LaneRequest
from robot_agent.core.motion.occupied_goal import OccupiedGoal
from robot_agent.core.motion.steering import Steering
from robot_agent.core.motion.trail import Point, Trail
from robot_agent.core.planning import Pathfinder, PlannerStatus
from robot_agent.core.team.formation import formation

PathfinderMaker = Callable[[Briefing, Pose, np.random.Generator], Pathfinder]

ALIGNED = 0.05
"""The leader faces the goal within this angle before it gathers the team [rad] (thesis 3.4.1)."""

REPORT_TOLERANCE = 1.0
"""A round thing this near to where a follower can be by its last report is that follower [m]."""


class TeamView(Value, frozen=True):
    """What a leader knows of its team at a tick. Map frame, SI units.

    gathering: its followers still form up around it. members: all, itself included. column: they drive
    in column. reports: where each follower said that it was; reports_age: since they were asked [s].
    announced: the pose that followers were last told to form up on. may_ask_for_room: see lane.py.
    pace: share of its speed that the gain policy leaves it.
    """

    gathering: bool
    members: tuple[int, ...]
    column: bool
    reports: Mapping[int, Point]
    reports_age: float
    announced: Pose
    may_ask_for_room: bool
    pace: float = 1.0


class LeaderDecision(Value, frozen=True):
    """What a leader is up to at a tick, and what it wants of its team.

    planned: the twist that way-finding gave. remaining: way still to drive [m]. waypoint: where it is
    driving to; None while it gathers the team, and at the end. column: the team shall drive in column.
    passage: the width [m] for which; None where the team is too small for any other shape. lane: to be
    kept clear; lane_is_news: to be told at once. notes: of its way-finding, for people.
    """

    planned: Twist
    status: PlannerStatus
    remaining: float
    waypoint: Point | None
    column: bool
    passage: float | None = None
    lane: tuple[Point, ...] = ()
    lane_is_news: bool = False
    notes: tuple[Note, ...] = ()


class LeaderMotion:
    """Drives one robot while it leads. `begin` with each leadership term."""

    def __init__(
        self,
        briefing: Briefing,
        gains: GainsSection,
        beams: Beams,
        make_pathfinder: PathfinderMaker,
        rng: np.random.Generator,
    ) -> None:
        period = briefing.period_ns / 1e9
        self._briefing = briefing
        self._make_pathfinder = make_pathfinder
        self._rng = rng
        self._steering = Steering(briefing.body, gains, beams)
        self._detector = FollowerDetector(briefing.body, beams)
        self._columns = ColumnWatch(briefing.body, briefing.team, period)
        self.lane = LaneRequest(beams, period)
        self.jam = LeaderJam(briefing.body, self._steering, period)
        self._occupied_goal = OccupiedGoal(briefing, beams)
        self._pathfinder: Pathfinder | None = None
        self._status = PlannerStatus.DRIVING
        self._remaining = 0.0
        self.trail = Trail()

    def begin(self) -> None:
        """A leadership term starts with a new pathfinder and a new trail."""
        self._pathfinder, self._status = None, PlannerStatus.DRIVING
        self.trail = Trail()
        self.lane.begin()
        self.jam.begin()
        self._columns.begin()

    def decide(self, pose: Pose, scan: Ranges, team: TeamView) -> LeaderDecision:
        """What way-finding wants at this tick, and what of the team; robot_motion.py drives by it."""
        self.trail.mark(pose)
        if team.gathering:
            return self._face_goal(pose, team)
        if self._status is PlannerStatus.DRIVING and self._occupied_goal.reached(pose, scan):
            self._status = PlannerStatus.ARRIVED
        if self._status is not PlannerStatus.DRIVING:
            return self._stop(team, ())
        if self._pathfinder is None:
            self._pathfinder = self._make_pathfinder(self._briefing, pose, self._rng)
        followers = self._followers(pose, scan, team)
        guidance = self._pathfinder.step(pose, without_followers(scan, followers))
        self._status = guidance.status
        self._remaining = guidance.remaining
        if self._status is not PlannerStatus.DRIVING:
            return self._stop(team, guidance.notes)
        column = self._columns.step(guidance.passage, team.members, team.column)
        lane_is_news = team.may_ask_for_room and self.lane.watch(
            pose, scan, followers, guidance.waypoint
        )
        return LeaderDecision(
            planned=guidance.twist,
            status=self._status,
            remaining=self._remaining,
            waypoint=guidance.waypoint,
            column=column,
            passage=guidance.passage if len(team.members) >= SMALLEST_SHAPE else None,
            lane=self.lane.lane,
            lane_is_news=lane_is_news,
            notes=guidance.notes,
        )

    def slowed_for_stragglers(self, twist: Twist, team: TeamView, column: bool) -> Twist | None:
        """The same arc, slower, while somebody straggles and scenario or policy say so; else None."""
        if team.pace < 1.0:
            return Twist(team.pace * twist.v, team.pace * twist.w)
        section = self._briefing.team
        share, announced = section.straggler_speed, team.announced
        if share >= 1.0:
            return None
        spacing = section.narrow_spacing if column else section.spacing
        for slot in formation(team.members, column, spacing).slots:
            place = team.reports.get(slot.robot)
            if place is not None:
                x, y = to_map(announced, slot.x, slot.y)
                if math.hypot(place[0] - x, place[1] - y) > section.spacing:
                    return Twist(share * twist.v, share * twist.w)
        return None

    def _face_goal(self, pose: Pose, team: TeamView) -> LeaderDecision:
        """Turn to the goal, then wait until the team has formed up (thesis 3.4.1)."""
        dx, dy = self._briefing.goal.x - pose.x, self._briefing.goal.y - pose.y
        bearing = wrap_angle(elementary.atan2(dy, dx) - pose.heading)
        twist = self._steering.turn(bearing) if abs(bearing) >= ALIGNED else STANDSTILL
        return LeaderDecision(twist, self._status, math.hypot(dx, dy), None, team.column)

    def _stop(self, team: TeamView, notes: tuple[Note, ...]) -> LeaderDecision:
        """At the goal, or where all ways end."""
        return LeaderDecision(STANDSTILL, self._status, self._remaining, None, team.column, notes=notes)

    def _followers(self, pose: Pose, scan: Ranges, team: TeamView) -> BeamNumbers:
        """The beams that hit followers, as far as their reports say where they may be by now."""
        reach = self._briefing.body.max_speed * team.reports_age + REPORT_TOLERANCE
        return self._detector.beams(pose, scan, tuple(team.reports.values()), reach)
