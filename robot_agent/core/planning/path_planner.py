"""Follows a path that the scenario gives (`planner.kind = "path"`): the same way, mission after mission.

The thesis computes a leader's path once a map, saves it, and drives it again for each policy (4.2). A
leader starts beside the path, or is elected in the middle of it; so it joins the path where the way over
it is shortest, of all points that it sees and that a road map leads to. It joins anew, around whatever
stands there, when something bars it: a robot that was lost on the way. Where nothing of the path is in
sight it turns to it, and then finds its way by Algorithm 2 until something is.

Differs: a new leader of the thesis plans a new trajectory from where it stands (3.3.5); here it goes on
along the saved one, because otherwise policies would be compared on different ways.
"""

import math
from itertools import pairwise

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.messages import Note
from robot_agent.core.planning.distances import squared_distances
from robot_agent.core.planning.guidance import ARRIVED_WITHIN, Guidance, PlannerStatus
from robot_agent.core.planning.passage import PASSAGE_AHEAD, passage_width
from robot_agent.core.planning.path_tracking import ALIGNED, PathTracker, Point
from robot_agent.core.planning.perception import GRAIN
from robot_agent.core.planning.roadmap import Indices, RoadMap
from robot_agent.core.planning.sampling import sample_fan, spread_draws
from robot_agent.core.planning.snapshot import PlanningSnapshot
from robot_agent.core.planning.thesis_planner import ThesisPlanner
from robot_agent.core.planning.view import View

STEP_KEEPS = 0.96
"""What each step keeps from what is seen, in inflations: the path itself may keep just the inflation,
and cutting its corners takes 2 cm. A piece of the path with less room than that is barred."""

SPACING = 1.0
"""Distance between the points of the path at which it can be joined, in inflations: half a metre."""

LOOK_EVERY_S = 0.5
"""Time from one look at the way ahead, or for the path, to the next [s]."""

BAR_AHEAD = 8
"""Points of the path ahead that are watched for something that bars it: 4 m, room to get around it."""

GIVE_UP_S = 2.0
"""Time after which a leader that cannot go on joins the path anew [s]."""

WAYPOINT_AHEAD = 3.0
"""The way point in force lies this far ahead on the way [m]."""


class PathPlanner:
    """A pathfinder: see the module. One instance serves one leadership term."""

    def __init__(self, briefing: Briefing, pose: Pose, rng: np.random.Generator) -> None:
        section = briefing.planner
        self.briefing, self.rng = briefing, rng
        self.goal: Point = (briefing.goal.x, briefing.goal.y)
        self.arrived_within = ARRIVED_WITHIN * briefing.goal.tolerance
        self.beams = Beams(briefing.body)
        self.inflation, self.samples = section.inflation, section.samples
        self.clearance = STEP_KEEPS * self.inflation
        self.tracker = PathTracker(
            briefing.body, self.beams, briefing.period_ns, self.clearance, pose, turns_back=True
        )
        self.path, self.rest = _densified(np.array(section.path), SPACING * self.inflation)
        self.search: ThesisPlanner | None = None
        self.joined = False
        self.passed = -1  # the last piece of the path that was barred, and is left out
        self._was_barred = False
        self.remaining = math.dist((pose.x, pose.y), self.goal)
        self.passage = math.inf
        self.waypoint = (pose.x, pose.y)
        self.snapshot: PlanningSnapshot | None = None
        self._look_after_ns = round(LOOK_EVERY_S * 1e9)
        self._unlooked_ns = self._look_after_ns

    def step(self, pose: Pose, scan: Ranges) -> Guidance:
        """See Pathfinder."""
        if math.dist((pose.x, pose.y), self.goal) <= self.arrived_within:
            return self._guidance(STANDSTILL, PlannerStatus.ARRIVED, ())
        self._unlooked_ns += self.tracker.period_ns
        if self._unlooked_ns >= self._look_after_ns:
            self._unlooked_ns = 0
            self._look(pose, scan)
        if self.search is not None:
            return self._searched(self.search, pose, scan)
        drives = len(self.tracker.way) > 0 or self._turns(pose)
        twist = self.tracker.drive(pose, scan) if drives else STANDSTILL
        return self._guidance(twist, PlannerStatus.DRIVING, ())

    def _guidance(self, twist: Twist, status: PlannerStatus, notes: tuple[Note, ...]) -> Guidance:
        return Guidance(twist, status, self.remaining, self.passage, self.waypoint, notes)

    def _turns(self, pose: Pose) -> bool:
        """Whether it still turns to the path; once it faces it, and saw nothing of it, it searches."""
        if self.tracker.heading is None:
            nearest = self.path[int(squared_distances(self.path, _place(pose))[:, 0].argmin())]
            self.tracker.face(elementary.atan2(nearest[1] - pose.y, nearest[0] - pose.x))
        if not self.tracker.faces(pose, ALIGNED):
            return True
        self._begin_search(pose)
        return False

    def _begin_search(self, pose: Pose) -> None:
        self._unlooked_ns = self._look_after_ns
        self.tracker.stop()
        self.search = ThesisPlanner(self.briefing, pose, self.rng, limited=True)

    def _searched(self, search: ThesisPlanner, pose: Pose, scan: Ranges) -> Guidance:
        """What Algorithm 2 does while nothing of the path is in sight."""
        found = search.step(pose, scan)
        self.remaining, self.passage, self.waypoint = found.remaining, found.passage, found.waypoint
        return self._guidance(found.twist, found.status, found.notes)

    def _look(self, pose: Pose, scan: Ranges) -> None:
        """Join the path, or join it anew, where that is due; look for passages on the way ahead."""
        view = View(self.beams, pose, scan, GRAIN * self.inflation)
        away2 = squared_distances(self.path, view.origin[None])[:, 0]
        near = np.flatnonzero(away2 < self.beams.range * self.beams.range)
        barred = self._barred(view, near)
        if self.joined:
            self._watch_bars(pose, barred)
        if not self.joined:
            self._join(view, near, barred)
        if len(self.tracker.way):
            ahead = self.tracker.ahead(pose)
            legs = elementary.lengths(*np.diff(ahead, axis=0).T)
            self.remaining = float(legs.sum())
            self.waypoint = _along(ahead, legs, WAYPOINT_AHEAD)
            self.passage = passage_width(view, ahead, PASSAGE_AHEAD * self.inflation)

    def _watch_bars(self, pose: Pose, barred: Indices) -> None:
        """Join anew when it is blocked, or something has barred the next metres for two looks."""
        following = len(self.path) - len(self.tracker.ahead(pose)) + 1
        soon = barred[(barred >= following - 1) & (barred < following + BAR_AHEAD)]
        barred_twice, self._was_barred = self._was_barred and len(soon) > 0, len(soon) > 0
        if barred_twice or self.tracker.blocked_ns > GIVE_UP_S * 1e9:
            self.passed = int(soon.max(initial=self.passed))
            self.joined = False

    def _barred(self, view: View, near: Indices) -> Indices:
        """Of the pieces of the path from each of these points to the next those that something bars."""
        pieces = near[:-1][np.diff(near) == 1]
        clear = view.passable(self.path[pieces], self.path[pieces + 1], self.clearance)
        return np.asarray(pieces[~clear])

    def _join(self, view: View, near: Indices, barred: Indices) -> None:
        """Take the shortest way over the path to its end, behind what bars the path if that is in sight.

        near: points of the path in reach of the laser. barred: pieces of it that something bars.
        """
        draws = spread_draws(self.samples, self.rng)
        samples = sample_fan(view, draws, view.pose.heading, math.pi, self.inflation)
        roadmap = RoadMap(view, samples, self.path[near], self.inflation, self.inflation)
        costs = roadmap.costs()
        reached = np.flatnonzero((roadmap.marks >= 0) & np.isfinite(costs))
        place = near[roadmap.marks[reached]]
        behind = place > barred.max(initial=self.passed)
        before = (place > self.passed) & (place <= barred.min(initial=len(self.path)))
        at_path = reached[behind if behind.any() else before]
        if len(at_path):
            whole = costs[at_path] + self.rest[near[roadmap.marks[at_path]]]
            best = int(at_path[np.argmin(whole)])
            way = np.concatenate((roadmap.path(best), self.path[near[roadmap.marks[best]] + 1 :]))
            self.joined, self.search = True, None
            self.tracker.follow(way)
            self.snapshot = PlanningSnapshot(view.pose, samples, roadmap, way, backtrack=False)
        elif self.passed >= 0 and self.search is None:
            self._begin_search(view.pose)


def _place(pose: Pose) -> FloatArray:
    return np.array(((pose.x, pose.y),))


def _densified(path: FloatArray, spacing: float) -> tuple[FloatArray, FloatArray]:
    """A point of the path at least every `spacing` metres, (n, 2), and the rest from each, (n,) [m]."""
    pieces = [path[:1]]
    for start, end in pairwise(path):
        count = max(1, math.ceil(math.dist(start, end) / spacing))
        pieces.append(start + (end - start) * (np.arange(1, count + 1) / count)[:, None])
    points = np.concatenate(pieces)
    legs = elementary.lengths(*np.diff(points, axis=0).T)
    return points, np.concatenate((np.cumsum(legs[::-1])[::-1], (0.0,)))


def _along(way: FloatArray, legs: FloatArray, distance: float) -> Point:
    """The first point of a way, (n, 2), that is at least `distance` along it [m], or its end."""
    place = min(int(np.searchsorted(np.cumsum(legs), distance)) + 1, len(way) - 1)
    return float(way[place, 0]), float(way[place, 1])
