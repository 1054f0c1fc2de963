"""When a robot looks and plans anew, and whether what it planned before got it anywhere."""

import math

from onehop.contracts.geometry import Pose, wrap_angle
from robot_agent.core.planning.path_tracking import PathTracker

DRIVEN = 3.0
"""Distance from the last planning moment, in inflations: 1.5 m, well within the 5 m in which a
laser of one degree sees every corner that a way must keep clear of."""

TURNED = math.pi / 4.0
"""Turn since the last planning moment [rad]: a quarter of the view is new."""

FACED = 0.1
"""A heading to turn to is reached within this [rad]."""

ENDED = 0.1
"""A way is at its end within this [m]."""

BLOCKED_S = 0.2
"""Time for which the tracker may be blocked [s]: what only brushed past is gone by then, and little time
is lost to a wall that appeared late."""

WAITED_S = 8.0
"""Time after which the robot plans anew whatever it does [s]: a team may make its leader wait."""

STILL_WITHIN = 0.2
"""Who has moved less than this since the last planning moment did not get anywhere, in inflations."""


class Replanning:
    """Planning moments of one robot. last: pose at the last one. stuck: how many in a row began with the
    tracker blocked where it was at the one before.
    """

    def __init__(self, inflation: float, period_ns: int) -> None:
        self.inflation = inflation
        self.period_ns = period_ns
        self.last: Pose | None = None
        self.stuck = 0
        self._waited_ns = 0

    def due(self, pose: Pose, tracker: PathTracker) -> bool:
        """Is it time to plan anew? Ask once a tick."""
        self._waited_ns += self.period_ns
        last = self.last
        if last is None or tracker.blocked_ns >= BLOCKED_S * 1e9 or self._waited_ns > WAITED_S * 1e9:
            return True
        if tracker.faces(pose, FACED) or tracker.ended(pose, ENDED):
            return True
        moved = math.dist((pose.x, pose.y), (last.x, last.y))
        turned = abs(wrap_angle(pose.heading - last.heading))
        return moved >= DRIVEN * self.inflation or turned > TURNED

    def begin(self, pose: Pose, tracker: PathTracker) -> float:
        """A planning moment begins; the distance from the last one, 0 at the first [m]."""
        moved = 0.0 if self.last is None else math.dist((pose.x, pose.y), (self.last.x, self.last.y))
        still = tracker.blocked_ns > 0 and moved < STILL_WITHIN * self.inflation
        self.stuck = self.stuck + 1 if still else 0
        self.last, self._waited_ns = pose, 0
        return moved
