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
from typing import NamedTuple

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from onehop.contracts.geometry import TAU
from robot_agent.core.planning.boundary import settle, trace
from robot_agent.core.planning.roadmap import RoadMap
from robot_agent.core.planning.view import View

STEP = 0.5
"""How much closer to the goal a place must be to leave the boundary for it, in radii."""

TURN_TO_LOOK = 0.8
"""Turn towards the boundary when nothing of it ahead is known [rad]: a quarter of the view, so that it
comes into view and what was in view stays."""

MOST_LOOKS = math.ceil(TAU / TURN_TO_LOOK) + 1
"""Turns of TURN_TO_LOOK in a row after which the whole circle was seen."""

FACING = 0.8
"""Bearing of the goal up to which an obstacle before the robot is seen on both of its sides [rad]."""

AHEAD = 10.0
"""Length of the boundary ahead that is looked for while it is followed, in radii: 5 m, three times what
is driven between two planning moments."""

STAY = 4.0
"""Way along the boundary in which it is not left again after leaving it failed, in radii."""

CLOSED_WITHIN = 0.6
"""Distance from the hit point at which the loop is closed, in radii: more than the longest step between
two traced places (0.35, boundary.py) and a little for a boundary that was traced from elsewhere."""

LOOP_AT_LEAST = 6.0
"""Length of the shortest loop, in radii: around a point it is 2 pi."""

SURE_RANGE = 0.5
"""Part of the laser's range in which a place is left for: further out a wall that the beams graze is
seen by so few hits that places on it look free."""

CONTACT_STEP = 0.1
"""Spacing of the places at which the disc that rolls to the goal is tested, in radii."""

CUT_CLEARANCE = 0.98
"""Part of the radius that a cut corner keeps: the traced places have just the radius, and rounding must
not forbid the way from one to the next."""

MOST_CUT = 40
"""Traced places among which a cut is looked for; it bounds the work of one way."""


@dataclass(slots=True)
class Circuit:
    """One boundary following. side: +1 obstacle on the left. hit, course: hit point, and which way then.

    ahead: (n, 2) boundary known ahead of the anchor, its first point. length: followed so far [m].
    leaving: it is on its way to a place that seemed to be closer; the boundary is given up only when
    the robot is closer indeed. stay_until: length before which it does not try that again [m].
    """

    side: int
    hit: FloatArray
    course: FloatArray
    ahead: FloatArray
    length: float = 0.0
    leaving: bool = False
    stay_until: float = 0.0


class Move(NamedTuple):
    """What to do now: take a way, (n, 2) [m], or turn to a heading [rad], or neither: ENCLOSED."""

    way: FloatArray | None = None
    heading: float | None = None


ENCLOSED = Move()
"""The boundary is a closed loop without a place closer to the goal: there is no way."""


class DistBug:
    """One run of the algorithm. radius: of the rolling disc, the clearance kept [m].

    least: distance to the goal of the closest place so far, of the way and of the boundary [m].
    looks: turns in a row to look for the boundary.
    """

    def __init__(self, goal: FloatArray, radius: float) -> None:
        self.goal = goal
        self.radius = radius
        self.step = STEP * radius
        self.least = math.inf
        self.circuit: Circuit | None = None
        self.looks = 0

    def move(self, view: View, roadmap: RoadMap, costs: FloatArray) -> Move:
        """What to do now. costs: of the way to each point of the road map [m]."""
        circuit, here = self.circuit, math.dist(view.origin, self.goal)
        if circuit is not None and here < self.least - self.step:
            circuit = self.circuit = None
        self.least = min(self.least, here)
        if circuit is not None and not circuit.leaving and self._advance(view, circuit):
            return ENCLOSED
        closer = self._closer(view, roadmap, costs)
        if circuit is None:
            return self._hit(view) if closer is None else Move(closer)
        if closer is not None and circuit.length >= circuit.stay_until:
            circuit.leaving = True
            return Move(closer)
        if circuit.leaving:
            circuit.leaving = False
            circuit.stay_until = circuit.length + STAY * self.radius
        return self._follow(view, circuit)

    def _closer(self, view: View, roadmap: RoadMap, costs: FloatArray) -> FloatArray | None:
        """Way to the best place that meets the leave condition, if one is in reach."""
        left = elementary.lengths(*(roadmap.points - self.goal).T)
        meets = (left < self.least - self.step) & (costs < SURE_RANGE * view.beams.range)
        total = np.where(meets, costs + left, np.inf)
        best = int(np.argmin(total))
        return roadmap.path(best) if math.isfinite(total[best]) else None

    def _hit(self, view: View) -> Move:
        """The robot came to an obstacle: choose the side whose known boundary leads closer."""
        towards = elementary.atan2(self.goal[1] - view.origin[1], self.goal[0] - view.origin[0])
        if abs(math.remainder(towards - view.pose.heading, TAU)) > FACING and self.looks == 0:
            self.looks += 1
            return Move(heading=towards)
        self.looks = 0
        contact = self._contact(view, towards)
        best: tuple[float, int, FloatArray] | None = None
        for side in (1, -1):
            ahead = trace(view, contact, self.radius, side, view.beams.range)
            if len(ahead) > 1:
                value = _length(ahead) + math.dist(ahead[-1], self.goal)
                if best is None or value < best[0]:
                    best = value, side, ahead
        if best is None:
            return Move(heading=view.pose.heading + TURN_TO_LOOK)
        _, side, ahead = best
        self.circuit = Circuit(side, ahead[0].copy(), ahead[1] - ahead[0], ahead)
        return Move(self._to_boundary(view, ahead))

    def _contact(self, view: View, towards: float) -> FloatArray:
        """Where a disc that rolls straight towards the goal first touches something."""
        distance = np.arange(0.0, view.beams.range, CONTACT_STEP * self.radius)
        line = view.origin + distance[:, None] * np.array(
            (elementary.cos(towards), elementary.sin(towards))
        )
        blocked = np.flatnonzero(view.free(line, self.radius)[1] < self.radius)
        first = line[max(int(blocked[0]) - 1, 0)] if len(blocked) else view.origin
        return settle(view.obstacles, first, self.radius)[0] if len(view.obstacles) else first

    def _advance(self, view: View, circuit: Circuit) -> bool:
        """Move the anchor to the boundary place nearest to the robot; says whether the loop closed."""
        nearest = int(np.argmin(elementary.lengths(*(circuit.ahead - view.origin).T)))
        passed = circuit.ahead[: nearest + 1]
        circuit.ahead = circuit.ahead[nearest:]
        self.least = min(self.least, float(elementary.lengths(*(passed - self.goal).T).min()))
        closed = False
        for a, b in itertools.pairwise(passed):
            circuit.length += math.dist(a, b)
            again = math.dist(b, circuit.hit) < CLOSED_WITHIN * self.radius and bool(
                ((b - a) * circuit.course).sum() > 0.0
            )
            closed |= again and circuit.length > LOOP_AT_LEAST * self.radius
        return closed

    def _follow(self, view: View, circuit: Circuit) -> Move:
        """On along the boundary from the anchor; a turn towards it when nothing of it is known."""
        ahead = trace(view, circuit.ahead[0], self.radius, circuit.side, AHEAD * self.radius)
        if _length(ahead) < self.radius:
            self.looks += 1
            if self.looks > MOST_LOOKS:
                self.circuit, self.looks = None, 0
            return Move(heading=view.pose.heading + circuit.side * TURN_TO_LOOK)
        self.looks = 0
        circuit.ahead = ahead
        return Move(self._to_boundary(view, ahead))

    def _to_boundary(self, view: View, ahead: FloatArray) -> FloatArray:
        """From the robot along the boundary, corners cut where the way is clear."""
        chain = np.concatenate((view.origin[None], ahead))
        keep, here = [0], 0
        while here < len(chain) - 1:
            rest = np.arange(here + 1, min(here + MOST_CUT, len(chain)))
            start = np.broadcast_to(chain[here], (len(rest), 2))
            clear = rest[view.passable(start, chain[rest], CUT_CLEARANCE * self.radius)]
            here = int(clear[-1]) if len(clear) else here + 1
            keep.append(here)
        return chain[keep]


def _length(way: FloatArray) -> float:
    return float(elementary.lengths(*np.diff(way, axis=0).T).sum()) if len(way) > 1 else 0.0
