"""Which point a follower heads for while it cannot get to its slot: the leader's trail, or back to it.

The newest point of the trail that is in sight. Where none is, the robot goes back along its own
breadcrumbs to where one last was: a slot can lie in a pocket on the other side of a wall, and the
nearest point of the trail behind that wall. Both ways are known to be free, the leader's because it
drove there, the robot's own because it did. The memory is bounded (MEMORY points of each); nearness to
the trail counts only for a robot that never saw any of it.
"""

import math
from collections.abc import Callable, Sequence

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose
from onehop.contracts.values import Value
from robot_agent.core.motion.frames import frame_of
from robot_agent.core.motion.free_directions import LOOKAHEAD, FreeDirections
from robot_agent.core.motion.timing import in_ticks
from robot_agent.core.motion.trail import Point

IN_SIGHT = 9.5
"""Points of the trail farther away than this are not looked for [m]: the laser ends at 10 m."""

REACHED = 0.7
"""A point of the trail is passed within this distance [m]: less than the spacing of the points."""

SPACING, MEMORY = 1.0, 128
"""Spacing of the breadcrumbs [m], and greatest number of points remembered of each way."""

AROUND_CORNER = 6.0
"""Time for which a point that slipped out of sight is still headed for before the robot goes back [s]:
rounding a corner hides it for a moment."""

ASTRAY = 5.0
"""So far from where the trail was in sight the robot goes back at once [m]."""


class TrailPoint(Value, frozen=True):
    """The point to head for, as the robot sees it [m, rad]. newest: of the trail. known: it is or was a
    moment ago in sight, so that the way to it is nearly straight."""

    distance: float
    bearing: float
    newest: bool
    known: bool


class TrailPursuit:
    """Remembers the leader's trail from where it was last in sight, and the robot's own way since."""

    def __init__(self, free: FreeDirections, period: float) -> None:
        """free: has looked at the scan of the tick before this is asked. period: of a tick [s]."""
        self._free = free
        self._around_corner = in_ticks(AROUND_CORNER, period)
        self._heard: Sequence[Point] = ()
        self._way: list[Point] = []
        self._breadcrumbs: list[Point] = []
        self._patience = self._around_corner

    def watch(self, pose: Pose, trail: Sequence[Point]) -> bool:
        """Remember the newest point in sight, or how to get back; whether one is in sight."""
        if trail is not self._heard:
            self._learn(trail)
        here, local = (pose.x, pose.y), frame_of(pose)
        for place in range(len(self._way) - 1, -1, -1):
            if self._in_sight(local(self._way[place])):
                del self._way[:place]
                self._breadcrumbs, self._patience = [here], self._around_corner
                return True
        away = [math.dist(here, crumb) for crumb in self._breadcrumbs]
        back = next((k for k, distance in enumerate(away) if distance < REACHED), None)
        if back is not None:
            del self._breadcrumbs[back + 1 :]
        elif away and away[-1] > SPACING:
            self._breadcrumbs.append(here)
            del self._breadcrumbs[:-MEMORY]
            if len(self._breadcrumbs) * SPACING > ASTRAY:
                self._patience = min(self._patience, 0)
        return False

    def point(self, pose: Pose, trail: Sequence[Point], ticks: int) -> TrailPoint | None:
        """Where to head for; None without a trail. ticks: that count since this was asked last."""
        in_sight, local = self.watch(pose, trail), frame_of(pose)
        here, way = (pose.x, pose.y), self._way
        if not way:
            return None
        self._patience = self._around_corner if in_sight else self._patience - ticks
        if len(self._breadcrumbs) == 1 and self._patience < 0:
            self._patience = self._around_corner
        if self._patience < 0 and self._breadcrumbs:
            return _trail_point(local(self._back(here, local)), newest=False, known=True)
        if not in_sight and not self._breadcrumbs:
            away = [math.dist(here, point) for point in way]
            del way[: away.index(min(away))]
        if not in_sight and len(way) > 1 and math.dist(way[0], here) < REACHED:
            del way[0]
        known = in_sight or bool(self._breadcrumbs)
        return _trail_point(local(way[0]), newest=len(way) == 1, known=known)

    def _back(self, here: Point, local: Callable[[Point], Point]) -> Point:
        """The farthest breadcrumb back that is in sight, or the next; it is not at the first one."""
        crumbs = self._breadcrumbs
        seen = (crumb for crumb in crumbs if self._in_sight(local(crumb)))
        ahead = (crumb for crumb in reversed(crumbs) if math.dist(here, crumb) >= REACHED)
        return next(seen, None) or next(ahead)

    def _learn(self, trail: Sequence[Point]) -> None:
        """Add what is new in the leader's trail; a trail that has nothing in common is another one.

        A leader that came back tells a trail without the piece that it drove twice (trail.py). It drove
        back along that piece, and so does who followed it there.
        """
        self._heard = trail
        way = self._way
        common = next((k for k in range(len(way) - 1, -1, -1) if way[k] in trail), None)
        if common is None:
            self._way, self._breadcrumbs = list(trail), []
            return
        newest = way[common]
        way += way[common : len(way) - 1][::-1]
        way += trail[trail.index(newest) + 1 :]
        del way[:-MEMORY]

    def _in_sight(self, point: Point) -> bool:
        """Whether the laser sees past a point in the robot's frame [m], and it could drive there."""
        x, y = point
        distance = math.hypot(x, y)
        if x < 0.0 or distance > IN_SIGHT:
            return False
        bearing = elementary.atan2(y, x)
        free = self._free.free_distance(bearing, tight=True)
        return free >= min(distance, LOOKAHEAD) and self._free.sees(bearing, distance)


def _trail_point(point: Point, newest: bool, known: bool) -> TrailPoint:
    """A point in the robot's frame [m] as what is headed for."""
    x, y = point
    return TrailPoint(math.hypot(x, y), elementary.atan2(y, x), newest, known)
