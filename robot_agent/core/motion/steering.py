"""Where a follower may drive: free directions in its scan, and the border of what is in its way.

Steering is the Vector Field Histogram in the masked form of VFH+ (Ulrich and Borenstein 1998) without
its grid: a candidate direction is free when a disc of the robot's size and a clearance can be pushed
along it for far enough, and the free one nearest to the wanted bearing is taken, with a preference for
the one taken before. Border following is that of DistBug (Kamon and Rivlin 1997): turn to one side, keep
the obstacle on the other, and leave it when the way to the target is free.

Other robots are obstacles like any other (thesis 3.1). Only the current scan is used.
"""

import math

import numpy as np
import numpy.typing as npt

from onehop.contracts import elementary
from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.sections import RobotSection

LOOKAHEAD = 2.5
"""Obstacles farther away than this do not steer [m]."""

CLEARANCES = (0.25, 0.08)
"""Wanted distance between hull and obstacle, and the least that is accepted in a tight place [m]."""

STEP = math.radians(6.0)
"""Spacing of the candidate directions [rad]."""

NEEDED = 1.2
"""A direction is free when it is for this far [m], or up to the target if that is nearer."""

TURN_AWAY = math.radians(12.0)
"""What is nearer than the accepted clearance blocks a right angle and this much more to both sides
[rad]: the robot then draws away from it. Driving straight along it would leave it as near as it is."""

INERTIA = 0.25
"""Cost of leaving the direction taken before, relative to that of leaving the bearing."""

SIGHT_TOLERANCE = 0.3
"""A hit this little before a point does not hide it [m]: the bundle's beams are not all on it."""

BUNDLE = 3
"""Neighbouring beams taken as one."""

TOO_NEAR = 2.0
"""Stands for R / r >= 1: greater than any sine."""

FloatArray = npt.NDArray[np.float64]


class Steering:
    """Free directions of one scan. `look` first, then ask.

    An obstacle at range r keeps a disc of radius R from every direction nearer to it than asin(R / r),
    and stops it there after r - R. That is exact in the middle and cautious at the edges. Beams are
    taken three at a time, the nearest of them, because this runs at every tick. Sines are compared
    instead of angles: an arcsine has another last place on another processor.
    """

    def __init__(self, body: RobotSection, fan: Beams) -> None:
        self._radii = tuple(body.radius + clearance for clearance in CLEARANCES)
        bundles = max(1, len(fan.angles) // BUNDLE)
        self._beams = bundles * BUNDLE
        self._angles: FloatArray = fan.angles[: self._beams].reshape(bundles, BUNDLE).mean(axis=1)
        half = math.radians(min(body.laser_fov_deg, 180.0)) / 2.0
        self.candidates: FloatArray = np.arange(-half, half + 1e-9, STEP)
        apart: FloatArray = np.abs(self._angles[None, :] - self.candidates[:, None])
        self._apart = _as_sines(apart, elementary.sines(apart.ravel()).reshape(apart.shape))
        self._cosines, self._sines = elementary.cosines(self._angles), elementary.sines(self._angles)
        self._ranges: FloatArray = np.full(bundles, LOOKAHEAD)
        self._near: Ranges = np.full(bundles, np.inf, np.float32)
        self._spacing = float(self._angles[1] - self._angles[0]) if bundles > 1 else math.pi
        self._shadows: list[tuple[FloatArray, FloatArray] | None] = [None, None]
        self._chosen = 0.0

    def look(self, scan: Ranges) -> None:
        """Take the scan of this tick."""
        near = np.minimum(scan[0 : self._beams : BUNDLE], scan[1 : self._beams : BUNDLE])
        near = np.minimum(near, scan[2 : self._beams : BUNDLE])
        self._near = near
        self._ranges = np.minimum(near, 2.0 * LOOKAHEAD, dtype=np.float64)
        self._shadows = [None, None]

    def _shadow(self, tight: bool) -> tuple[FloatArray, FloatArray]:
        """For each bundle of beams the sine of half of what it blocks, and after how far [m]."""
        shadow = self._shadows[tight]
        if shadow is None:
            radius = self._radii[tight]
            ratio = radius / self._ranges
            ratio[ratio >= 1.0] = TOO_NEAR
            shadow = self._shadows[tight] = ratio, self._ranges - radius
        return shadow

    def free_distance(self, bearing: float, tight: bool = False) -> float:
        """How far the robot could drive along a bearing [m], at most LOOKAHEAD."""
        ratios, depths = self._shadow(tight)
        c, s = elementary.cos(bearing), elementary.sin(bearing)
        sines = np.abs(self._sines * c - self._cosines * s)
        in_way = _as_sines(np.abs(self._angles - bearing), sines) < ratios
        return float(depths.min(where=in_way, initial=LOOKAHEAD))

    def sees(self, bearing: float, distance: float) -> bool:
        """Whether the laser looks past a point at this bearing and distance [rad, m]."""
        place = (bearing - float(self._angles[0])) / self._spacing
        low = max(0, math.floor(place))
        beams = self._near[low : low + 2]
        return bool(beams.size) and float(beams.min()) > distance - SIGHT_TOLERANCE

    def choose(self, bearing: float, distance: float, side: int) -> tuple[float, float] | None:
        """Direction to drive in and how far it is free [rad, m]; None when every direction is blocked.

        bearing, distance: of the target. side: 0 to take the free direction nearest to the bearing; +1
        to keep an obstacle on the right and pass it on the left, -1 the other way round.
        """
        need = min(NEEDED, distance)
        for tight in (False, True):
            ratios, depths = self._shadow(tight)
            free = np.where(self._apart < ratios, depths, LOOKAHEAD).min(axis=1)
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


def _as_sines(apart: FloatArray, sines: FloatArray) -> FloatArray:
    """Angles between directions and beams [rad] in an order that compares with R / r.

    sines: theirs. Beyond a right angle only what is too near blocks, and beyond TURN_AWAY nothing does.
    """
    beyond = np.where(apart < 0.5 * math.pi + TURN_AWAY, 1.0, np.inf)
    return np.where(apart < 0.5 * math.pi, sines, beyond)
