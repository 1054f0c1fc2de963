"""What one scan shows: points that were hit, what is visible, and how much room is left around a way.

Works in the map frame. Beside the beams it holds `hidden`: points that left the field of view a moment
ago and still lie beside or behind the robot (`RecentObstacles`).
"""

import math
from functools import cached_property

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose
from robot_agent.core.planning.distances import (
    Float32Array,
    squared_distances,
    squared_segment_distances,
)
from robot_agent.core.planning.outline import outline

NO_POINTS: FloatArray = np.empty((0, 2))

SLACK = np.float32(0.01)
"""How much nearer than now a robot inside an inflated obstacle may come to it [m]: more than a thinned
outline and single precision take away, or it could not even move along it."""

SEEN_NEARBY = 4.0
"""A place within this many margins of the robot was in view a moment ago, whatever its bearing."""

ON_A_BEAM = 1e-6
"""Share of a spacing by which a place may miss a beam and still lie on it."""

OUTLINE_END = math.radians(6.0)
"""An open beam within this angle of one that hit something is beside an outline that leaves the laser's
range [rad]: 1 m at 10 m, what a robot needs to pass."""


class View:
    """One scan seen from one pose.

    sight: (n_beams,) float64 [m], free range along each beam, laser range where nothing returned.
    solid: (n_beams,) whether something returned. obstacles: (n, 2) float64 [m], the outline of what the
    beams hit, with a point for each `grain` [m] of it, and `hidden`. A clearance c is wrong by at most
    grain^2 / (8 c).
    """

    def __init__(
        self, beams: Beams, pose: Pose, scan: Ranges, grain: float, hidden: FloatArray = NO_POINTS
    ) -> None:
        self.beams = beams
        self.pose = pose
        self.origin: FloatArray = np.array((pose.x, pose.y))
        seen = np.isfinite(scan)
        self.sight: FloatArray = np.where(seen, scan, beams.range).astype(np.float64)
        self.solid: BoolArray = seen
        c, s = elementary.cos(pose.heading), elementary.sin(pose.heading)
        d = beams.directions
        self.directions: FloatArray = np.column_stack(
            (c * d[:, 0] - s * d[:, 1], s * d[:, 0] + c * d[:, 1])
        )
        hits = self.origin + self.directions[seen] * self.sight[seen, None]
        self.obstacles: FloatArray = np.concatenate((outline(hits, grain, beams.spacing), hidden))
        self._shown_to = _shown_to(self.sight)
        have = np.sqrt(squared_distances(self.origin[None], self.obstacles)[0])
        kept = np.maximum(have - SLACK, np.float32(0.0))
        self._kept2 = kept * kept

    def polar(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Bearing [rad, relative to the heading, in (-pi, pi]] and distance [m] of (n, 2) points."""
        ahead, left = self.local(points)
        return elementary.directions(left, ahead), elementary.lengths(ahead, left)

    def local(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """How far (n, 2) points lie ahead and to the left of the robot, (n,) each [m]."""
        c, s = elementary.cos(self.pose.heading), elementary.sin(self.pose.heading)
        dx, dy = points[:, 0] - self.pose.x, points[:, 1] - self.pose.y
        return c * dx + s * dy, c * dy - s * dx

    def visible(self, points: FloatArray) -> BoolArray:
        """Which (n, 2) points lie in front of what both neighbouring beams hit."""
        return self.shows(*self.local(points))

    def shows(self, ahead: FloatArray, left: FloatArray) -> BoolArray:
        """The same for places ahead and to the left of the robot, any shape [m]."""
        first, last = self.beams.angles[0], self.beams.angles[-1]
        place = np.arctan2(left, ahead)  # becomes a whole number: its last bits do not count
        place -= first
        place *= (len(self.beams.angles) - 1) / (last - first)
        place += 1.0 + ON_A_BEAM
        beam = np.clip(place, 0.0, len(self._shown_to) - 1.0, out=place).astype(np.intp)
        return np.asarray(ahead * ahead + left * left <= self._shown_to[beam])

    def surrounded(self, points: FloatArray, margin: float) -> BoolArray:
        """Which (n, 2) points are so far inside the field of view that nothing unseen beside its edge
        can be closer than `margin`; what is near the robot counts, because it was in view a moment ago.
        """
        bearing, distance = self.polar(points)
        inside = np.clip(self.beams.angles[-1] - np.abs(bearing), 0.0, math.pi / 2)
        return np.asarray(
            (distance * elementary.sines(inside) >= margin) | (distance < SEEN_NEARBY * margin)
        )

    def allowance(self, clearance: float) -> Float32Array:
        """Least distance to keep from each obstacle, squared, (n,) [m2].

        It is `clearance`, but never more than the robot has now: who starts inside an inflated
        obstacle may move out of it, not further in.
        """
        return np.asarray(np.minimum(np.float32(clearance * clearance), self._kept2))

    def free(self, points: FloatArray, clearance: float) -> tuple[BoolArray, FloatArray]:
        """Which (n, 2) points keep `clearance` (or the allowance), and the room of each, (n,) [m]."""
        distance2 = squared_distances(points, self.obstacles)
        keeps = (distance2 >= self.allowance(clearance)).all(axis=1)
        return np.asarray(keeps), np.sqrt(distance2.min(axis=1, initial=np.inf))

    def passable(self, a: FloatArray, b: FloatArray, clearance: float) -> BoolArray:
        """Which segments a[i]-b[i], (n, 2) each, keep `clearance` (or the allowance) all along."""
        room = squared_segment_distances(a, b, self.obstacles) >= self.allowance(clearance)
        return np.asarray(room.all(axis=1))

    def passable_twice(
        self, a: FloatArray, b: FloatArray, tight: float, wide: float
    ) -> tuple[BoolArray, BoolArray]:
        """`passable` for two clearances at once."""
        distance2 = squared_segment_distances(a, b, self.obstacles)
        keeps_tight = (distance2 >= self.allowance(tight)).all(axis=1)
        keeps_wide = (distance2 >= self.allowance(wide)).all(axis=1)
        return np.asarray(keeps_tight), np.asarray(keeps_wide)

    @cached_property
    def outline_ends(self) -> BoolArray:
        """Which beams go free past an obstacle whose outline leaves the laser's range, (n_beams,)."""
        return np.asarray(~self.solid & self.beams.near(self.solid, OUTLINE_END))


def _shown_to(sight: FloatArray) -> FloatArray:
    """How far squared everything is shown between each beam and the next, (n_beams + 2,) [m2].

    The last beam counts as the space beyond it, up to rounding; outside of the field of view nothing is
    shown.
    """
    shown = np.full(len(sight) + 2, -1.0)
    np.minimum(sight[:-1], sight[1:], out=shown[1:-2])
    shown[-2] = sight[-1]
    shown[1:-1] *= shown[1:-1]
    return shown
