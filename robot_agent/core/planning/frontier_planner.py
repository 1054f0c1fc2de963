"""The default way-finding: leaves every trap that a point robot can leave; current scan, bounded memory.

At every planning moment the robot draws a local road map in what it sees. It prefers to search by
frontiers (frontiers.py), which finds short ways. That search may spend a bounded distance without coming
closer to the goal than ever before; a planning moment spends some even if the robot stands. Then DistBug
(distbug.py) takes over from the place closest to the goal, until the record is broken. Completeness
rests on DistBug alone, whose proof holds from any start: every record is better than the last by a fixed
step, so there are finitely many of them, and between two lie a bounded search and a boundary loop that
ends with a better place or with "no way".
"""

import math
from enum import Enum
from typing import NamedTuple

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, wrap_angle
from onehop.contracts.messages import Note
from robot_agent.core.planning.distbug import DistBug
from robot_agent.core.planning.frontiers import Frontiers
from robot_agent.core.planning.guidance import Guidance, PlannerStatus
from robot_agent.core.planning.memory import FRONTIER, NOTHING, PLACE
from robot_agent.core.planning.passage import passage_width
from robot_agent.core.planning.path_tracking import PathTracker, Point
from robot_agent.core.planning.roadmap import RoadMap
from robot_agent.core.planning.sampling import (
    corner_samples,
    edge_samples,
    goal_sample,
    sample_fan,
    spread_draws,
)
from robot_agent.core.planning.snapshot import PlanningSnapshot
from robot_agent.core.planning.view import NO_POINTS, RecentObstacles, View

EIGHTHS: FloatArray = np.arange(8) * math.pi / 4

GOAL = -2
"""Stands for the goal where the number of a way point could stand."""

GOAL_PLACES: FloatArray = np.concatenate(
    [
        np.zeros((1, 2)),
        *(
            share * np.column_stack((elementary.cosines(EIGHTHS), elementary.sines(EIGHTHS)))
            for share in (0.5, 1.0)
        ),
    ]
)
"""Places around a goal, the goal first, in units of the greatest distance from it."""

WALLS_GO_ON = 0.5
"""Way that a frontier with a wall between it and the goal is taken to cost more, in laser ranges: a wall
that leaves the view is likelier to go on than to end right there."""

PATIENCE_S = 8.0
"""Time after which the robot looks and plans anew whatever it does [s]."""

LONGEST = 2000.0
"""Way without coming closer after which it gives up without proof, in laser ranges. It is there so that
an answer comes even if rounding keeps a boundary from closing; no way of the campaigns was that long."""

ASIDE = 1.2
"""Bearing from which a way point may lie out of view, so that the robot turns to it first [rad]."""

MOST_BLOCKED = 3
"""Planning moments without a move after which the robot makes room for itself first."""

Reach = dict[int, tuple[int, float]]
"""Way point (or GOAL) -> point of the road map, and its cost [m]."""


class Glimpse(NamedTuple):
    """A way point that was in reach: where it was, what it cost [m], and from where."""

    place: Point
    cost: float
    seen_from: Point


class SearchPhase(Enum):
    """How the way is being sought."""

    SEARCH = "search by frontiers"
    RETURN = "return to the closest place"
    CIRCLE = "DistBug"


class FrontierPlanner:
    """A pathfinder: see the module. One instance serves one leadership."""

    def __init__(self, briefing: Briefing, pose: Pose, rng: np.random.Generator) -> None:
        self.body, self.section, self.rng = briefing.body, briefing.planner, rng
        self.goal: FloatArray = np.array((briefing.goal.x, briefing.goal.y))
        self.goal_x, self.goal_y = briefing.goal.x, briefing.goal.y
        self.tolerance = briefing.goal.tolerance
        self.fan = Beams(briefing.body)
        self.inflation = self.section.inflation
        self.clearance, self.comfort = 1.04 * self.inflation, 1.4 * self.inflation
        self.driver = PathTracker(self.body, self.fan, briefing.period_ns * 1e-9, 1.01 * self.inflation)
        self.frontiers = Frontiers(
            self.section.memory, self.goal, self.inflation, WALLS_GO_ON * self.body.laser_range
        )
        self.recent = RecentObstacles(6.0 * self.inflation)
        self.phase = SearchPhase.SEARCH
        self.distbug = DistBug(self.goal, self.clearance)
        self.budget = self.section.patience * self.body.laser_range
        self.spent = 0.0
        self.patience = PATIENCE_S * 1e9 / briefing.period_ns
        self.waited = 0
        self.target, self.tries, self.blocked = NOTHING, 0, 0
        self.lately: dict[int, Glimpse] = {}
        self.turn: float | None = None
        self.planned: Pose | None = None
        self.remaining = self.record = math.dist((pose.x, pose.y), self.goal)
        self.mark = self.record
        self.passage = math.inf
        self.waypoint = (pose.x, pose.y)
        self.notes: list[Note] = []
        self.progress = PlannerStatus.DRIVING
        self.survey: PlanningSnapshot | None = None

    def step(self, pose: Pose, scan: Ranges) -> Guidance:
        """See Pathfinder."""
        if math.hypot(pose.x - self.goal_x, pose.y - self.goal_y) <= 0.6 * self.tolerance:
            self.progress = PlannerStatus.ARRIVED
        self.waited += 1
        if self.progress is PlannerStatus.DRIVING and self._due(pose):
            self._plan(pose, scan)
        twist = self._twist(pose, scan) if self.progress is PlannerStatus.DRIVING else STANDSTILL
        notes, self.notes = tuple(self.notes), []
        return Guidance(twist, self.progress, self.remaining, self.passage, self.waypoint, notes)

    def _due(self, pose: Pose) -> bool:
        """Is it time to look and plan anew: a piece driven or turned, the way at its end, or blocked, or
        none of it for long, which happens when the team makes the leader wait."""
        last = self.planned
        if last is None or self.driver.shielded > 3 or self.waited > self.patience:
            return True
        if self.turn is not None and abs(wrap_angle(self.turn - pose.heading)) < 0.1:
            return True
        moved = math.dist((pose.x, pose.y), (last.x, last.y))
        turned = abs(wrap_angle(pose.heading - last.heading))
        if moved >= 3.0 * self.inflation or turned > math.pi / 4:
            return True
        return self.turn is None and math.dist((pose.x, pose.y), self.driver.way[-1]) < 0.1

    def _twist(self, pose: Pose, scan: Ranges) -> Twist:
        if self.turn is not None:
            return self.driver.turn_to(pose, self.turn)
        return self.driver.drive(pose, scan)

    def _plan(self, pose: Pose, scan: Ranges) -> None:
        """One planning moment: look, remember, choose."""
        self._account(pose)
        beside = self.recent.beside(pose, float(self.fan.angles[-1]))
        view = View(self.fan, pose, scan, 0.1 * self.inflation, beside)
        self.recent.keep(view)
        draws = spread_draws(self.section.samples, self.rng)
        samples = sample_fan(view, draws, pose.heading, math.pi, self.clearance)
        corners = corner_samples(view, 2.0 * self.inflation, 1.1 * self.comfort)
        ahead = goal_sample(view, self.goal, 1.1 * self.clearance)
        edges = edge_samples(view, 1.1 * self.clearance)
        samples = np.concatenate((samples, edges, corners, ahead))
        known = self.frontiers.in_view(view)
        extras = np.concatenate((self._free_goal(view), self.frontiers.memory.xy[known]))
        roadmap = RoadMap(view, samples, extras, self.clearance, self.comfort)
        costs = roadmap.costs()
        reach = _reach(roadmap, costs, known)
        lengths = {n: cost for n, (_, cost) in reach.items() if n != GOAL}
        self.frontiers.note_place(pose, lengths, self.body.laser_range)
        noted = self.frontiers.note(view, roadmap, costs, known, self.record)
        reach |= {number: (point, float(costs[point])) for number, point in noted.items()}
        backtrack = False
        if self.blocked >= MOST_BLOCKED:
            self._make_room(view)
        else:
            backtrack = self._choose(view, roadmap, costs, reach)
        way = np.array(self.driver.way) if self.turn is None else NO_POINTS
        self.passage = passage_width(view, way, 8.0 * self.inflation)
        self.survey = PlanningSnapshot(pose, samples, roadmap, way, backtrack)

    def _free_goal(self, view: View) -> FloatArray:
        """The goal, or a free place in its tolerance where the goal itself is not free, (1, 2) [m]."""
        if math.dist(view.origin, self.goal) > self.fan.range:
            return self.goal[None]
        places = self.goal + 0.5 * self.tolerance * GOAL_PLACES
        good = np.flatnonzero(view.visible(places) & view.free(places, self.clearance)[0])
        return places[good[0], None] if len(good) else self.goal[None]

    def _account(self, pose: Pose) -> None:
        """Keep the record; a new one gives the search its whole budget back."""
        moved = math.inf
        if self.planned is not None:
            moved = math.dist((pose.x, pose.y), (self.planned.x, self.planned.y))
            self.spent += max(moved, 0.5 * self.inflation)
        still = self.driver.shielded > 0 and moved < 0.2 * self.inflation
        self.blocked = self.blocked + 1 if still else 0
        self.planned, self.waited = pose, 0
        self.driver.shielded = 0
        self.record = min(self.record, math.dist((pose.x, pose.y), self.goal))
        if self.record < self.mark - self.inflation:
            self.mark, self.spent = self.record, 0.0
            self._enter(SearchPhase.SEARCH)

    def _enter(self, phase: SearchPhase) -> None:
        if phase is not self.phase:
            self.phase = phase
            self.notes.append(Note("phase", {"phase": phase.value, "record": self.record}))
            self.distbug = DistBug(self.goal, self.clearance)

    def _choose(self, view: View, roadmap: RoadMap, costs: FloatArray, reach: Reach) -> bool:
        """Decide where to go now; says whether that leads back over a place where the robot was."""
        if GOAL in reach:
            self.target = GOAL
            self._take(roadmap.path(reach[GOAL][0]), reach[GOAL][1])
            return False
        if self.spent > LONGEST * self.body.laser_range:
            self._end(proven=False)
            return False
        if self.phase is SearchPhase.SEARCH and self.spent > self.budget:
            self._enter(SearchPhase.RETURN)
        if self.phase is not SearchPhase.CIRCLE:
            chain = self._route(view.pose, reach)
            if chain:
                return self._go(view.pose, roadmap, chain, reach)
            self._enter(SearchPhase.CIRCLE)
        self._circle(view, roadmap, costs)
        return False

    def _route(self, pose: Pose, reach: Reach) -> list[int]:
        """Way points to the target, the target first; none when it is time for DistBug."""
        frontiers, memory = self.frontiers, self.frontiers.memory
        seeds = {n: cost for n, (_, cost) in sorted(reach.items())}
        seeds |= self._lately_in_reach(pose, seeds)
        seeds.setdefault(frontiers.place, math.dist((pose.x, pose.y), memory.xy[frontiers.place]))
        route = frontiers.best(seeds, self.target) if self.phase is SearchPhase.SEARCH else None
        if route is None or route.target == NOTHING:
            self._enter(SearchPhase.RETURN)
            route = frontiers.closest_place(seeds)
            near = math.dist((pose.x, pose.y), memory.xy[route.target]) < 2.0 * self.inflation
            if near or self.tries > 6:
                self.tries = 0
                return []
        best = route.target
        if best != self.target:
            self.target, self.tries = best, 0
            x, y = memory.xy[best].tolist()
            self.notes.append(Note("target", {"x": x, "y": y}))
        self.remaining = route.cost + math.dist(memory.xy[best], self.goal)
        return route.chain()

    def _lately_in_reach(self, pose: Pose, seeds: dict[int, float]) -> dict[int, float]:
        """Way points that were in reach a moment ago and are now behind the robot, and what they cost.

        Without them one would seem to be farther off than before because the robot turned its back to
        it, and it would turn back, and so on.
        """
        memory, here, found = self.frontiers.memory, (pose.x, pose.y), {}
        for number, ((x, y), cost, seen_from) in self.lately.items():
            moved = math.dist(seen_from, here)
            same = memory.kind[number] & (PLACE + FRONTIER) and (x, y) == tuple(memory.xy[number])
            bearing = wrap_angle(elementary.atan2(y - pose.y, x - pose.x) - pose.heading)
            if number not in seeds and same and moved < self.frontiers.spacing and abs(bearing) > ASIDE:
                found[number] = cost + moved
        now = {n: Glimpse(tuple(memory.xy[n].tolist()), cost, here) for n, cost in seeds.items()}
        self.lately = {n: self.lately[n] for n in found} | now
        return found

    def _go(self, pose: Pose, roadmap: RoadMap, chain: list[int], reach: Reach) -> bool:
        """Take the way to the furthest way point of the chain (target first) that is in reach."""
        here, xy = (pose.x, pose.y), self.frontiers.memory.xy
        for number in chain:
            if number in reach and math.dist(here, xy[number]) > 0.5 * self.inflation:
                self._take(roadmap.path(reach[number][0]), self.remaining)
                return len(chain) > 1
        ahead = [n for n in chain if math.dist(here, xy[n]) > 0.9 * self.inflation]
        if not ahead:
            self._face(float(self.frontiers.gaze[chain[0]]))
            return True
        x, y = xy[ahead[-1]].tolist()
        bearing = elementary.atan2(y - pose.y, x - pose.x)
        if abs(wrap_angle(bearing - pose.heading)) > ASIDE:
            self._face(bearing)
            return True
        self.tries += 1
        if self.tries > 6:
            self._give_up(ahead)
        self._take(np.array((here, (x, y))), self.remaining)
        return True

    def _give_up(self, ahead: list[int]) -> None:
        """The next piece of the route cannot be driven: forget it."""
        if self.phase is SearchPhase.RETURN:
            return
        self.tries = 0
        if len(ahead) == 1:
            self.frontiers.memory.close(ahead[0])
        else:
            self.frontiers.memory.part(ahead[-1], ahead[-2])

    def _make_room(self, view: View) -> None:
        """Drive where there is most room: from here, what was planned cannot be driven."""
        bearing = EIGHTHS + view.pose.heading
        step = np.column_stack((elementary.cosines(bearing), elementary.sines(bearing)))
        ends = view.origin + self.inflation * step
        room = view.free(ends, self.clearance)[1]
        clear = view.passable(np.broadcast_to(view.origin, ends.shape), ends, self.clearance)
        best = ends[int(np.argmax(np.where(clear, room, -1.0)))]
        self._take(np.array((view.origin, best)), self.remaining)

    def _circle(self, view: View, roadmap: RoadMap, costs: FloatArray) -> None:
        way = self.distbug.way(view, roadmap, costs)
        if self.distbug.enclosed:
            self._end(proven=True)
        elif way is None:
            self._face(self.distbug.turn or 0.0)
        else:
            self._take(way, math.dist(view.origin, self.goal))

    def _end(self, proven: bool) -> None:
        """There is no way to the goal, or none was found for very long."""
        self.progress = PlannerStatus.NO_WAY
        self.notes.append(Note("no_way", {"record": self.record, "proven": proven}))

    def _face(self, heading: float) -> None:
        """Turn in place to a heading."""
        if self.turn is None:
            self.driver.turning = 0
        self.turn = wrap_angle(heading)

    def _take(self, way: FloatArray | None, remaining: float) -> None:
        """Drive a way; without one, the last stays in force."""
        if way is None:
            return
        self.turn = None
        self.remaining = remaining
        self.driver.follow(way)
        self.waypoint = (float(way[-1][0]), float(way[-1][1]))


def _reach(roadmap: RoadMap, costs: FloatArray, known: list[int]) -> Reach:
    """Which of the extra points (the goal, then `known`) the road map reaches."""
    reach: Reach = {}
    for point in np.flatnonzero((roadmap.marks >= 0) & np.isfinite(costs)).tolist():
        mark = int(roadmap.marks[point])
        reach[GOAL if mark == 0 else known[mark - 1]] = (point, float(costs[point]))
    return reach
