"""The boundary of an inflated obstacle, traced by rolling a disc over the points that the laser hit.

The disc's radius is the clearance. It pivots about the point that it touches until it touches the next
one; its centre then draws exactly the boundary that a point robot would follow among obstacles grown by
that radius. A gap between points is a way through only if the disc fits, so nothing is decided by rule.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from robot_agent.core.planning.view import View

ARC_STEP = 0.35
"""Turn between two traced points of one arc [rad]: its chord misses the arc by 1.5 % of the radius."""

ROUNDING = 0.02
"""A point that the disc already overlaps by this turn is met at once [rad]: `settle` stops a little
short of touching, and the outline is known to a few millimetres."""

MOST_PIVOTS = 400
"""Bound of one trace. At a grain of 5 cm it is 20 m of a wall; a trace that it cuts goes on at the next
planning moment."""

MOST_PUSHES = 8
"""Steps in which a disc is pushed off the points that it overlaps: in a corner of two walls, two."""

TOUCHING = 1e-6
"""Distance from touching at which a disc touches [m]."""


def trace(view: View, start: FloatArray, radius: float, side: int, length: float) -> FloatArray:
    """Centres of the rolling disc from `start` on, as far as they are known to be free, (n, 2) [m].

    length: that is enough [m]. side: +1 has the obstacle on the left, -1 on the right. Empty if nothing
    is near enough to touch.
    """
    points = view.obstacles
    if not len(points):
        return np.empty((0, 2))
    centre, contact = settle(points, start, radius)
    if math.dist(centre, start) > radius:
        return np.empty((0, 2))
    traced = [centre]
    angle = elementary.atan2(*(centre - points[contact])[::-1])
    before, rolled = contact, 0.0
    for _ in range(MOST_PIVOTS):
        turn, following = _pivot(points, contact, before, angle, radius, side)
        steps = max(1, math.ceil(turn / ARC_STEP))
        arc = angle + side * turn * np.arange(1, steps + 1) / steps
        traced += list(
            points[contact] + radius * np.column_stack((elementary.cosines(arc), elementary.sines(arc)))
        )
        rolled += radius * turn
        if (
            following == contact
            or rolled > length
            or math.dist(traced[-1], view.origin) > view.beams.range
        ):
            break
        angle = elementary.atan2(*(traced[-1] - points[following])[::-1])
        before, contact = contact, following
    return _known(view, np.array(traced), radius)


def settle(points: FloatArray, start: FloatArray, radius: float) -> tuple[FloatArray, int]:
    """The place nearest to `start` where a disc touches a point and overlaps none, and that point."""
    centre, contact = start.copy(), 0
    for _ in range(MOST_PUSHES):
        offset = centre - points
        distance = elementary.lengths(offset[:, 0], offset[:, 1])
        contact = int(np.argmin(distance))
        if abs(distance[contact] - radius) < TOUCHING:
            break
        away = offset[contact] / max(float(distance[contact]), 1e-9)
        centre = points[contact] + radius * away
    return centre, contact


def _pivot(
    points: FloatArray, contact: int, before: int, angle: float, radius: float, side: int
) -> tuple[float, int]:
    """How far the disc turns about its contact until it meets another point, and which [rad].

    before: the contact that it comes from. angle: from the contact to the disc's centre. With no other
    point in reach it goes once around the contact.
    """
    offset = points - points[contact]
    distance = elementary.lengths(offset[:, 0], offset[:, 1])
    near = np.flatnonzero((distance < 2.0 * radius) & (distance > TOUCHING))
    if not len(near):
        return 2.0 * math.pi, contact
    bearing = elementary.directions(offset[near, 1], offset[near, 0])
    half = 0.5 * distance[near]
    away = elementary.directions(np.sqrt(radius * radius - half * half), half)
    meets = bearing - side * away
    turn = (side * (meets - angle)) % (2.0 * math.pi)
    turn[(turn > 2.0 * math.pi - ROUNDING) & (near != before)] = 0.0
    best = int(np.lexsort((-distance[near], turn))[0])
    return float(turn[best]), int(near[best])


def _known(view: View, traced: FloatArray, radius: float) -> FloatArray:
    """The traced places up to the first that is neither in view nor, out of it, beside the robot."""
    bearing, distance = view.polar(traced)
    beside = (distance < 2.0 * radius) & (np.abs(bearing) > view.beams.angles[-1])
    unknown = np.flatnonzero(~(view.visible(traced) | beside))
    return traced[: unknown[0]] if len(unknown) else traced
