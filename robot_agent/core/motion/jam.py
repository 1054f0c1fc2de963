"""Getting out of jams: robots that block each other.

A follower that gets nowhere drives to some side for a random while: robots that all follow the same
rules stay blocked, and chance breaks the symmetry. A leader that gets nowhere among its followers steers
around them towards where it is going.
"""

import math
from collections.abc import Sequence

from onehop.contracts import elementary
from onehop.contracts.arrays import Ranges
from onehop.contracts.geometry import Pose, Twist, wrap_angle
from onehop.contracts.sections import RobotSection
from robot_agent.core.motion.steering import GAP, TURN_IN_PLACE, Steering, stoppable
from robot_agent.core.motion.timing import in_ticks
from robot_agent.core.motion.trail import Point

STUCK_AFTER = 2.0
"""Time without getting anywhere after which a robot is stuck [s]: others clear most jams before. What
the longest turn on the spot takes comes on top: it is no jam."""

LEAST_SPEED = 0.04
"""A robot that is slower gets nowhere [m/s]: the safety filter holds it, or it only turns."""

RECOVERY = 2
"""Driving makes up for getting nowhere this many times faster."""

ESCAPE_LEAST, ESCAPE_MOST = 0.5, 2.5
"""An escape lasts for a random time between these [s]: 0.3 to 1.5 m of way, a robot or four."""

ESCAPE_BEARING = 1.2
"""Bearing to which it looks for a way out, on either side [rad]."""

ESCAPE_SPEED = 0.6
"""Speed of an escape, at most [m/s]: slow, because the others may be escaping too."""

TURN_SHARE = 0.6
"""Share of the greatest turn rate at which a robot turns where no direction is free: less than all of
it, so as not to turn past a gap that opens."""

LEADER_STUCK_AFTER, UNJAM_FOR = 1.5, 1.5
"""Time without getting anywhere after which a leader steers around followers, and for how long [s]."""

LEADER_STAYS = 0.15
"""A leader that moves less than this is getting nowhere [m]: it turns on the spot in between."""

JAM_REACH = 1.0
"""Something must be this near to be what jams a leader [m]: two robots and half a metre."""

LEADER_REACTION = 1.0
"""Among its followers a leader drives as slowly as lets it stop within this time [s]: they move too."""


class FollowerJam:
    """Counts for how long a robot has been getting nowhere, and drives it out of there."""

    def __init__(
        self, body: RobotSection, steering: Steering, period: float, draws: Sequence[float]
    ) -> None:
        """period: of a tick [s]. draws: random shares in [0, 1), used in turn."""
        self._steering = steering
        self._period = period
        self._turn_rate = TURN_SHARE * body.max_turn_rate
        self._draws = draws
        self._drawn = 0
        longest_turn = (math.pi - TURN_IN_PLACE) / body.max_turn_rate
        self._stuck_after = in_ticks(STUCK_AFTER + longest_turn, period)
        self._stuck_for = 0
        self._escape = 0
        self._side = 1
        self._last: tuple[Point, int] | None = None

    @property
    def escaping(self) -> bool:
        """Whether an escape is under way."""
        return self._escape > 0

    def clear(self) -> None:
        """The robot is not to get anywhere, or nothing is in its way any more."""
        self._stuck_for, self._last = 0, None

    def reset(self) -> None:
        """Forget the jam and the escape from it."""
        self.clear()
        self._escape = 0

    def moved(self, here: Point, tick: int) -> None:
        """Take where the robot is at this tick: has it got anywhere since the last time?"""
        if self._last is not None:
            there, before = self._last
            ticks = tick - before
            if math.dist(here, there) < LEAST_SPEED * (ticks * self._period):
                self._getting_nowhere(ticks)
            else:
                self._stuck_for = max(0, self._stuck_for - RECOVERY * ticks)
        self._last = here, tick

    def turned(self) -> Twist:
        """No direction is free: turn until one is."""
        return Twist(0.0, self._side * self._turn_rate)

    def escape(self) -> Twist:
        """Towards the side that chance chose, wherever there is room."""
        self._escape, self._last = self._escape - 1, None
        choice = self._steering.free.choose(self._side * ESCAPE_BEARING, GAP)
        if choice is None:
            return self.turned()
        direction, free = choice
        return self._steering.drive(direction, stoppable(ESCAPE_SPEED, free))

    def _getting_nowhere(self, ticks: int) -> None:
        self._stuck_for += ticks
        if self._stuck_for >= self._stuck_after:
            share = self._draws[self._drawn % len(self._draws)]
            self._drawn += 1
            spread = (ESCAPE_MOST - ESCAPE_LEAST) / self._period
            self._escape = in_ticks(ESCAPE_LEAST, self._period) + int(spread * share)
            self._side = 1 if share < 0.5 else -1
            self._stuck_for = 0


class LeaderJam:
    """Notices that a leader is jammed among its followers, and steers it around them."""

    def __init__(self, body: RobotSection, steering: Steering, period: float) -> None:
        """period: of a tick [s]."""
        self._speed = body.leader_speed
        self._steering = steering
        self._period = period
        self._stands_at: Point = (0.0, 0.0)
        self.begin()

    def begin(self) -> None:
        """Another leadership: no jam yet."""
        self._stands_for = self._unjam_for = 0.0

    def around(self, pose: Pose, scan: Ranges, nearest: float, waypoint: Point) -> Twist | None:
        """The twist that leads out of a jam; None while there is none. Once a tick.

        nearest: least range in scan [m]. waypoint: where the leader is driving to, map frame [m].
        """
        if not self._jammed(pose, nearest):
            return None
        x, y = waypoint
        bearing = wrap_angle(elementary.atan2(y - pose.y, x - pose.x) - pose.heading)
        return self._steering.around(scan, bearing, self._speed, LEADER_REACTION)

    def _jammed(self, pose: Pose, nearest: float) -> bool:
        """Whether the leader stands among its followers for too long, or is still on its way out."""
        if self._unjam_for > 0.0:
            self._unjam_for -= self._period
            return True
        here = (pose.x, pose.y)
        if math.dist(self._stands_at, here) > LEADER_STAYS or nearest > JAM_REACH:
            self._stands_at, self._stands_for = here, 0.0
            return False
        self._stands_for += self._period
        if self._stands_for < LEADER_STUCK_AFTER:
            return False
        self._stands_for, self._unjam_for = 0.0, UNJAM_FOR
        return True
