"""Narrow passages: how much free width lies between what the laser sees to both sides.

The team changes to a column when the width is less than its shape needs (thesis mode Narrow).
"""

import math

import numpy as np

from onehop.contracts import elementary
from robot_agent.core.planning.view import View

SLICE = 1.0
"""Length of the piece of passage that is measured at once [m]."""


def passage_width(view: View, ahead: float) -> float:
    """Least free width from beside the robot to `ahead` metres before it [m]; inf in the open.

    The view is cut into slices across the heading. A slice's width is the distance between the nearest
    obstacle to its left and to its right; a slice with an open side, or one that is blocked straight
    ahead (that is a wall across, not a passage), has none.
    """
    c, s = elementary.cos(view.pose.heading), elementary.sin(view.pose.heading)
    rest = view.obstacles - view.origin
    forward, left = c * rest[:, 0] + s * rest[:, 1], c * rest[:, 1] - s * rest[:, 0]
    halves = int(2.0 * ahead / SLICE) + 1
    half = np.floor(2.0 * forward / SLICE).astype(np.intp) + 1
    near = (half >= 0) & (half < halves)
    half, left = half[near], left[near]
    to_left, to_right = np.full(halves, np.inf), np.full(halves, -np.inf)
    beside = left > 0.0
    np.minimum.at(to_left, half[beside], left[beside])
    np.maximum.at(to_right, half[~beside], left[~beside])
    to_left = np.minimum(to_left[:-1], to_left[1:])
    to_right = np.maximum(to_right[:-1], to_right[1:])
    return float((to_left - to_right).min(initial=math.inf))
