"""Obstacles that left the field of view a moment ago and are still near: a bounded memory.

A laser that looks 180 degrees ahead cannot turn around a corner without them.
"""

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from onehop.contracts.geometry import Pose
from robot_agent.core.planning.distances import squared_distances
from robot_agent.core.planning.view import NO_POINTS, View

CAPACITY = 256
"""Points remembered, 16 B each: all of an outline within reach at the spacing of a view."""

OVERLAP = 0.02
"""The edge of the field of view inside which a remembered point counts as hidden [rad]: rounding must
not lose it between the last beam and the memory."""

KEPT_BEYOND = 1.5
"""What is kept lies within this many reaches, so that it is there when the robot has come nearer."""


class RecentObstacles:
    """Points of the last view, at most `capacity`; asked for, those within `reach` of the robot [m]."""

    def __init__(self, reach: float, capacity: int = CAPACITY) -> None:
        self.reach = reach
        self.capacity = capacity
        self.points: FloatArray = NO_POINTS

    def hidden(self, pose: Pose, half_view: float) -> FloatArray:
        """The remembered points that the laser cannot see from `pose`, (n, 2) [m]."""
        dx, dy = self.points[:, 0] - pose.x, self.points[:, 1] - pose.y
        bearing = elementary.directions(dy, dx) - pose.heading
        out_of_view = elementary.cosines(bearing) < elementary.cos(half_view - OVERLAP)
        return self.points[out_of_view & (dx * dx + dy * dy < self.reach * self.reach)]

    def keep(self, view: View) -> None:
        """Remember the obstacles of this view that are near, the nearest first."""
        points = view.obstacles
        distance2 = squared_distances(view.origin[None], points)[0]
        farthest = KEPT_BEYOND * self.reach
        near = np.flatnonzero(distance2 < farthest * farthest)
        order = near[np.argsort(distance2[near], kind="stable")]
        self.points = points[order[: self.capacity]]
