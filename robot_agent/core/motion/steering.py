"""From a bearing to a twist: turn to it, drive in it, and drive around what is in the way of it.

Everything that moves a robot but for its two controllers, the leader's path tracking and the thesis's
polar law, asks here.
"""

import math

from onehop.contracts import elementary
from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import STANDSTILL, Twist
from onehop.contracts.sections import GainsSection, RobotSection
from robot_agent.core.motion.free_directions import LOOKAHEAD, FreeDirections

TURN_IN_PLACE = 1.2
"""A bearing greater than this is turned to on the spot [rad]: driving would gain an eighth at most."""

LOOK_ROUND = 0.4
"""Where no direction is free, the robot turns as to a bearing of this size [rad]: with the thesis's
k_alpha as fast as its body can."""

REACTION = 0.4
"""A robot drives at most as fast as lets it stop within this time before what it sees [s]."""

GAP = LOOKAHEAD / 3.0
"""Free distance that is enough to drive around something close [m]: two robots and a hand's breadth."""


class Steering:
    """Steers one robot; holds the free directions of its last look."""

    def __init__(self, body: RobotSection, gains: GainsSection, beams: Beams) -> None:
        self.free = FreeDirections(body, beams)
        self._k_alpha = gains.k_alpha
        self._max_rate = body.max_turn_rate

    def turn(self, bearing: float) -> Twist:
        """Turn on the spot towards a bearing [rad]."""
        return Twist(0.0, self._rate(bearing)) if bearing else STANDSTILL

    def drive(self, direction: float, speed: float) -> Twist:
        """Drive in a direction [rad], slower while it is still turned to, and not at all abeam.

        The speed [m/s] falls with the square of the cosine: once for the part of it that points there,
        and once more so that the robot turns before it drives.
        """
        facing = max(0.0, elementary.cos(direction))
        return Twist(speed * facing * facing, self._rate(direction))

    def around(self, scan: Ranges, bearing: float, speed: float, reaction: float = REACTION) -> Twist:
        """Towards a bearing [rad] through whatever gap there is, at `speed` [m/s] at most."""
        if abs(bearing) > TURN_IN_PLACE:
            return self.turn(bearing)
        self.free.look(scan)
        choice = self.free.choose(bearing, GAP)
        if choice is None:
            return self.turn(math.copysign(LOOK_ROUND, bearing))
        direction, free = choice
        return self.drive(direction, stoppable(speed, free, reaction))

    def _rate(self, bearing: float) -> float:
        """Turn rate towards a bearing [rad/s], within what the body can."""
        wanted = self._k_alpha * bearing
        return max(-self._max_rate, min(self._max_rate, wanted)) if bearing else 0.0


def stoppable(speed: float, free: float, reaction: float = REACTION) -> float:
    """The speed [m/s], or what lets a robot stop after `free` metres within its reaction time [s]."""
    return min(speed, max(0.0, free) / reaction)
