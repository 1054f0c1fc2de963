"""The default way-finding: leaves every trap, with the current scan and a bounded memory.

At every planning moment the robot draws a local road map in what it sees, notes where the seen free
space borders on the unseen (openings), and drives to the opening with the least g + h: length of the
known way there, plus straight distance to the goal as if the unseen were free. That is planning with
the freespace assumption (Koenig, Tovey and Smirnov, "Performance bounds for planning in unknown
terrain", AIJ 147, 2003): every opening is reached or refuted once, so it ends at the goal or with none
left. No obstacle is remembered beyond a few metres, only way points.
"""

import math

import numpy as np

from onehop.contracts.geometry import STANDSTILL, Pose, Twist, wrap_angle
from onehop.contracts.messages import Note, Ranges
from onehop.contracts.scenario import Briefing
from robot_agent.core.planning.driving import Driver
from robot_agent.core.planning.guidance import Guidance, Progress
from robot_agent.core.planning.memory import CLOSED, OPENING, PLACE, WayPoints
from robot_agent.core.planning.passage import passage_width
from robot_agent.core.planning.roadmap import RoadMap, sample_fan
from robot_agent.core.planning.survey import Survey
from robot_agent.core.planning.view import NO_POINTS, Afterimage, BoolArray, View, squared_distances
from robot_agent.core.scan import Fan, FloatArray

GOAL = -2
NOTHING = -1


class Escape:
    """A pathfinder: see the module. One instance serves one leadership."""

    def __init__(self, briefing: Briefing, pose: Pose, rng: np.random.Generator) -> None:
        self.body, self.section, self.rng = briefing.body, briefing.planner, rng
        self.goal = np.array((briefing.goal.x, briefing.goal.y))
        self.tolerance = briefing.goal.tolerance
        self.fan = Fan(briefing.body)
        inflation = self.section.inflation
        self.clearance = inflation + 0.04 * inflation
        self.comfort = 1.4 * inflation
        self.driver = Driver(self.body, self.fan, briefing.period_ns * 1e-9, inflation)
        self.memory = WayPoints(self.section.memory)
        self.gaze = np.zeros(self.section.memory)
        self.afterimage = Afterimage(6.0 * inflation)
        self.spacing = 4.0 * inflation
        self.rim = 3.0 * inflation
        self.place = NOTHING
        self.target = NOTHING
        self.turn: tuple[float, float] | None = None
        self.tries = 0
        self.planned: Pose | None = None
        self.remaining = math.dist((pose.x, pose.y), self.goal)
        self.record = self.remaining
        self.passage = math.inf
        self.waypoint = (pose.x, pose.y)
        self.notes: list[Note] = []
        self.done: Progress = Progress.DRIVING
        self.survey: Survey | None = None

    def step(self, pose: Pose, scan: Ranges, moving: frozenset[int]) -> Guidance:
        """See Pathfinder."""
        if math.dist((pose.x, pose.y), self.goal) <= 0.6 * self.tolerance:
            self.done = Progress.ARRIVED
        if self.done is Progress.DRIVING and self._due(pose):
            self._plan(pose, scan, moving)
        twist = STANDSTILL
        if self.done is Progress.DRIVING:
            twist = self._twist(pose, scan)
        notes, self.notes = tuple(self.notes), []
        return Guidance(twist, self.done, self.remaining, self.passage, self.waypoint, notes)

    def _due(self, pose: Pose) -> bool:
        """Is it time to look and plan anew: a piece driven or turned, the way at its end, or blocked."""
        last = self.planned
        if last is None or self.driver.shielded > 3:
            return True
        if self.turn is not None:
            ahead = math.atan2(self.turn[1] - pose.y, self.turn[0] - pose.x)
            if abs(wrap_angle(ahead - pose.heading)) < 0.2:
                return True
        moved = math.dist((pose.x, pose.y), (last.x, last.y))
        turned = abs(wrap_angle(pose.heading - last.heading))
        if moved >= 3.0 * self.section.inflation or turned > math.pi / 4:
            return True
        return self.turn is None and math.dist((pose.x, pose.y), self.driver.way[-1]) < 0.1

    def _twist(self, pose: Pose, scan: Ranges) -> Twist:
        if self.turn is not None:
            return self.driver.turn_to(pose, *self.turn)
        return self.driver.drive(pose, scan)

    def _plan(self, pose: Pose, scan: Ranges, moving: frozenset[int]) -> None:
        self.planned = pose
        self.record = min(self.record, math.dist((pose.x, pose.y), self.goal))
        self.driver.shielded = 0
        half_view = float(self.fan.angles[-1])
        beside = self.afterimage.beside(pose, half_view)
        view = View(self.fan, pose, scan, moving, 0.1 * self.section.inflation, beside)
        self.afterimage.keep(view)
        samples = sample_fan(view, self.rng.random((self.section.samples, 2)), pose.heading, math.pi)
        known = self._way_points_in_view(view)
        extras = np.concatenate((self.goal[None], self.memory.xy[known]))
        roadmap = RoadMap(view, samples, extras, self.clearance, self.comfort)
        costs = roadmap.costs()
        reach = self._reach(roadmap, costs, known)
        self._note_place(pose, reach)
        self._note_openings(view, roadmap, costs, known)
        self.passage = passage_width(view, 8.0 * self.section.inflation)
        backtrack = self._choose(pose, roadmap, reach)
        way = np.array(self.driver.way) if self.turn is None else NO_POINTS
        self.survey = Survey(pose, samples, roadmap.points, roadmap.edges, way, backtrack)

    def _way_points_in_view(self, view: View) -> list[int]:
        numbers = self.memory.of_kind(PLACE, OPENING)
        shown = numbers[view.visible(self.memory.xy[numbers])]
        return [int(n) for n in shown]

    def _reach(
        self, roadmap: RoadMap, costs: FloatArray, known: list[int]
    ) -> dict[int, tuple[int, float]]:
        """Way points that the road map reaches: way point -> (road map point, cost); GOAL among them."""
        reach: dict[int, tuple[int, float]] = {}
        for point in np.flatnonzero((roadmap.marks >= 0) & np.isfinite(costs)).tolist():
            mark = int(roadmap.marks[point])
            reach[GOAL if mark == 0 else known[mark - 1]] = (point, float(costs[point]))
        return reach

    def _note_place(self, pose: Pose, reach: dict[int, tuple[int, float]]) -> None:
        """Where the robot is becomes a place if none is near; edges lead to all that it can see."""
        memory = self.memory
        nearest, distance = memory.nearest(pose.x, pose.y, PLACE)
        before = self.place
        if nearest == NOTHING or (distance > 1.2 * self.spacing and memory.has_room):
            self.place = memory.add(pose.x, pose.y, PLACE)
            if before == NOTHING:
                self._note_rear(pose)
        elif distance < 1.8 * self.section.inflation or before == NOTHING:
            self.place = nearest
        if before not in (NOTHING, self.place):
            memory.join(before, self.place, math.dist(memory.xy[before], memory.xy[self.place]))
        offset = math.dist((pose.x, pose.y), memory.xy[self.place])
        for number, (_, cost) in sorted(reach.items()):
            if number != GOAL:
                memory.join(self.place, number, cost + offset)

    def _note_rear(self, pose: Pose) -> None:
        """What lies behind the first pose is unseen: an opening, as far away as the laser reaches."""
        rear = self.memory.add(pose.x, pose.y, OPENING)
        self.gaze[rear] = wrap_angle(pose.heading + math.pi)
        self.memory.join(self.place, rear, self.body.laser_range)

    def _note_openings(self, view: View, roadmap: RoadMap, costs: FloatArray, known: list[int]) -> None:
        rim, outward = _unseen_rim(view, 2.0 * self.section.inflation)
        self._refute(view, rim, known)
        near_rim = squared_distances(roadmap.points, rim)
        candidates = np.flatnonzero(
            np.isfinite(costs) & (near_rim.min(axis=1, initial=np.inf) < self.rim**2)
        )
        candidates = candidates[candidates > 0]
        candidates = candidates[self._apart(roadmap.points[candidates])]
        value = costs[candidates] + np.hypot(*(roadmap.points[candidates] - self.goal).T)
        offset = math.dist(view.origin, self.memory.xy[self.place])
        fresh: list[int] = []
        for point in candidates[np.argsort(value, kind="stable")].tolist():
            here = roadmap.points[point]
            if not self.memory.has_room:
                break
            if all(math.dist(here, roadmap.points[p]) >= self.spacing for p in fresh):
                fresh.append(point)
                number = self.memory.add(float(here[0]), float(here[1]), OPENING)
                self.gaze[number] = outward[int(np.argmin(near_rim[point]))]
                self.memory.join(self.place, number, float(costs[point]) + offset)

    def _apart(self, points: FloatArray) -> BoolArray:
        """Which (n, 2) points are worth a new opening: far enough from openings, and either closer to the
        goal than the robot ever was, or far enough from places and closed openings.
        """
        nearest = {
            kind: squared_distances(points, self.memory.xy[self.memory.of_kind(kind)]).min(
                axis=1, initial=np.inf
            )
            for kind in (PLACE, OPENING, CLOSED)
        }
        progress = np.hypot(*(points - self.goal).T) < self.record - self.section.inflation
        new = (nearest[PLACE] >= self.spacing**2) & (nearest[CLOSED] >= 0.25 * self.spacing**2)
        return (nearest[OPENING] >= self.spacing**2) & (new | progress)

    def _refute(self, view: View, rim: FloatArray, known: list[int]) -> None:
        """Openings in full view that have nothing unseen around them any more are closed."""
        openings = np.array([n for n in known if self.memory.kind[n] == OPENING], dtype=np.intp)
        if not len(openings):
            return
        points = self.memory.xy[openings]
        beside_unseen = squared_distances(points, rim).min(axis=1, initial=np.inf) < self.rim**2
        still = beside_unseen & view.free(points, self.clearance)[0]
        at_rear = np.abs(wrap_angles(self.gaze[openings] - view.pose.heading)) > 1.2
        at_rear &= np.hypot(*(points - view.origin).T) < 1.5 * self.spacing
        for number in openings[~still & ~at_rear].tolist():
            self.memory.close(number)

    def _choose(self, pose: Pose, roadmap: RoadMap, reach: dict[int, tuple[int, float]]) -> bool:
        """The opening with the least g + h becomes the target, and the way towards it is taken.

        Says whether that leads back: over a place where the robot was before.
        """
        if GOAL in reach:
            self.target = GOAL
            self._take(roadmap, *reach[GOAL])
            return False
        self._arrive(pose)
        seeds = {n: cost for n, (_, cost) in sorted(reach.items())}
        to_place = math.dist((pose.x, pose.y), self.memory.xy[self.place])
        seeds.setdefault(self.place, to_place)
        cost, origin = self.memory.routes(seeds)
        best = self._best(cost)
        if best == NOTHING:
            self.done = Progress.NO_WAY
            self.notes.append(Note("no_way", {"way_points": self.memory.count}))
            return False
        if best != self.target:
            self.target, self.tries = best, 0
            self.notes.append(
                Note(
                    "target", {"x": float(self.memory.xy[best][0]), "y": float(self.memory.xy[best][1])}
                )
            )
        self.remaining = cost[best] + math.dist(self.memory.xy[best], self.goal)
        chain = [best]
        while origin[chain[-1]] != -1:
            chain.append(origin[chain[-1]])
        self._go(pose, roadmap, chain, reach)
        return len(chain) > 1

    def _best(self, cost: dict[int, float]) -> int:
        memory = self.memory
        openings = [int(n) for n in memory.of_kind(OPENING) if int(n) in cost]
        if not openings:
            return NOTHING
        value = {n: cost[n] + math.dist(memory.xy[n], self.goal) for n in openings}
        best = min(openings, key=lambda n: (value[n], n))
        kept = value.get(self.target, math.inf)
        return self.target if kept <= value[best] + self.spacing else best

    def _arrive(self, pose: Pose) -> None:
        """An opening that the robot stands in, with its unseen side in view, is done with."""
        memory = self.memory
        for number in memory.of_kind(OPENING).tolist():
            near = math.dist((pose.x, pose.y), memory.xy[number]) < 1.0 * self.section.inflation
            if near and abs(wrap_angle(float(self.gaze[number]) - pose.heading)) < 1.0:
                memory.close(number)

    def _go(
        self, pose: Pose, roadmap: RoadMap, chain: list[int], reach: dict[int, tuple[int, float]]
    ) -> None:
        """Take the way to the furthest way point of the chain (target first) that the road map reaches."""
        here = (pose.x, pose.y)
        for number in chain:
            if (
                number in reach
                and math.dist(here, self.memory.xy[number]) > 0.5 * self.section.inflation
            ):
                self._take(roadmap, reach[number][0], self.remaining)
                return
        ahead = [n for n in chain if math.dist(here, self.memory.xy[n]) > 0.9 * self.section.inflation]
        if not ahead:
            gaze = float(self.gaze[chain[0]])
            self._turn_towards((pose.x + math.cos(gaze), pose.y + math.sin(gaze)))
            return
        x, y = self.memory.xy[ahead[-1]].tolist()
        if abs(wrap_angle(math.atan2(y - pose.y, x - pose.x) - pose.heading)) > 1.2:
            self._turn_towards((x, y))
            return
        self.tries += 1
        if self.tries > 6:
            self._give_up(ahead)
        self.turn = None
        self.driver.follow(np.array((here, (x, y))))
        self.waypoint = (x, y)

    def _give_up(self, ahead: list[int]) -> None:
        """The next piece of the route cannot be driven: forget it."""
        self.tries = 0
        if len(ahead) == 1:
            self.memory.close(ahead[0])
        else:
            self.memory.part(ahead[-1], ahead[-2])

    def _turn_towards(self, point: tuple[float, float]) -> None:
        if self.turn is None:
            self.driver.turning = 0
        self.turn = point

    def _take(self, roadmap: RoadMap, point: int, remaining: float) -> None:
        way = roadmap.path(point)
        if way is None:
            return
        self.turn = None
        self.remaining = remaining
        self.driver.follow(way)
        self.waypoint = (float(way[-1][0]), float(way[-1][1]))


def wrap_angles(angles: FloatArray) -> FloatArray:
    """The same directions in [-pi, pi)."""
    return np.asarray((angles + math.pi) % (2.0 * math.pi) - math.pi)


def _unseen_rim(view: View, gap: float) -> tuple[FloatArray, FloatArray]:
    """Points where what is seen borders on the unseen, (n, 2) [m], and the direction to the unseen side.

    They lie at the end of open beams, and along the edge of the shadow between neighbouring beams whose
    ranges differ by more than `gap`: nothing narrower lets the robot through.
    """
    sight, open_beams = view.sight, view.open_beams
    heading = view.fan.angles + view.pose.heading
    far = np.flatnonzero(open_beams)[::4]
    points = [view.origin + view.directions[far] * sight[far, None]]
    outward = [heading[far]]
    for beam in np.flatnonzero(np.abs(np.diff(sight)) > gap).tolist():
        left_is_far = sight[beam + 1] > sight[beam]
        near, long = (beam, beam + 1) if left_is_far else (beam + 1, beam)
        radius = np.arange(sight[near] + 0.25 * gap, sight[long], 0.7 * gap)
        points.append(view.origin + view.directions[long] * radius[:, None])
        outward.append(
            np.full(len(radius), heading[long] + (-math.pi / 2 if left_is_far else math.pi / 2))
        )
    return np.concatenate(points), np.concatenate(outward)
