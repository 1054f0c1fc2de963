"""Where a robot may drive: the free directions of one scan.

The Vector Field Histogram in the masked form of VFH+ (Ulrich and Borenstein 1998) without its grid: a
candidate direction is free when a disc of the robot's size and a clearance can be pushed along it for
far enough, and the free one nearest to the wanted bearing is taken, with a preference for the one taken
before. To follow a border, as in DistBug (Kamon and Rivlin 1997), the free direction closest to the
obstacle on one side is taken instead.

Other robots are obstacles like any other (thesis 3.1). Only the current scan is used.
"""

import math
from functools import reduce

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.sections import RobotSection

LOOKAHEAD = 2.5
"""Obstacles farther away than this do not matter yet [m]: at 3 m/s, 0.8 s before they are reached."""

CLEARANCES = (0.25, 0.08)
"""Wanted distance between hull and obstacle, and the least that is accepted in a tight place [m]."""

STEP = math.radians(6.0)
"""Spacing of the candidate directions [rad]: half of what a disc covers at LOOKAHEAD."""

NEEDED = 1.2
"""A direction is free when it is for this far [m], or up to the target if that is nearer."""

TURN_AWAY = math.radians(12.0)
"""What is nearer than the accepted clearance blocks a right angle and this much more to both sides
[rad]: the robot then draws away from it. Driving straight along it would leave it as near as it is."""

INERTIA = 0.25
"""Cost of leaving the direction taken before, relative to that of leaving the bearing."""

SIGHT_TOLERANCE = 0.3
"""A hit this little before a point does not hide it [m]: the bundle's beams are not all on it."""

BUNDLE = math.radians(3.0)
"""Neighbouring beams up to this angle are taken as one, the nearest of them [rad]: a third of what a
disc covers at LOOKAHEAD, and this runs at every tick."""


class FreeDirections:
    """Free directions of one scan. `look` first, then ask.

    An obstacle at range r blocks every direction that passes nearer to it than a disc's radius R, and
    stops the disc there after r - R. That is exact in the middle and cautious at the edges. With `apart`
    the angle between obstacle and direction, it is in the way when r sin(apart) < R.
    """

    def __init__(self, body: RobotSection, beams: Beams) -> None:
        self._radii = tuple(body.radius + clearance for clearance in CLEARANCES)
        self._bundle = max(1, round(BUNDLE / beams.spacing))
        bundles = max(1, len(beams.angles) // self._bundle)
        self._beams = bundles * self._bundle
        self._angles: FloatArray = (
            beams.angles[: self._beams].reshape(bundles, self._bundle).mean(axis=1)
        )
        self._ahead, self._left = elementary.cosines(self._angles), elementary.sines(self._angles)
        self._spacing = float(self._angles[1] - self._angles[0]) if bundles > 1 else math.pi
        half = math.radians(min(body.laser_fov_deg, 180.0)) / 2.0
        self.candidates: FloatArray = np.arange(-half, half + 1e-9, STEP)
        self._apart: FloatArray = np.array([self._apart_from(float(c)) for c in self.candidates])
        self._too_near = 1.0 + elementary.sin(TURN_AWAY)
        self._ranges: FloatArray = np.full(bundles, LOOKAHEAD)
        self._near: Ranges = np.full(bundles, np.inf, np.float32)
        self._shadows: list[tuple[FloatArray, FloatArray] | None] = [None, None]
        self._chosen = 0.0

    def look(self, scan: Ranges) -> None:
        """Take the scan of this tick."""
        every = (scan[first : self._beams : self._bundle] for first in range(self._bundle))
        self._near = reduce(np.minimum, every)
        self._ranges = np.minimum(self._near, 2.0 * LOOKAHEAD, dtype=np.float64)
        self._shadows = [None, None]

    def _apart_from(self, bearing: float) -> FloatArray:
        """How far each bundle points from a bearing, (bundles,): the sine of the angle between them,
        and beyond a right angle one more than its cosine lies below 0, so that it still rises.
        """
        c, s = elementary.cos(bearing), elementary.sin(bearing)
        along = c * self._ahead + s * self._left
        beside = np.abs(c * self._left - s * self._ahead)
        return np.where(along > 0.0, beside, 1.0 - along)

    def _shadow(self, tight: bool) -> tuple[FloatArray, FloatArray]:
        """For each bundle how far apart it blocks (see `_apart_from`), and after what distance [m]."""
        shadow = self._shadows[tight]
        if shadow is None:
            radius = self._radii[tight]
            ratio = radius / self._ranges
            widths = np.where(ratio < 1.0, ratio, self._too_near)
            shadow = self._shadows[tight] = widths, self._ranges - radius
        return shadow

    def free_distance(self, bearing: float, tight: bool = False) -> float:
        """How far the robot could drive along a bearing [m], at most LOOKAHEAD."""
        widths, depths = self._shadow(tight)
        in_way: BoolArray = self._apart_from(bearing) < widths
        return float(depths.min(where=in_way, initial=LOOKAHEAD))

    def sees(self, bearing: float, distance: float) -> bool:
        """Whether the laser looks past a point at this bearing and distance [rad, m]."""
        place = (bearing - float(self._angles[0])) / self._spacing
        low = max(0, math.floor(place))
        around = self._near[low : low + 2]
        return bool(around.size) and float(around.min()) > distance - SIGHT_TOLERANCE

    def choose(self, bearing: float, distance: float, side: int = 0) -> tuple[float, float] | None:
        """Direction to drive in and how far it is free [rad, m]; None when every direction is blocked.

        bearing, distance: of the target. side: 0 to take the free direction nearest to the bearing; +1
        to keep an obstacle on the right and pass it on the left, -1 the other way round.
        """
        need = min(NEEDED, distance)
        for tight in (False, True):
            widths, depths = self._shadow(tight)
            free = np.where(self._apart < widths, depths, LOOKAHEAD).min(axis=1)
            ok = free >= need
            if not ok.any():
                continue
            if side == 0:
                change = np.abs(self.candidates - self._chosen)
                cost = np.abs(self.candidates - bearing) + INERTIA * change
                best = int(np.where(ok, cost, np.inf).argmin())
            else:
                order = np.flatnonzero(ok)
                best = int(order[0] if side > 0 else order[-1])
            self._chosen = float(self.candidates[best])
            return self._chosen, float(free[best])
        return None
