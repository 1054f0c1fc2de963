"""Which obstacle stands in the way, and where the fan turns because of it (thesis 3.4.1, Algorithm 2 a).

Only what is nearer than the classification range (3 m) counts. The thesis names the cases and does not
say how they are told apart; here a hit belongs to the right, the front or the left third of the
view, and the nearest of them decides: in front with something beside it, a corner; at one side, a wall
to follow, even if it reaches into the front.
"""

import math
from enum import Enum

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray
from robot_agent.core.planning.view import View

FRONT_HALF = math.radians(30.0)
"""Half of the front third of the view [rad]."""

WALL_HALF = math.radians(8.0)
"""Angle to each side of the nearest hit within which hits show the direction of a wall [rad]: 0.4 m of
it at 3 m, enough for a direction and too short to reach around a corner."""


class Obstacle(Enum):
    """The cases of Algorithm 2."""

    NONE = "none"
    LEFT_CORNER = "left corner"
    RIGHT_CORNER = "right corner"
    FRONT = "front"
    LEFT = "left"
    RIGHT = "right"
    BOTH = "left and right"


def classify(view: View, within: float) -> Obstacle:
    """The case of this view, of hits nearer than `within` [m]."""
    angles = view.beams.angles
    close = view.solid & (view.sight < within)
    if not close.any():
        return Obstacle.NONE
    left, right = close & (angles > FRONT_HALF), close & (angles < -FRONT_HALF)
    front = bool(close[np.abs(angles) <= FRONT_HALF].any())
    facing = abs(angles[_nearest(view, close)]) <= FRONT_HALF
    sides = int(left.any()) + int(right.any())
    if not sides:
        return Obstacle.FRONT
    nearer_left = bool(angles[_nearest(view, left | right)] > 0.0)
    if facing or (front and sides == 2):
        return Obstacle.LEFT_CORNER if nearer_left else Obstacle.RIGHT_CORNER
    if sides == 2:
        return Obstacle.BOTH
    return Obstacle.LEFT if nearer_left else Obstacle.RIGHT


def _nearest(view: View, beams: BoolArray) -> int:
    """The beam with the shortest range among these."""
    return int(np.argmin(np.where(beams, view.sight, np.inf)))


TURNS = {
    Obstacle.LEFT_CORNER: -math.pi / 2,
    Obstacle.RIGHT_CORNER: math.pi / 2,
    Obstacle.FRONT: math.pi,
}
"""By how much the fan turns at a corner or before a wall [rad]."""


def fan_direction(view: View, obstacle: Obstacle, within: float) -> float:
    """Direction of the limited fan, map frame [rad], for an obstacle beside the robot."""
    if obstacle is Obstacle.BOTH:
        return view.pose.heading + _middle(view, within)
    side = view.beams.angles > 0.0 if obstacle is Obstacle.LEFT else view.beams.angles < 0.0
    close = side & view.solid & (view.sight < within)
    nearest = _nearest(view, close)
    half = view.beams.spanned(WALL_HALF)
    beams = np.flatnonzero(close[: nearest + half + 1])
    beams = beams[beams >= nearest - half]
    return _along(view.origin + view.directions[beams] * view.sight[beams, None], view.pose.heading)


def _along(wall: FloatArray, heading: float) -> float:
    """Direction of the line through hits of a wall, the one of the two that is closer to the heading."""
    spread = wall - wall.mean(axis=0)
    x, y = spread[:, 0], spread[:, 1]
    sxx, syy, sxy = (float(product.sum()) for product in (x * x, y * y, x * y))
    direction = 0.5 * elementary.atan2(2.0 * sxy, sxx - syy)
    return direction if elementary.cos(direction - heading) >= 0.0 else direction + math.pi


def _middle(view: View, within: float) -> float:
    """Bearing of the middle of the widest run of beams that are free as far as `within` [rad]."""
    free = np.concatenate(([False], view.sight >= within, [False]))
    edges = np.flatnonzero(np.diff(free.astype(np.int8)))
    starts, ends = edges[::2], edges[1::2] - 1
    if not len(starts):
        return 0.0
    widest = int(np.argmax(ends - starts))
    return float(0.5 * (view.beams.angles[starts[widest]] + view.beams.angles[ends[widest]]))
