"""Which point a follower heads for while it cannot get to its slot: the leader's trail, or back to it.

The newest point of the trail that is in sight. Where none is, the robot goes back the way it came, to
where one last was: a slot can lie in a pocket on the other side of a wall, and the nearest point of the
trail behind that wall. Both ways are known to be free, the leader's because it drove there, the robot's
own because it did. The memory is bounded (MEMORY points of each); nearness to the trail counts only for
a robot that never saw any of it.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose, to_local
from robot_agent.core.motion.steering import LOOKAHEAD, Steering

IN_SIGHT = 9.5
"""Points of the trail farther away than this are not looked for [m]: the laser ends at 10 m."""

REACHED = 0.7
"""A point of the trail is passed within this distance [m]."""

CRUMB_STEP, MEMORY = 1.0, 128
"""Spacing [m] and greatest number of the remembered points of each way."""

ADVANCE = 60
"""Decisions for which a point that slipped out of sight is still headed for before the robot goes back:
rounding a corner hides it for a moment."""

FAR_CRUMBS = 5
"""So many metres from where the trail was in sight the robot goes back at once."""

Point = tuple[float, float]


class Aim(NamedTuple):
    """The point to head for, as the robot sees it [m, rad]. last: the newest
    of the trail. known: it is or was a moment ago in sight, so that the way to it is nearly straight."""

    distance: float
    bearing: float
    last: bool
    known: bool


class Pursuit:
    """Remembers the leader's trail from where it was last in sight, and the robot's own way since."""

    def __init__(self, steering: Steering) -> None:
        """steering: has looked at the scan of the tick before this is asked."""
        self._steering = steering
        self._told: Sequence[Point] = ()
        self._way: list[Point] = []
        self._crumbs: list[Point] = []
        self._patience = ADVANCE

    def watch(self, pose: Pose, trail: Sequence[Point]) -> bool:
        """Remember the newest point in sight, or how to get back; whether one is in sight."""
        if trail is not self._told:
            self._learn(trail)
        here = (pose.x, pose.y)
        for place in range(len(self._way) - 1, -1, -1):
            if self._in_sight(pose, self._way[place]):
                del self._way[:place]
                self._crumbs, self._patience = [here], ADVANCE
                return True
        away = [math.dist(here, crumb) for crumb in self._crumbs]
        back = next((k for k, distance in enumerate(away) if distance < REACHED), None)
        if back is not None:
            del self._crumbs[back + 1 :]
        elif away and away[-1] > CRUMB_STEP:
            self._crumbs.append(here)
            del self._crumbs[:-MEMORY]
            if len(self._crumbs) > FAR_CRUMBS:
                self._patience = min(self._patience, 0)
        return False

    def aim(self, pose: Pose, trail: Sequence[Point]) -> Aim | None:
        """Where to head for; None without a trail."""
        in_sight = self.watch(pose, trail)
        way = self._way
        if not way:
            return None
        self._patience = ADVANCE if in_sight else self._patience - 1
        if len(self._crumbs) == 1 and self._patience < 0:
            self._patience = ADVANCE
        if self._patience < 0 and self._crumbs:
            seen = (crumb for crumb in self._crumbs if self._in_sight(pose, crumb))
            return self._aimed(pose, next(seen, self._crumbs[-1]), False, True)
        if not in_sight and not self._crumbs:
            away = [math.dist((pose.x, pose.y), point) for point in way]
            del way[: away.index(min(away))]
        if not in_sight and len(way) > 1 and math.dist(way[0], (pose.x, pose.y)) < REACHED:
            del way[0]
        return self._aimed(pose, way[0], len(way) == 1, in_sight or bool(self._crumbs))

    def _learn(self, trail: Sequence[Point]) -> None:
        """Add what is new in the leader's trail; a trail that has nothing in common is another one.

        A leader that came back tells a trail without the piece that it drove twice (trail.py). It drove
        back along that piece, and so does who followed it there.
        """
        self._told = trail
        way = self._way
        common = next((k for k in range(len(way) - 1, -1, -1) if way[k] in trail), None)
        if common is None:
            self._way, self._crumbs = list(trail), []
            return
        newest = way[common]
        way += way[common : len(way) - 1][::-1]
        way += trail[trail.index(newest) + 1 :]
        del way[:-MEMORY]

    def _in_sight(self, pose: Pose, point: Point) -> bool:
        x, y = to_local(pose, *point)
        distance = math.hypot(x, y)
        if x < 0.0 or distance > IN_SIGHT:
            return False
        bearing = elementary.atan2(y, x)
        free = self._steering.free_distance(bearing, tight=True)
        return free >= min(distance, LOOKAHEAD) and self._steering.sees(bearing, distance)

    def _aimed(self, pose: Pose, point: Point, last: bool, known: bool) -> Aim:
        x, y = to_local(pose, *point)
        return Aim(math.hypot(x, y), elementary.atan2(y, x), last, known)
