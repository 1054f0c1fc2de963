"""The thesis's planners: virtual goal after virtual goal, and a step back when no point is left (3.4).

`original` samples the full 180 degree fan towards the goal. `modified` is Algorithm 2: an obstacle
within 3 m limits and turns the fan, where the robot plans, and with `planner.classify = "driving"` also
where a corner or a wall in front comes up on its way. Both know only the current scan and the list of
virtual goals. Both can be caught; that is what they are here to show.

Differs: while an obstacle turns the fan, the virtual goal is the point furthest along the fan, as the
text of 3.4.1 has it, not the nearest to the goal as in the listing, because the nearest one is beside
the robot and it would never go along a wall. Differs: `original` does not choose a virtual goal twice,
because otherwise its points are never used up (4.1) and the step back of the listing never happens.
Differs: at its start `modified` has no step to go back; it turns on and looks again, where the listing
says nothing, because a leader that is elected among its team sees nothing but robots for a while.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, wrap_angle
from onehop.contracts.messages import Note
from robot_agent.core.planning.distances import squared_distances
from robot_agent.core.planning.guidance import ARRIVED_WITHIN, Guidance, PlannerStatus
from robot_agent.core.planning.obstacle import TURNS, Obstacle, classify, fan_direction
from robot_agent.core.planning.passage import PASSAGE_AHEAD, passage_width
from robot_agent.core.planning.path_tracking import ALIGNED, PathTracker, Point
from robot_agent.core.planning.perception import GRAIN
from robot_agent.core.planning.roadmap import RoadMap
from robot_agent.core.planning.sampling import sample_fan
from robot_agent.core.planning.snapshot import PlanningSnapshot
from robot_agent.core.planning.view import NO_POINTS, View

LIMITED_HALF = math.radians(45.0)
"""Half of the limited fan [rad]; the thesis draws it (fig. 3.6) and gives no number."""

MOST_TURNS = 4
"""Turns of the fan at one virtual goal: then the whole circle was looked at."""

REACHED = 0.4
"""A virtual goal this near is reached, in inflations."""

GIVE_UP_S = 2.0
"""Time after which a robot that cannot come closer to its virtual goal takes it as reached [s]."""


class ThesisPlanner:
    """A pathfinder. limited: turn and limit the fan (`modified`), or not (`original`)."""

    def __init__(self, briefing: Briefing, pose: Pose, rng: np.random.Generator, limited: bool) -> None:
        self.section, self.rng, self.limited = briefing.planner, rng, limited
        self.goal: FloatArray = np.array((briefing.goal.x, briefing.goal.y))
        self.arrived_within = ARRIVED_WITHIN * briefing.goal.tolerance
        self.beams = Beams(briefing.body)
        self.inflation = self.section.inflation
        self.tracker = PathTracker(briefing.body, self.beams, briefing.period_ns, self.inflation, pose)
        self.tracker.face(self._to_goal(pose))
        self.virtual_goals: list[Point] = [(pose.x, pose.y)]
        self.used: FloatArray = np.array([(pose.x, pose.y)])
        self.turns = 0
        self.passage = math.inf
        self.status = PlannerStatus.DRIVING
        self.snapshot: PlanningSnapshot | None = None
        self.notes: list[Note] = []

    def step(self, pose: Pose, scan: Ranges) -> Guidance:
        """See Pathfinder."""
        remaining = math.dist((pose.x, pose.y), self.goal)
        if remaining <= self.arrived_within:
            self.status = PlannerStatus.ARRIVED
        twist = STANDSTILL
        if self.status is PlannerStatus.DRIVING:
            twist = self._drive(pose, scan)
        notes, self.notes = tuple(self.notes), []
        return Guidance(twist, self.status, remaining, self.passage, self.tracker.waypoint, notes)

    def _drive(self, pose: Pose, scan: Ranges) -> Twist:
        """Turn, plan, or go on. A robot that plans stands for that tick if it is to turn next."""
        tracker = self.tracker
        if tracker.heading is not None:
            if not tracker.faces(pose, ALIGNED):
                return tracker.drive(pose, scan)
            tracker.stop()
            self._plan(pose, scan)
        elif self._there(pose) or self._meets_obstacle(pose, scan):
            self.turns = 0
            self._plan(pose, scan)
        if tracker.heading is not None or self.status is not PlannerStatus.DRIVING:
            return STANDSTILL
        return tracker.drive(pose, scan)

    def _there(self, pose: Pose) -> bool:
        """At the virtual goal, or unable to come closer to it."""
        blocked = self.tracker.blocked_ns > GIVE_UP_S * 1e9
        return blocked or self.tracker.ended(pose, REACHED * self.inflation)

    def _meets_obstacle(self, pose: Pose, scan: Ranges) -> bool:
        """Whether a corner or a front has come up on the way (listing, 4 a 1); it ends the way there.

        Differs: not before the robot is a classification range on, because it has just turned from one.
        """
        section, begun = self.section, self.tracker.way[:1]
        if section.classify != "driving" or not self.limited or not len(begun):
            return False
        if math.dist((pose.x, pose.y), begun[0]) < section.classify_range:
            return False
        view = View(self.beams, pose, scan, GRAIN * self.inflation)
        if classify(view, section.classify_range) not in TURNS:
            return False
        self.virtual_goals[-1] = (pose.x, pose.y)
        return True

    def _to_goal(self, pose: Pose) -> float:
        return elementary.atan2(self.goal[1] - pose.y, self.goal[0] - pose.x)

    def _plan(self, pose: Pose, scan: Ranges) -> None:
        """One round of Algorithm 2 from where the robot stands, facing the fan's direction."""
        view = View(self.beams, pose, scan, GRAIN * self.inflation)
        obstacle = classify(view, self.section.classify_range) if self.limited else Obstacle.NONE
        if obstacle is Obstacle.NONE and not self.turns:
            ahead = self._to_goal(pose)
            if abs(wrap_angle(ahead - pose.heading)) > ALIGNED:
                self.tracker.face(ahead)
                return
        if obstacle in TURNS and self.turns < MOST_TURNS:
            self.turns += 1
            self.tracker.face(pose.heading + TURNS[obstacle])
            return
        beside = obstacle in (Obstacle.LEFT, Obstacle.RIGHT, Obstacle.BOTH)
        turned = beside or self.turns > 0
        direction, half = pose.heading, LIMITED_HALF if turned else math.pi / 2
        if beside:
            direction = fan_direction(view, obstacle, self.section.classify_range)
        draws = self.rng.random((self.section.samples, 2))
        samples = sample_fan(view, draws, direction, half, self.inflation)
        roadmap = RoadMap(view, samples, self.goal[None], self.inflation, self.inflation)
        self._advance(pose, roadmap, samples, direction if turned else None)
        self.passage = passage_width(view, self.tracker.way, PASSAGE_AHEAD * self.inflation)

    def _advance(
        self, pose: Pose, roadmap: RoadMap, samples: FloatArray, direction: float | None
    ) -> None:
        """Drive to the best kept point, or step back. direction: of a turned fan; None: to the goal."""
        costs = roadmap.costs()
        offset = roadmap.points - roadmap.points[0]
        good = np.flatnonzero(np.isfinite(costs) & self._unused(roadmap.points) & (roadmap.marks != 0))
        at_goal = np.flatnonzero((roadmap.marks == 0) & np.isfinite(costs))
        way = NO_POINTS
        if len(at_goal):
            way = roadmap.path(int(at_goal[0]))
        elif len(good):
            if direction is None:
                worth = -elementary.lengths(*(roadmap.points[good] - self.goal).T)
            else:
                ahead, left = elementary.cos(direction), elementary.sin(direction)
                worth = offset[good, 0] * ahead + offset[good, 1] * left
            way = roadmap.path(int(good[np.argmax(worth)]))
        if not len(way):
            self._step_back(pose, roadmap, samples)
            return
        self.virtual_goals.append((float(way[-1][0]), float(way[-1][1])))
        self.used = np.concatenate((self.used, way[-1:]))
        self.tracker.follow(way)
        self.snapshot = PlanningSnapshot(pose, samples, roadmap, way, backtrack=False)

    def _unused(self, points: FloatArray) -> BoolArray:
        """Which (n, 2) points may become a virtual goal: not the robot itself, and for `original` not
        where one was before.
        """
        taken = points[:1] if self.limited else self.used
        return np.asarray(squared_distances(points, taken).min(axis=1) > self.inflation * self.inflation)

    def _step_back(self, pose: Pose, roadmap: RoadMap, samples: FloatArray) -> None:
        """Back to the virtual goal before (listing, 2a); at the start there is nowhere left to go."""
        if self.limited and len(self.virtual_goals) == 1:
            self.tracker.face(pose.heading + math.pi / 2)
            return
        self.virtual_goals.pop()
        if not self.virtual_goals:
            self.status = PlannerStatus.NO_WAY
            self.notes.append(Note("no_way", {"virtual_goals": len(self.used)}))
            way = NO_POINTS
        else:
            way = np.array(((pose.x, pose.y), self.virtual_goals[-1]))
            self.tracker.follow(way)
        self.snapshot = PlanningSnapshot(pose, samples, roadmap, way, backtrack=True)
