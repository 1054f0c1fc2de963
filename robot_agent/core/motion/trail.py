"""The way that a leader came: where a column drives on it, and which way the formation looks.

Differs: the thesis puts a column straight behind the leader; in a bend of a passage those slots lie
inside its walls. Here they lie on the leader's own way, which is known to be free.
Differs: the thesis turns the formation with the leader's heading, so that a leader that looks around in
a dead end swings slots through everyone's way, and one that turns back drives into its own column. Here
the formation looks along the trail, and loops are cut out of the trail: a leader that comes back along
its way pushes the team out backwards, the last robot first, and nobody has to pass anybody.
"""

import math
from collections.abc import Sequence

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose, to_map

Point = tuple[float, float]
"""A place in the map frame [m]."""

STEP, POINTS = 1.0, 24
"""Spacing [m] and number of the points that a leader remembers and tells: a column of sixteen, and less
than 500 bytes of the command."""

CAME_BACK = 1.2
"""A leader this near to an earlier point of its trail has come back to it [m]: a little over a step."""

BASE = 3.0
"""The course is the direction from the point of the trail that is this far behind [m]: long enough not
to swing with every step aside, short enough to be through a bend soon after the leader."""


class Trail:
    """The points of a leader's way, without its loops."""

    def __init__(self) -> None:
        self.points: list[Point] = []

    def mark(self, pose: Pose) -> None:
        """Take where the leader is now."""
        points, here = self.points, (pose.x, pose.y)
        for place in range(len(points) - 2):
            if math.dist(points[place], here) < CAME_BACK:
                del points[place + 1 :]
                break
        if not points or math.dist(points[-1], here) >= STEP:
            points.append(here)
            del points[:-POINTS]

    def course(self, pose: Pose) -> float:
        """Direction in which the formation looks [rad]: along the trail; the heading where it begins."""
        for x, y in reversed(self.points):
            if math.hypot(pose.x - x, pose.y - y) >= BASE:
                return elementary.atan2(pose.y - y, pose.x - x)
        return pose.heading


def behind(leader: Pose, trail: Sequence[Point], distance: float) -> Pose:
    """The pose `distance` [m] behind the leader along its way, heading along it.

    trail: points of the way, oldest first, map frame. Where the trail ends the way goes on straight.
    """
    x, y = leader.x, leader.y
    left = distance
    heading = leader.heading
    for px, py in reversed(trail):
        step = math.hypot(x - px, y - py)
        if step < 1e-6:
            continue
        heading = elementary.atan2(y - py, x - px)
        if step >= left:
            share = left / step
            return Pose(x + share * (px - x), y + share * (py - y), heading)
        left -= step
        x, y = px, py
    x, y = to_map(Pose(x, y, heading), -left, 0.0)
    return Pose(x, y, heading)
