"""Narrow passages: how much free width lies between what the laser sees to both sides of the way.

The team changes to a column when the width is less than its shape needs (thesis mode Narrow).
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from robot_agent.core.planning.distances import squared_distances
from robot_agent.core.planning.view import View

STEP = 0.5
"""Distance between the places of a way beside which obstacles are looked for [m]: each obstacle has a
place at most half of it away, and a bend of the way within it is small beside a team's width."""

PASSAGE_AHEAD = 8.0
"""How far ahead along its way a leader watches for passages, in inflations: 4 m, time for a team to
become a column before it is inside."""


def passage_width(view: View, way: FloatArray, ahead: float) -> float:
    """Width of the tightest place of the first `ahead` metres of a way, (n, 2) [m]; inf in the open.

    That is the least distance between something on the left of the way and something on its right, so
    that a door is as wide as it is, however slantingly the way leads through. What lies beyond the end
    of the way or behind its start is on no side. Without a way, n < 2, it is measured straight ahead.
    """
    if len(way) < 2:
        c, s = elementary.cos(view.pose.heading), elementary.sin(view.pose.heading)
        way = view.origin + np.array(((0.0, 0.0), (ahead * c, ahead * s)))
    places, course = _places(way, ahead)
    nearest = squared_distances(view.obstacles, places).argmin(axis=1)
    rest, course = view.obstacles - places[nearest], course[nearest]
    along = course[:, 0] * rest[:, 0] + course[:, 1] * rest[:, 1]
    left = course[:, 0] * rest[:, 1] - course[:, 1] * rest[:, 0]
    beside = np.abs(along) <= STEP
    sides = view.obstacles[beside & (left > 0.0)], view.obstacles[beside & (left <= 0.0)]
    return math.sqrt(float(squared_distances(*sides).min(initial=math.inf)))


def _places(way: FloatArray, ahead: float) -> tuple[FloatArray, FloatArray]:
    """Places every STEP of the first `ahead` metres of a way, and the course there, (n, 2) each."""
    legs = np.diff(way, axis=0)
    length = elementary.lengths(legs[:, 0], legs[:, 1])
    ends = np.cumsum(length)
    driven = np.arange(0.0, min(ahead, float(ends[-1])) + 1e-9, STEP)
    leg = np.minimum(np.searchsorted(ends, driven), len(legs) - 1)
    course = legs[leg] / np.maximum(length[leg], 1e-9)[:, None]
    return way[leg] + course * (driven - (ends - length)[leg])[:, None], course
