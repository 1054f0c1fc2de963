"""DistBug: motion to the goal and boundary following, with the leave condition that makes it complete.

Kamon and Rivlin, "Sensory-based motion planning with global proofs" (IEEE Trans. Robotics and
Automation 13(6), 1997). The robot moves to the goal while it can come closer; at an obstacle it follows
the boundary until the laser shows a place that is closer to the goal than all of the boundary so far,
by at least a step; a closed loop without such a place proves that there is no way. Memory: the least
distance, the hit point and the anchor, whatever the size of the map.

Differs: the free range towards the goal is replaced by any place of the local road map that is closer
by the step, because the laser sees more than one direction; every such place also meets the proof's
condition, that each leaving lowers the least distance by a step.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from robot_agent.core.planning.boundary import settle, trace
from robot_agent.core.planning.roadmap import RoadMap
from robot_agent.core.planning.view import View

TURN_TO_LOOK = 0.8
"""Turn towards the boundary when nothing of it ahead is known [rad]."""

AHEAD = 10.0
"""Length of the boundary ahead that is looked for while it is followed, in radii."""

MOST_LOOKS = 9
"""Turns in a row after which the whole circle was seen."""


@dataclass(slots=True)
class Circuit:
    """One boundary following. side: +1 obstacle on the left. hit, course: where it began, and which way.

    ahead: (n, 2) boundary known ahead of the anchor, its first point. length: followed so far [m].
    leaving: it is on its way to a place that seemed to be closer; the boundary is given up only when
    the robot is closer indeed. loyal_until: length before which it does not try that again [m].
    """

    side: int
    hit: FloatArray
    course: FloatArray
    ahead: FloatArray
    length: float = 0.0
    leaving: bool = False
    loyal_until: float = 0.0


class DistBug:
    """One run of the algorithm. radius: of the rolling disc, the clearance kept [m]."""

    def __init__(self, goal: FloatArray, radius: float) -> None:
        self.goal = goal
        self.radius = radius
        self.step = 0.5 * radius
        self.least = math.inf
        self.circuit: Circuit | None = None
        self.enclosed = False
        self.turn: float | None = None
        self.looks = 0

    def way(self, view: View, roadmap: RoadMap, costs: FloatArray) -> FloatArray | None:
        """The way to take now, (n, 2) [m]; None with `turn` set to a heading, or with `enclosed`."""
        self.turn = None
        circuit, here = self.circuit, math.dist(view.origin, self.goal)
        if circuit is not None and here < self.least - self.step:
            circuit = self.circuit = None
        self.least = min(self.least, here)
        if circuit is not None and not circuit.leaving:
            self._advance(view, circuit)
            if self.enclosed:
                return None
        closer = self._closer(view, roadmap, costs)
        if circuit is None:
            return self._hit(view) if closer is None else closer
        if closer is not None and circuit.length >= circuit.loyal_until:
            circuit.leaving = True
            return closer
        if circuit.leaving:
            circuit.leaving = False
            circuit.loyal_until = circuit.length + 4.0 * self.radius
        return self._follow(view, circuit)

    def _closer(self, view: View, roadmap: RoadMap, costs: FloatArray) -> FloatArray | None:
        """Way to the best place that meets the leave condition, if one is in reach.

        Only in the nearer half of the view: further out a wall that the beams graze is seen by so few
        hits that places on it look free.
        """
        left = elementary.lengths(*(roadmap.points - self.goal).T)
        meets = (left < self.least - self.step) & (costs < 0.5 * view.fan.range)
        total = np.where(meets, costs + left, np.inf)
        best = int(np.argmin(total))
        return roadmap.path(best) if math.isfinite(total[best]) else None

    def _hit(self, view: View) -> FloatArray | None:
        """The robot came to an obstacle: choose the side whose known boundary leads closer."""
        towards = elementary.atan2(self.goal[1] - view.origin[1], self.goal[0] - view.origin[0])
        if abs(math.remainder(towards - view.pose.heading, 2.0 * math.pi)) > 0.8 and self.looks == 0:
            self.looks += 1
            self.turn = towards
            return None
        self.looks = 0
        contact = self._contact(view, towards)
        best: tuple[float, int, FloatArray] | None = None
        for side in (1, -1):
            ahead = trace(view, contact, self.radius, side, view.fan.range)
            if len(ahead) > 1:
                value = _length(ahead) + math.dist(ahead[-1], self.goal)
                if best is None or value < best[0]:
                    best = value, side, ahead
        if best is None:
            self.turn = view.pose.heading + TURN_TO_LOOK
            return None
        _, side, ahead = best
        self.circuit = Circuit(side, ahead[0].copy(), ahead[1] - ahead[0], ahead)
        return self._to_boundary(view, ahead)

    def _contact(self, view: View, towards: float) -> FloatArray:
        """Where a disc that rolls straight towards the goal first touches something."""
        distance = np.arange(0.0, view.fan.range, 0.1 * self.radius)
        line = view.origin + distance[:, None] * np.array(
            (elementary.cos(towards), elementary.sin(towards))
        )
        blocked = np.flatnonzero(view.free(line, self.radius)[1] < self.radius)
        first = line[max(int(blocked[0]) - 1, 0)] if len(blocked) else view.origin
        return settle(view.obstacles, first, self.radius)[0] if len(view.obstacles) else first

    def _advance(self, view: View, circuit: Circuit) -> None:
        """Move the anchor to the boundary place nearest to the robot; see if the loop closed."""
        nearest = int(np.argmin(elementary.lengths(*(circuit.ahead - view.origin).T)))
        passed = circuit.ahead[: nearest + 1]
        circuit.ahead = circuit.ahead[nearest:]
        self.least = min(self.least, float(elementary.lengths(*(passed - self.goal).T).min()))
        for a, b in itertools.pairwise(passed):
            circuit.length += math.dist(a, b)
            again = math.dist(b, circuit.hit) < 0.6 * self.radius and bool(
                ((b - a) * circuit.course).sum() > 0.0
            )
            if again and circuit.length > 6.0 * self.radius:
                self.enclosed = True

    def _follow(self, view: View, circuit: Circuit) -> FloatArray | None:
        """On along the boundary from the anchor; a turn towards it when nothing of it is known."""
        ahead = trace(view, circuit.ahead[0], self.radius, circuit.side, AHEAD * self.radius)
        if _length(ahead) < self.radius:
            self.looks += 1
            self.turn = view.pose.heading + circuit.side * TURN_TO_LOOK
            if self.looks > MOST_LOOKS:
                self.circuit, self.looks = None, 0
            return None
        self.looks = 0
        circuit.ahead = ahead
        return self._to_boundary(view, ahead)

    def _to_boundary(self, view: View, ahead: FloatArray) -> FloatArray:
        """From the robot along the boundary, corners cut where the way is clear."""
        chain = np.concatenate((view.origin[None], ahead))
        keep, here = [0], 0
        while here < len(chain) - 1:
            rest = np.arange(here + 1, min(here + 40, len(chain)))
            start = np.broadcast_to(chain[here], (len(rest), 2))
            clear = rest[view.passable(start, chain[rest], 0.98 * self.radius)]
            here = int(clear[-1]) if len(clear) else here + 1
            keep.append(here)
        return chain[keep]


def _length(way: FloatArray) -> float:
    return float(elementary.lengths(*np.diff(way, axis=0).T).sum()) if len(way) > 1 else 0.0
