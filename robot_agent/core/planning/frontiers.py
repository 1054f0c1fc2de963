"""Where the seen borders on the unseen: frontiers, and which of them is the most promising.

A frontier is a place of a road map beside something that the laser did not see. It is remembered until
it turns out to lead nowhere new. Under the freespace assumption (Koenig, Tovey and Smirnov,
"Performance bounds for planning in unknown terrain", Artificial Intelligence 147, 2003) the best one
has the least sum of the known way to it and the straight distance from it to the goal. That distance
weighs more (EAGERNESS), and one with a wall right before it towards the goal counts as farther.
"""

import math
from typing import NamedTuple

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.geometry import Pose, wrap_angle
from robot_agent.core.planning.memory import CLOSED, FRONTIER, NOTHING, PLACE, Indices, WayPoints
from robot_agent.core.planning.roadmap import RoadMap
from robot_agent.core.planning.view import View, squared_distances


class Edge(NamedTuple):
    """The points of a road map that lie beside something unseen: `beside`, ascending.

    Of all points of the road map: costs, of the way there [m]; outward, direction to the unseen [rad].
    offset: from the robot to the present place [m]. noted: which frontiers came to which point.
    """

    roadmap: RoadMap
    costs: FloatArray
    outward: FloatArray
    beside: Indices
    offset: float
    noted: dict[int, int]


MOST_MOVES = 8
"""Moves of one frontier: the shadow of a pillar would otherwise lead around it for ever."""

EAGERNESS = 1.3
"""Weight of the straight distance to the goal against the way to a frontier. At 1 a robot that went past
a door goes on along the wall for ever: every step away from the door makes it dearer by as much."""

LOOK_BEYOND = 3.0
"""Length of the straight way from a frontier to the goal that is looked along, in spacings."""


class Route(NamedTuple):
    """A way over way points to `target`, `cost` long [m]; target NOTHING: there is none.

    origin: where each way point on it is reached from.
    """

    target: int
    cost: float
    origin: dict[int, int]

    def chain(self) -> list[int]:
        """Its way points, the target first."""
        chain = [self.target]
        while self.origin[chain[-1]] != NOTHING:
            chain.append(self.origin[chain[-1]])
        return chain


class Frontiers:
    """Way points and the rules that make, close and choose frontiers. Lengths follow the inflation."""

    def __init__(self, capacity: int, goal: FloatArray, inflation: float, wall: float) -> None:
        self.memory = WayPoints(capacity)
        self.gaze: FloatArray = np.zeros(capacity)
        self.moves = np.zeros(capacity, dtype=np.uint8)
        self.walled = np.zeros(capacity, dtype=np.bool_)
        self.goal = goal
        self.inflation = inflation
        self.wall = wall
        self.spacing = 4.0 * inflation
        self.rim = 3.0 * inflation
        self.place = NOTHING

    @property
    def nbytes(self) -> int:
        """Bytes of the memory, full or empty."""
        return self.memory.nbytes + int(self.gaze.nbytes + self.moves.nbytes + self.walled.nbytes)

    def in_view(self, view: View) -> list[int]:
        """Places and frontiers in view, ascending."""
        numbers = self.memory.of_kind(PLACE + FRONTIER)
        return [int(n) for n in numbers[view.visible(self.memory.xy[numbers])]]

    def note_place(self, pose: Pose, reach: dict[int, float], laser_range: float) -> None:
        """Where the robot is becomes a place if none is near; edges lead to the way points in reach."""
        memory = self.memory
        nearest, distance = memory.nearest(pose.x, pose.y, PLACE)
        before = self.place
        if nearest == NOTHING or (distance > 1.2 * self.spacing and memory.has_room):
            self.place = memory.add(pose.x, pose.y, PLACE)
            self.gaze[self.place] = pose.heading
        elif distance < 1.8 * self.inflation:
            self.place = nearest
        if before == NOTHING:
            self._note_rear(pose, laser_range)
        elif before != self.place:
            memory.join(before, self.place, math.dist(memory.xy[before], memory.xy[self.place]))
        offset = math.dist((pose.x, pose.y), memory.xy[self.place])
        for number, cost in sorted(reach.items()):
            memory.join(self.place, number, cost + offset)

    def _note_rear(self, pose: Pose, laser_range: float) -> None:
        """What lies behind the first pose is unseen: a frontier, as far away as the laser reaches."""
        rear = self.memory.add(pose.x, pose.y, FRONTIER)
        self.gaze[rear] = wrap_angle(pose.heading + math.pi)
        self.memory.join(self.place, rear, laser_range)

    def note(
        self, view: View, roadmap: RoadMap, costs: FloatArray, known: list[int], record: float
    ) -> dict[int, int]:
        """Close the frontiers that are in full view or move them on, and remember the new ones.

        record: least distance to the goal that the robot ever had [m]. Returns the frontiers that
        are now at a point of the road map where they were not before, and that point.
        """
        rim, outward = unseen_rim(view, 2.0 * self.inflation, self.goal, record)
        near_rim = squared_distances(roadmap.points, rim)
        beside = near_rim.min(axis=1, initial=np.inf) < self.rim * self.rim
        beside[0] = False
        outward = outward[near_rim.argmin(axis=1)] if len(rim) else np.zeros(len(roadmap.points))
        offset = math.dist(view.origin, self.memory.xy[self.place])
        edge = Edge(roadmap, costs, outward, np.flatnonzero(np.isfinite(costs) & beside), offset, {})
        self._refute(view, rim, known, edge)
        self._draw_on(edge, record)
        self._remember(view, edge, record)
        self._look_beyond(view)
        return edge.noted

    def _remember(self, view: View, edge: Edge, record: float) -> None:
        """New frontiers, the most promising first."""
        points = edge.roadmap.points
        value = edge.costs + elementary.lengths(*(points - self.goal).T)
        candidates = edge.beside[self._worth(points[edge.beside], record)]
        decided: list[int] = []
        for point in candidates[np.argsort(value[candidates], kind="stable")].tolist():
            here = points[point]
            if not self.memory.has_room:
                break
            if any(math.dist(here, points[p]) < self.spacing for p in decided):
                continue
            decided.append(point)
            if self._closer(here[None], record)[0] or not self._seen_before(view, here):
                number = self.memory.add(float(here[0]), float(here[1]), FRONTIER)
                self.moves[number] = 0
                self._place(number, edge, point)

    def _place(self, number: int, edge: Edge, point: int) -> None:
        """A frontier without edges is at this point of the road map from now on."""
        self.walled[number] = False
        self.memory.join(self.place, number, float(edge.costs[point]) + edge.offset)
        self.gaze[number] = edge.outward[point]
        edge.noted[number] = point

    def _look_beyond(self, view: View) -> None:
        """Note which frontiers in view have a wall right before them towards the goal.

        Walls do not go away: what was seen there once counts from any heading.
        """
        frontiers = self.memory.of_kind(FRONTIER)
        points = self.memory.xy[frontiers]
        shown = view.visible(points)
        frontiers, points = frontiers[shown], points[shown]
        offset = self.goal - points
        distance = elementary.lengths(offset[:, 0], offset[:, 1])
        share = np.minimum(1.0, LOOK_BEYOND * self.spacing / np.maximum(distance, 1e-9))
        clear = view.passable(points, points + offset * share[:, None], self.inflation)
        self.walled[frontiers] |= ~clear

    def _draw_on(self, edge: Edge, record: float) -> None:
        """The best place ahead takes the place of a nearby frontier that is farther from the goal.

        Otherwise frontiers that were there first would draw the robot to and fro across the open.
        """
        points = edge.roadmap.points
        closer = edge.beside[self._closer(points[edge.beside], record)]
        if not len(closer):
            return
        left = elementary.lengths(*(points[closer] - self.goal).T)
        best = int(np.argmin(edge.costs[closer] + left))
        x, y = points[closer[best]].tolist()
        number, distance = self.memory.nearest(x, y, FRONTIER)
        if distance < self.spacing and math.dist(self.memory.xy[number], self.goal) > left[best]:
            self._move(number, edge, int(closer[best]))

    def _move(self, number: int, edge: Edge, point: int) -> None:
        x, y = edge.roadmap.points[point].tolist()
        self.memory.move(number, x, y)
        self._place(number, edge, point)

    def _worth(self, points: FloatArray, record: float) -> BoolArray:
        """Which (n, 2) points are worth a new frontier.

        They are far enough from other frontiers, and either closer to the goal than the robot ever
        was, or far enough from places and closed frontiers.
        """
        nearest = {
            kind: squared_distances(points, self.memory.xy[self.memory.of_kind(kind)]).min(
                axis=1, initial=np.inf
            )
            for kind in (PLACE, FRONTIER, CLOSED)
        }
        apart = self.spacing * self.spacing
        new = (nearest[PLACE] >= apart) & (nearest[CLOSED] >= 0.25 * apart)
        return np.asarray((nearest[FRONTIER] >= apart) & (new | self._closer(points, record)))

    def _closer(self, points: FloatArray, record: float) -> BoolArray:
        """Which (n, 2) points are closer to the goal than the robot ever was, by a step."""
        return np.asarray(elementary.lengths(*(points - self.goal).T) < record - self.inflation)

    def _seen_before(self, view: View, point: FloatArray) -> bool:
        """Did the robot look at this place from near by before? Then it was judged there and then.

        A place looked at what lay before it; nothing known now may stand in between.
        """
        places = self.memory.of_kind(PLACE)
        offset = point - self.memory.xy[places]
        near = elementary.lengths(*offset.T) < 0.6 * view.fan.range
        before = (
            elementary.cosines(elementary.directions(offset[:, 1], offset[:, 0]) - self.gaze[places])
            > 0.1
        )
        places = places[near & before & (places != self.place)]
        if not len(places):
            return False
        ends = np.broadcast_to(point, (len(places), 2))
        return bool(view.passable(self.memory.xy[places], ends, 0.3 * self.inflation).any())

    def _refute(self, view: View, rim: FloatArray, known: list[int], edge: Edge) -> None:
        """Frontiers in full view with nothing unseen around them, and those that the robot stands in and
        looks out of: move them on with the edge of the unseen if that is near, and close the others.
        """
        frontiers = np.array([n for n in known if self.memory.kind[n] == FRONTIER], dtype=np.intp)
        points = self.memory.xy[frontiers]
        beside_unseen = squared_distances(points, rim).min(axis=1, initial=np.inf) < self.rim * self.rim
        still = beside_unseen & view.free(points, self.inflation)[0]
        turn = self.gaze[frontiers] - view.pose.heading
        behind = (elementary.cosines(turn) < 0.36) & (
            elementary.lengths(*(points - view.origin).T) < 1.5 * self.spacing
        )
        done = frontiers[~still & ~behind].tolist()
        for number in done + [n for n in self._entered(view.pose) if n not in done]:
            if not self._move_on(view, number, edge):
                self.memory.close(number)

    def _entered(self, pose: Pose) -> list[int]:
        """Frontiers that the robot stands in with their unseen side in view."""
        frontiers = self.memory.of_kind(FRONTIER)
        near = elementary.lengths(*(self.memory.xy[frontiers] - (pose.x, pose.y)).T) < 0.4 * self.spacing
        ahead = elementary.cosines(self.gaze[frontiers] - pose.heading) > 0.5
        return [int(n) for n in frontiers[near & ahead]]

    def _move_on(self, view: View, number: int, edge: Edge) -> bool:
        """The edge of the unseen recedes as the robot comes closer; its frontier goes with it."""
        if not len(edge.beside) or self.moves[number] >= MOST_MOVES:
            return False
        points = edge.roadmap.points[edge.beside]
        distance = elementary.lengths(*(points - self.memory.xy[number]).T)
        distance[elementary.lengths(*(points - view.origin).T) < 0.5 * self.spacing] = np.inf
        nearest = int(np.argmin(distance))
        if distance[nearest] > 1.5 * self.spacing:
            return False
        others = self.memory.of_kind(FRONTIER)
        others = others[others != number]
        apart = squared_distances(points[nearest][None], self.memory.xy[others]).min(initial=np.inf)
        if apart < self.spacing * self.spacing:
            return False
        self.moves[number] += 1
        self._move(number, edge, int(edge.beside[nearest]))
        return True

    def best(self, seeds: dict[int, float], kept: int) -> Route:
        """To the reachable frontier of the least estimate, or to `kept` if none is clearly better.

        seeds: way points in reach and their costs [m]. No frontier that costs more than the best one's
        estimate can be better, so the search ends there.
        """
        memory = self.memory
        origin: dict[int, int] = {}
        best, value, kept_cost, best_cost = NOTHING, math.inf, math.inf, math.inf
        for number, cost in memory.routes(seeds, origin):
            if cost > value + self.spacing:
                break
            if memory.kind[number] == FRONTIER:
                estimate = cost + EAGERNESS * math.dist(memory.xy[number], self.goal)
                if self.walled[number]:
                    estimate += self.wall
                if (estimate, number) < (value, best):
                    best, value, best_cost = number, estimate, cost
                if number == kept:
                    kept_cost, kept_value = cost, estimate
        if kept_cost < math.inf and kept_value <= value + self.spacing:
            return Route(kept, kept_cost, origin)
        return Route(best, best_cost, origin)

    def closest_place(self, seeds: dict[int, float]) -> Route:
        """To the reachable place that is closest to the goal."""
        memory = self.memory
        origin: dict[int, int] = {}
        costs = {
            number: cost for number, cost in memory.routes(seeds, origin) if memory.kind[number] == PLACE
        }
        best = min(costs, key=lambda n: (math.dist(memory.xy[n], self.goal), n))
        return Route(best, costs[best], origin)


def unseen_rim(view: View, gap: float, goal: FloatArray, record: float) -> tuple[FloatArray, FloatArray]:
    """Points where what is seen borders on the unseen, (n, 2) [m], and the direction to the unseen side.

    They lie along the edge of the shadow between neighbouring beams whose ranges differ by more than
    `gap`, since nothing narrower lets the robot through, and at the end of open beams. Of these only
    the ones beside an obstacle count, where its outline leaves the laser's range, and the ones closer to
    the goal than `record`: a shortest way bends nowhere else, so these are the nodes of TangentBug's
    local tangent graph (Kamon, Rimon and Rivlin 1998).
    """
    sight = view.sight
    heading = view.fan.angles + view.pose.heading
    ends = view.origin + view.directions * sight[:, None]
    beside = np.convolve(view.solid, np.ones(13), mode="same") > 0
    closer = elementary.lengths(*(ends - goal).T) < record
    closer[1::4] = closer[2::4] = closer[3::4] = False
    far = np.flatnonzero(~view.solid & (beside | closer))
    points = [ends[far]]
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
