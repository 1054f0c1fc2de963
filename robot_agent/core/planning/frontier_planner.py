"""The default way-finding, `planner.kind = "escape"`: it leaves every trap that a point robot can leave.

It knows the current scan and a bounded memory. At every planning moment it draws a local road map in
what it sees (perception.py). It prefers frontier-based search (frontiers.py, frontier_choice.py), which
finds short ways. That search may spend a bounded distance without coming closer to the goal than ever
before (search_budget.py). Then DistBug (distbug.py) takes over from the place closest to the goal, until
the record is broken. Completeness rests on DistBug alone, whose proof holds from any start: every record
is better than the last by a fixed step, so there are finitely many of them, and between two lie a
bounded search and a boundary loop that ends with a better place or with "no way".
"""

import math
from enum import Enum

import numpy as np

from onehop.contracts.arrays import FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.messages import Note
from robot_agent.core.planning.distbug import DistBug
from robot_agent.core.planning.frontier_choice import (
    WALLS_GO_ON,
    RecentReach,
    Route,
    best_frontier,
    closest_place,
)
from robot_agent.core.planning.frontiers import Frontiers
from robot_agent.core.planning.guidance import ARRIVED_WITHIN, Guidance, PlannerStatus
from robot_agent.core.planning.memory import NOTHING
from robot_agent.core.planning.passage import PASSAGE_AHEAD, passage_width
from robot_agent.core.planning.path_tracking import PathTracker
from robot_agent.core.planning.perception import LocalMap, Perception
from robot_agent.core.planning.replanning import Replanning
from robot_agent.core.planning.route_following import RouteFollower
from robot_agent.core.planning.search_budget import SearchBudget
from robot_agent.core.planning.snapshot import PlanningSnapshot

MOST_STUCK = 3
"""Planning moments in a row without a move after which the robot makes room for itself first: so many
different samples gave no way that it could drive."""

RETURNED_WITHIN = 2.0
"""A robot this near to the place closest to the goal is back there, in inflations."""


class SearchPhase(Enum):
    """How the way is being sought."""

    SEARCH = "search by frontiers"
    RETURN = "return to the closest place"
    BOUNDARY = "DistBug"


class FrontierPlanner:
    """A pathfinder: see the module. One instance serves one leadership term."""

    def __init__(self, briefing: Briefing, pose: Pose, rng: np.random.Generator) -> None:
        section, body = briefing.planner, briefing.body
        beams = Beams(body)
        self.goal: FloatArray = np.array((briefing.goal.x, briefing.goal.y))
        self.goal_x, self.goal_y = briefing.goal.x, briefing.goal.y
        self.arrived_within = ARRIVED_WITHIN * briefing.goal.tolerance
        self.inflation = section.inflation
        self.laser_range = body.laser_range
        self.remaining = math.dist((pose.x, pose.y), self.goal)
        self.budget = SearchBudget(section, body.laser_range, self.remaining)
        self.perception = Perception(briefing, beams, rng)
        clearances = self.perception.clearances
        self.tracker = PathTracker(body, beams, briefing.period_ns, clearances.step, pose)
        self.replanning = Replanning(section.inflation, briefing.period_ns)
        self.frontiers = Frontiers(section.memory, self.goal, section.inflation)
        self.recent_reach = RecentReach()
        self.follower = RouteFollower(self.frontiers, self.tracker, section.inflation)
        self.phase = SearchPhase.SEARCH
        self.distbug = DistBug(self.goal, clearances.way)
        self.passage = math.inf
        self.notes: list[Note] = []
        self.status = PlannerStatus.DRIVING
        self.snapshot: PlanningSnapshot | None = None

    def step(self, pose: Pose, scan: Ranges) -> Guidance:
        """See Pathfinder."""
        if math.hypot(pose.x - self.goal_x, pose.y - self.goal_y) <= self.arrived_within:
            self.status = PlannerStatus.ARRIVED
        twist = STANDSTILL
        if self.status is PlannerStatus.DRIVING:
            twist = self._drive(pose, scan)
        notes, self.notes = tuple(self.notes), []
        return Guidance(twist, self.status, self.remaining, self.passage, self.tracker.waypoint, notes)

    def _drive(self, pose: Pose, scan: Ranges) -> Twist:
        if self.replanning.due(pose, self.tracker):
            self._plan(pose, scan)
        return self.tracker.drive(pose, scan) if self.status is PlannerStatus.DRIVING else STANDSTILL

    def _plan(self, pose: Pose, scan: Ranges) -> None:
        """One planning moment: look, remember, choose."""
        self._account(pose)
        local = self.perception.look(pose, scan, self.frontiers.memory)
        self.frontiers.note_place(pose, local.lengths(), self.laser_range)
        settled = self.frontiers.update(local, self.budget.record)
        local = local._replace(reach=local.reach | settled)
        backtrack = False
        if self.replanning.stuck >= MOST_STUCK:
            self.tracker.follow(local.way_to_room(self.inflation))
        else:
            backtrack = self._choose(local)
        way = self.tracker.way
        self.passage = passage_width(local.view, way, PASSAGE_AHEAD * self.inflation)
        self.snapshot = PlanningSnapshot(pose, local.samples, local.roadmap, way, backtrack)

    def _account(self, pose: Pose) -> None:
        """Spend what was driven; a broken record makes it a search by frontiers again."""
        first = self.replanning.last is None
        moved = self.replanning.begin(pose, self.tracker)
        if not first:
            self.budget.spend(moved)
        if self.budget.compare(math.dist((pose.x, pose.y), self.goal)):
            self._enter(SearchPhase.SEARCH)

    def _enter(self, phase: SearchPhase) -> None:
        """Each phase begins with a new run of DistBug: the old one's boundary is somewhere else."""
        if phase is not self.phase:
            self.phase = phase
            self.notes.append(Note("phase", {"phase": phase.value, "record": self.budget.record}))
            self.distbug = DistBug(self.goal, self.distbug.radius)

    def _choose(self, local: LocalMap) -> bool:
        """Decide where to go now; says whether that leads back over a place where the robot was."""
        if local.goal is not None:
            self.follower.aim(NOTHING)
            self.remaining = float(local.costs[local.goal])
            self.tracker.follow(local.roadmap.path(local.goal))
            return False
        if self.budget.hopeless:
            self._end(proven=False)
            return False
        if self.phase is SearchPhase.SEARCH and self.budget.exhausted:
            self._enter(SearchPhase.RETURN)
        if self.phase is not SearchPhase.BOUNDARY:
            route = self._route(local)
            if route is not None:
                self._report_target(route)
                forget = self.phase is SearchPhase.SEARCH
                return self.follower.follow(local, route.chain(), forget)
            self._enter(SearchPhase.BOUNDARY)
        self._follow_boundary(local)
        return False

    def _route(self, local: LocalMap) -> Route | None:
        """Over way points to the best frontier, or back to the closest place; None: it is time for
        DistBug, for the robot is at that place or cannot get there.
        """
        pose, frontiers = local.view.pose, self.frontiers
        seeds = self.recent_reach.complete(frontiers, pose, local.lengths())
        place = frontiers.memory.xy[frontiers.place]
        seeds.setdefault(frontiers.place, math.dist((pose.x, pose.y), place))
        if self.phase is SearchPhase.SEARCH:
            wall = WALLS_GO_ON * self.laser_range
            route = best_frontier(frontiers, seeds, self.follower.target, wall)
            if route.target != NOTHING:
                return route
        self._enter(SearchPhase.RETURN)
        route = closest_place(frontiers, seeds)
        rest = math.dist((pose.x, pose.y), frontiers.memory.xy[route.target])
        if rest < RETURNED_WITHIN * self.inflation or self.follower.stuck:
            self.follower.ended()
            return None
        return route

    def _report_target(self, route: Route) -> None:
        """Note a new target, and how far it is to the goal by way of it."""
        x, y = self.frontiers.memory.xy[route.target].tolist()
        if self.follower.aim(route.target):
            self.notes.append(Note("target", {"x": x, "y": y}))
        self.remaining = route.cost + math.dist((x, y), self.goal)

    def _follow_boundary(self, local: LocalMap) -> None:
        """What DistBug says."""
        move = self.distbug.move(local.view, local.roadmap, local.costs)
        if move.way is not None:
            self.remaining = math.dist(local.view.origin, self.goal)
            self.tracker.follow(move.way)
        elif move.heading is not None:
            self.tracker.face(move.heading)
        else:
            self._end(proven=True)

    def _end(self, proven: bool) -> None:
        """There is no way to the goal, or none was found for very long."""
        self.status = PlannerStatus.NO_WAY
        self.notes.append(Note("no_way", {"record": self.budget.record, "proven": proven}))
