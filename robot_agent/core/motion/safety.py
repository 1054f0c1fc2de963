"""The last word on every twist: no robot drives into what its laser sees.

At a tick a robot may close at most half of the gap that it sees above a margin. The other half belongs
to whoever may be coming the other way: if both keep the rule, the gap never falls below the margin,
whatever either of them wants. Twists change at once in this world, so no braking distance is needed.

The laser looks ahead only. That suffices because a robot that passes this filter never backs up, whoever
asks for it: driving forward takes it away from all that is behind it, turning on the spot does not move
a disc, and whoever is behind sees it and keeps the rule. Driving backwards (thesis eq. 3.10) is a choice
of the scenario for followers (gains.reverse), and unprotected.

Source of the half: reciprocal collision avoidance (van den Berg et al., 2008), here on distances.
"""

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Twist
from onehop.contracts.sections import RobotSection

MARGIN = 0.05
"""Gap that is never closed [m]: covers thin corners between two beams and the arc's bow in a tick."""


class SafetyFilter:
    """Shortens the commanded arc of one tick where the scan demands it."""

    def __init__(self, body: RobotSection, beams: Beams, period: float) -> None:
        """period: length of a tick [s]."""
        self._radius = body.radius
        self._period = period
        self._directions = beams.directions
        top = max(body.max_speed, body.leader_speed)
        self.reach = body.radius + MARGIN + 2.0 * top * period
        """Nothing farther away than this can limit a tick [m]."""

    def filtered(self, twist: Twist, scan: Ranges, nearest: float, blind: bool = False) -> Twist:
        """The same twist, or a slower one of the same turn rate. nearest: least range in scan [m].

        blind: this robot may back up without looking.
        """
        if twist.v < 0.0:
            return twist if blind else Twist(0.0, twist.w)
        if nearest > self.reach:
            return twist
        near = np.flatnonzero(scan < self.reach)
        ranges = scan[near].astype(np.float64)
        chord = 0.5 * twist.w * self._period
        along, across = self._directions[near].T
        ahead = ranges * (along * elementary.cos(chord) + across * elementary.sin(chord))
        gap = ranges - self._radius
        keep = np.where(gap > MARGIN, self._radius + 0.5 * (gap + MARGIN), ranges)
        beside_squared = ranges * ranges - ahead * ahead
        reached = (ahead > 0.0) & (beside_squared < keep * keep)
        if not reached.any():
            return twist
        keep, beside_squared = keep[reached], beside_squared[reached]
        free = ahead[reached] - np.sqrt(keep * keep - beside_squared)
        v = min(twist.v, max(0.0, float(free.min())) / self._period)
        return Twist(v, twist.w)
