"""The frontiers that a leader remembers: the rules by which they are made, moved and closed.

A frontier is a place of a road map beside something that the laser did not see (frontier_detection.py).
It is remembered until it turns out to lead nowhere new.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.geometry import Pose, wrap_angle
from robot_agent.core.planning.distances import squared_distances
from robot_agent.core.planning.frontier_detection import (
    BORDER_REACH,
    SHADOW_WIDTH,
    Border,
    Candidates,
    border,
    candidates,
)
from robot_agent.core.planning.memory import CLOSED, FRONTIER, NOTHING, PLACE, Indices, WayPoints
from robot_agent.core.planning.perception import LocalMap
from robot_agent.core.planning.view import View

SPACING = 4.0
"""Least distance between frontiers, in inflations: 2 m, about as wide as what one look decides about."""

PLACE_SPACING = 1.2
"""Distance from the nearest place at which a new one is made, in spacings."""

AT_PLACE = 1.8
"""A robot this near to a place is there, in inflations."""

CLOSED_SPACING = 0.5
"""Least distance of a new frontier from a closed one, in spacings."""

LOOK_BEYOND = 3.0
"""Length of the straight way from a frontier to the goal that is looked along, in spacings."""

WALL_WITHIN = 1.0
"""What that straight way keeps, in inflations."""

MOST_MOVES = 8
"""Moves of one frontier: the shadow of a pillar would otherwise lead around it for ever."""

MOVED_UP_TO, MOVED_FROM_ROBOT = 1.5, 0.5
"""How far a frontier moves at once, and how far from the robot it stays, in spacings."""

ENTERED = 0.4
"""A robot this near to a frontier stands in it, in spacings."""

LOOKS_OUT = 0.5
"""Cosine of the bearing of a frontier's unseen side (60 degrees)
within which the robot looks out of it."""

LOOKS_AWAY, PASSED_BY = 0.36, 1.5
"""Cosine of the same bearing (69 degrees) beyond which the robot looks away from it, and the distance up
to which a frontier that it looks away from is not judged, in spacings: its border is out of view."""

SEEN_RANGE = 0.6
"""Part of the laser's range in which a place that the robot looked at was judged."""

SEEN_AHEAD = 0.1
"""Cosine of the bearing (84 degrees) within which a place lay in view."""

SEEN_PAST = 0.3
"""Clearance of the line of sight to it, in inflations: nothing known now may stand in between."""


class Frontiers:
    """Places and frontiers, by the number of their way point in `memory`. Lengths follow the inflation.

    gaze: direction that the robot looked at a place, or that the unseen lies in from a frontier [rad].
    walled: whether a wall was seen right before a frontier towards the goal. place: where the robot is.
    """

    def __init__(self, capacity: int, goal: FloatArray, inflation: float) -> None:
        self.memory = WayPoints(capacity)
        self.gaze: FloatArray = np.zeros(capacity)
        self.walled = np.zeros(capacity, dtype=np.bool_)
        self._moves = np.zeros(capacity, dtype=np.uint8)
        self.goal = goal
        self.inflation = inflation
        self.spacing = SPACING * inflation
        self.border_reach = BORDER_REACH * inflation
        self.place = NOTHING

    @property
    def nbytes(self) -> int:
        """Bytes of the memory, full or empty."""
        return self.memory.nbytes + int(self.gaze.nbytes + self._moves.nbytes + self.walled.nbytes)

    def note_place(self, pose: Pose, reach: dict[int, float], laser_range: float) -> None:
        """Where the robot is becomes a place if none is near; edges lead to the way points in reach.

        reach: way points and the length of the way to them [m].
        """
        memory = self.memory
        nearest, distance = memory.nearest(pose.x, pose.y, PLACE)
        before = self.place
        if nearest == NOTHING or (distance > PLACE_SPACING * self.spacing and memory.has_room):
            self.place = memory.add(pose.x, pose.y, PLACE)
            self.gaze[self.place] = pose.heading
        elif distance < AT_PLACE * self.inflation:
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

    def update(self, local: LocalMap, record: float) -> dict[int, int]:
        """Close the frontiers that are in full view or move them on, and remember the new ones.

        record: least distance to the goal that the robot ever had [m]. Returns the frontiers that
        are now at a point of the road map where they were not before, and that point.
        """
        seen = border(local.view, SHADOW_WIDTH * self.inflation, self.goal, record)
        found = candidates(local, seen, self.border_reach)
        settled = self._judge(local, seen, found)
        settled |= self._draw_closer(found, record)
        settled |= self._remember(local.view, found, record)
        self._look_beyond(local.view)
        return settled

    def close(self, number: int) -> None:
        """A frontier that leads nowhere new, or that cannot be driven to."""
        self.memory.close(number)

    def part(self, a: int, b: int) -> None:
        """The way between two way points cannot be driven."""
        self.memory.part(a, b)

    def _judge(self, local: LocalMap, seen: Border, found: Candidates) -> dict[int, int]:
        """Frontiers in full view with nothing unseen around them, and those that the robot stands in and
        looks out of: move them on with the border if that is near, and close the others.
        """
        view, memory = local.view, self.memory
        frontiers = np.array([n for n in local.known if memory.kind[n] == FRONTIER], dtype=np.intp)
        points = memory.xy[frontiers]
        distance2 = squared_distances(points, seen.points).min(axis=1, initial=np.inf)
        beside_unseen = distance2 < self.border_reach * self.border_reach
        still = beside_unseen & view.free(points, local.roadmap.clearance)[0]
        turn = self.gaze[frontiers] - view.pose.heading
        near = elementary.lengths(*(points - view.origin).T) < PASSED_BY * self.spacing
        away = (elementary.cosines(turn) < LOOKS_AWAY) & near
        done = frontiers[~still & ~away].tolist()
        from_robot = elementary.lengths(*(found.points[found.indices] - view.origin).T)
        ahead = found.indices[from_robot >= MOVED_FROM_ROBOT * self.spacing]
        settled: dict[int, int] = {}
        for number in done + [n for n in self._entered(view.pose) if n not in done]:
            point = self._next_point(number, ahead, found.points)
            if point == NOTHING:
                memory.close(number)
            else:
                self._moves[number] += 1
                self._move(number, found, point)
                settled[number] = point
        return settled

    def _entered(self, pose: Pose) -> list[int]:
        """Frontiers that the robot stands in with their unseen side in view."""
        frontiers = self.memory.of_kind(FRONTIER)
        distance = elementary.lengths(*(self.memory.xy[frontiers] - (pose.x, pose.y)).T)
        ahead = elementary.cosines(self.gaze[frontiers] - pose.heading) > LOOKS_OUT
        return [int(n) for n in frontiers[(distance < ENTERED * self.spacing) & ahead]]

    def _next_point(self, number: int, ahead: Indices, points: FloatArray) -> int:
        """Where a frontier goes on to, for the border recedes as the robot comes closer; or NOTHING.

        ahead: candidates that the robot does not stand at. points: of the road map, (n, 2) [m].
        """
        if not len(ahead) or self._moves[number] >= MOST_MOVES:
            return NOTHING
        distance = elementary.lengths(*(points[ahead] - self.memory.xy[number]).T)
        nearest = int(np.argmin(distance))
        if distance[nearest] > MOVED_UP_TO * self.spacing:
            return NOTHING
        others = self.memory.of_kind(FRONTIER)
        others = others[others != number]
        point = int(ahead[nearest])
        apart2 = squared_distances(points[point][None], self.memory.xy[others]).min(initial=np.inf)
        return point if apart2 >= self.spacing * self.spacing else NOTHING

    def _draw_closer(self, found: Candidates, record: float) -> dict[int, int]:
        """The best place ahead takes the place of a nearby frontier that is farther from the goal.

        Otherwise frontiers that were there first would draw the robot to and fro across the open.
        """
        closer = found.indices[self._breaks(found.points[found.indices], record)]
        if not len(closer):
            return {}
        left = elementary.lengths(*(found.points[closer] - self.goal).T)
        best = int(np.argmin(found.costs[closer] + left))
        point = int(closer[best])
        x, y = found.points[point].tolist()
        number, distance = self.memory.nearest(x, y, FRONTIER)
        if distance >= self.spacing or math.dist(self.memory.xy[number], self.goal) <= left[best]:
            return {}
        self._move(number, found, point)
        return {number: point}

    def _remember(self, view: View, found: Candidates, record: float) -> dict[int, int]:
        """New frontiers, the most promising first."""
        points = found.points
        value = found.costs + elementary.lengths(*(points - self.goal).T)
        worth = found.indices[self._worth(points[found.indices], record)]
        decided: list[int] = []
        settled: dict[int, int] = {}
        for point in worth[np.argsort(value[worth], kind="stable")].tolist():
            here = points[point]
            if not self.memory.has_room:
                break
            if any(math.dist(here, points[p]) < self.spacing for p in decided):
                continue
            decided.append(point)
            if self._breaks(here[None], record)[0] or not self._seen_before(view, here):
                number = self.memory.add(float(here[0]), float(here[1]), FRONTIER)
                self._moves[number] = 0
                self._settle(number, found, point)
                settled[number] = point
        return settled

    def _move(self, number: int, found: Candidates, point: int) -> None:
        """Put a frontier at another point of the road map."""
        x, y = found.points[point].tolist()
        self.memory.move(number, x, y)
        self._settle(number, found, point)

    def _settle(self, number: int, found: Candidates, point: int) -> None:
        """A frontier without edges is at this point of the road map from now on."""
        offset = math.dist(found.points[0], self.memory.xy[self.place])
        self.walled[number] = False
        self.memory.join(self.place, number, float(found.costs[point]) + offset)
        self.gaze[number] = found.outward[point]

    def _worth(self, points: FloatArray, record: float) -> BoolArray:
        """Which (n, 2) points are worth a new frontier.

        They are far enough from other frontiers, and either break the record or are far enough from
        places and closed frontiers.
        """
        nearest2 = {
            kind: squared_distances(points, self.memory.xy[self.memory.of_kind(kind)]).min(
                axis=1, initial=np.inf
            )
            for kind in (PLACE, FRONTIER, CLOSED)
        }
        apart, from_closed = self.spacing, CLOSED_SPACING * self.spacing
        new = (nearest2[PLACE] >= apart * apart) & (nearest2[CLOSED] >= from_closed * from_closed)
        alone = nearest2[FRONTIER] >= apart * apart
        return np.asarray(alone & (new | self._breaks(points, record)))

    def _breaks(self, points: FloatArray, record: float) -> BoolArray:
        """Which (n, 2) points are closer to the goal than the robot ever was, by one inflation."""
        return np.asarray(elementary.lengths(*(points - self.goal).T) < record - self.inflation)

    def _seen_before(self, view: View, point: FloatArray) -> bool:
        """Did the robot look at this point from near by before? Then it was judged there and then.

        A place looked at what lay before it; nothing known now may stand in between.
        """
        places = self.memory.of_kind(PLACE)
        offset = point - self.memory.xy[places]
        near = elementary.lengths(*offset.T) < SEEN_RANGE * view.beams.range
        bearing = elementary.directions(offset[:, 1], offset[:, 0]) - self.gaze[places]
        ahead = elementary.cosines(bearing) > SEEN_AHEAD
        places = places[near & ahead & (places != self.place)]
        if not len(places):
            return False
        ends = np.broadcast_to(point, (len(places), 2))
        clear = view.passable(self.memory.xy[places], ends, SEEN_PAST * self.inflation)
        return bool(clear.any())

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
        ends = points + offset * share[:, None]
        self.walled[frontiers] |= ~view.passable(points, ends, WALL_WITHIN * self.inflation)
