"""Which point of the leader's trail a follower heads for while it cannot get to its slot.

The newest one in sight. Where none is, the way back to where one was last in sight, and from there along
the trail from point to point: the leader came through there. A point that is merely near may lie on the
other side of a wall, so nearness counts only for a robot that never saw any.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from onehop.contracts.geometry import Pose, to_local
from robot_agent.core.steering import LOOKAHEAD, Steering

IN_SIGHT = 9.5
"""Points of the trail farther away than this are not looked for [m]: the laser ends at 10 m."""

REACHED = 0.7
"""A point of the trail is passed within this distance [m]."""

Point = tuple[float, float]


class Aim(NamedTuple):
    """A point of the trail as the robot sees it [m, rad]. last: it is the newest of the trail."""

    distance: float
    bearing: float
    last: bool
    in_sight: bool


class Pursuit:
    """Remembers the last point of the trail that was in sight."""

    def __init__(self, steering: Steering) -> None:
        """steering: has looked at the scan of the tick before this is asked."""
        self._steering = steering
        self._anchor: Point | None = None

    def watch(self, pose: Pose, trail: Sequence[Point]) -> bool:
        """Remember the newest point in sight; whether there is one."""
        for point in reversed(trail):
            x, y = to_local(pose, *point)
            distance = math.hypot(x, y)
            if x < 0.0 or distance > IN_SIGHT:
                continue
            bearing = math.atan2(y, x)
            free = self._steering.free_distance(bearing, tight=True)
            if free >= min(distance, LOOKAHEAD) and self._steering.sees(bearing, distance):
                self._anchor = point
                return True
        return False

    def aim(self, pose: Pose, trail: Sequence[Point]) -> Aim | None:
        """Where to head for; None without a trail."""
        if not trail:
            self._anchor = None
            return None
        in_sight = self.watch(pose, trail)
        place = self._place(pose, trail)
        if not in_sight:
            x, y = trail[place]
            if math.hypot(x - pose.x, y - pose.y) < REACHED and place < len(trail) - 1:
                place += 1
            self._anchor = trail[place]
        x, y = to_local(pose, *trail[place])
        return Aim(math.hypot(x, y), math.atan2(y, x), place == len(trail) - 1, in_sight)

    def _place(self, pose: Pose, trail: Sequence[Point]) -> int:
        """Index of the remembered point; the oldest if it is gone, the nearest if there is none."""
        if self._anchor is None:
            away = [math.hypot(x - pose.x, y - pose.y) for x, y in trail]
            return away.index(min(away))
        try:
            return trail.index(self._anchor)
        except ValueError:
            return 0
