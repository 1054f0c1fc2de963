"""The way that a leader came: where a column drives on it.

Differs: the thesis puts a column straight behind the leader; in a bend of a passage those slots lie
inside its walls. Here they lie on the leader's own way, which is known to be free.
"""

import math
from collections.abc import Sequence

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose, to_map


def behind(leader: Pose, trail: Sequence[tuple[float, float]], distance: float) -> Pose:
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
