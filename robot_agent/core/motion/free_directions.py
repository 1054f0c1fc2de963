"""Where a robot may drive: the free directions of one scan.

The Vector Field Histogram in the masked form of VFH+ (Ulrich and Borenstein 1998) without its grid: a
candidate direction is free when a disc of the robot's size and a clearance can be pushed along it for
far enough, and the free one nearest to the wanted bearing is taken, with a preference for the one taken
before. To follow a border, as in DistBug (Kamon and Rivlin 1997), the free direction closest to the
obstacle on one side is taken instead.

Other robots are obstacles like any other (thesis 3.1). Only the current scan is used.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray, Ranges
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

    An obstacle at range r keeps a disc of radius R from every direction nearer to it than asin(R / r),
    and stops it there after r - R. That is exact in the middle and cautious at the edges. Angles are
    compared by their cosines, which are the same on every processor.
    """

    def __init__(self, body: RobotSection, beams: Beams) -> None:
        self._radii = tuple(body.radius + clearance for clearance in CLEARANCES)
        self._bundle = min(beams.spanned(BUNDLE), len(beams.angles))
        bundles = len(beams.angles) // self._bundle
        self._beams = bundles * self._bundle
        self._angles: FloatArray = (
            beams.angles[: self._beams].reshape(bundles, self._bundle).mean(axis=1)
        )
        self._spacing = float(self._angles[1] - self._angles[0]) if bundles > 1 else math.pi
        half = math.radians(min(body.laser_fov_deg, 180.0)) / 2.0
        self.candidates: FloatArray = np.arange(-half, half + 1e-9, STEP)
        self._ahead, self._left = elementary.cosines(self._angles), elementary.sines(self._angles)
        self._facing: FloatArray = np.array([self._cosines(float(c)) for c in self.candidates])
        self._behind = -elementary.sin(TURN_AWAY)
        self._offsets = [slice(first, self._beams, self._bundle) for first in range(self._bundle)]
        self._ranges: FloatArray = np.full(bundles, LOOKAHEAD)
        self._near: Ranges = np.full(bundles, np.inf, np.float32)
        self._shadows: list[tuple[FloatArray, FloatArray] | None] = [None, None]
        self._chosen = 0.0

    def look(self, scan: Ranges) -> None:
        """Take the scan of this tick."""
        near = scan[self._offsets[0]]
        for offset in self._offsets[1:]:
            near = np.minimum(near, scan[offset])
        self._near = near
        self._ranges = np.minimum(near, 2.0 * LOOKAHEAD, dtype=np.float64)
        self._shadows = [None, None]

    def _cosines(self, bearing: float) -> FloatArray:
        """Cosines of the angles between a bearing and the bundles of beams."""
        return elementary.cos(bearing) * self._ahead + elementary.sin(bearing) * self._left

    def _shadow(self, tight: bool) -> tuple[FloatArray, FloatArray]:
        """For each bundle of beams the cosine of half of what it blocks, and after how far [m]."""
        shadow = self._shadows[tight]
        if shadow is None:
            radius = self._radii[tight]
            ratio = radius / self._ranges
            squared = 1.0 - ratio * ratio
            widths = np.where(squared > 0.0, np.sqrt(np.maximum(squared, 0.0)), self._behind)
            shadow = self._shadows[tight] = widths, self._ranges - radius
        return shadow

    def free_distance(self, bearing: float, tight: bool = False) -> float:
        """How far the robot could drive along a bearing [m], at most LOOKAHEAD."""
        widths, depths = self._shadow(tight)
        in_way = self._cosines(bearing) > widths
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
            free = np.where(self._facing > widths, depths, LOOKAHEAD).min(axis=1)
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
