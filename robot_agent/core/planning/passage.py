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
    width = math.inf
    for start in np.arange(-0.5 * SLICE, ahead - 0.5 * SLICE, 0.5 * SLICE):
        inside = left[(forward >= start) & (forward < start + SLICE)]
        to_left, to_right = inside[inside > 0.0], inside[inside <= 0.0]
        if len(to_left) and len(to_right):
            width = min(width, float(to_left.min() - to_right.max()))
    return width
