"""What one scan shows: points that were hit, what is visible, and how much room is left around a way.

Works in the map frame. Beside the beams it holds `beside`: points that left the field of view a moment
ago and still lie beside or behind the robot (a bounded memory, see `RecentObstacles`); a laser that
looks 180 degrees ahead cannot turn around a corner without them.
"""

import math

import numpy as np
import numpy.typing as npt

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose

Float32Array = npt.NDArray[np.float32]

BLOCK = 16384
"""Elements worked on at once: 64 KB stay in the cache and off the page allocator."""

NO_POINTS: FloatArray = np.empty((0, 2))


class View:
    """One scan seen from one pose.

    sight: (n_beams,) float64 [m], free range along each beam, laser range where nothing returned.
    obstacles: (n, 2) float64 [m], what the beams hit, and `beside`. Of hits closer
    together than `grain` (a tenth of the inflation) some are left out: a clearance c is then wrong by at
    most grain^2 / (8 c).
    """

    def __init__(
        self,
        fan: Beams,
        pose: Pose,
        scan: Ranges,
        grain: float,
        beside: FloatArray = NO_POINTS,
    ) -> None:
        self.fan = fan
        self.pose = pose
        self.origin: FloatArray = np.array((pose.x, pose.y))
        seen = np.isfinite(scan)
        self.sight: FloatArray = np.where(seen, scan, fan.range).astype(np.float64)
        self.solid: BoolArray = seen
        c, s = elementary.cos(pose.heading), elementary.sin(pose.heading)
        d = fan.directions
        self.directions: FloatArray = np.column_stack(
            (c * d[:, 0] - s * d[:, 1], s * d[:, 0] + c * d[:, 1])
        )
        hits = self.origin + self.directions[seen] * self.sight[seen, None]
        self.obstacles: FloatArray = np.concatenate((_outline(hits, grain), beside))
        self._shown_to = _shown_to(self.sight)
        have = squared_distances(self.origin[None], self.obstacles)[0]
        kept = np.maximum(np.sqrt(have) - np.float32(0.01), np.float32(0.0))
        self._kept = kept * kept

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
        first, last = self.fan.angles[0], self.fan.angles[-1]
        place = np.arctan2(left, ahead)  # becomes a whole number: its last bits do not count
        place -= first
        place *= (len(self.fan.angles) - 1) / (last - first)
        place += 1.0 + 1e-6
        beam = np.clip(place, 0.0, len(self._shown_to) - 1.0, out=place).astype(np.intp)
        return np.asarray(ahead * ahead + left * left <= self._shown_to[beam])

    def surrounded(self, points: FloatArray, margin: float) -> BoolArray:
        """Which (n, 2) points are so far inside the field of view that nothing unseen beside its edge
        can be closer than `margin`; what is near the robot counts, because it was in view a moment ago.
        """
        bearing, distance = self.polar(points)
        inside = np.clip(self.fan.angles[-1] - np.abs(bearing), 0.0, math.pi / 2)
        return np.asarray((distance * elementary.sines(inside) >= margin) | (distance < 4.0 * margin))

    def allowance(self, clearance: float) -> Float32Array:
        """Least distance to keep from each obstacle, squared, (n,) [m2].

        It is `clearance`, but never more than the robot has now: who starts inside an inflated
        obstacle may move out of it, not further in.
        """
        return np.asarray(np.minimum(np.float32(clearance * clearance), self._kept))

    def free(self, points: FloatArray, clearance: float) -> tuple[BoolArray, FloatArray]:
        """Which (n, 2) points keep `clearance` (or the allowance), and the room of each, (n,) [m]."""
        distance2 = squared_distances(points, self.obstacles)
        keeps = (distance2 >= self.allowance(clearance)).all(axis=1)
        return np.asarray(keeps), np.sqrt(distance2.min(axis=1, initial=np.inf))

    def passable(self, a: FloatArray, b: FloatArray, clearance: float) -> BoolArray:
        """Which segments a[i]-b[i], (n, 2) each, keep `clearance` (or the allowance) all along."""
        room = segment_distances2(a, b, self.obstacles) >= self.allowance(clearance)
        return np.asarray(room.all(axis=1))

    def passable_twice(
        self, a: FloatArray, b: FloatArray, tight: float, wide: float
    ) -> tuple[BoolArray, BoolArray]:
        """`passable` for two clearances at once."""
        distance2 = segment_distances2(a, b, self.obstacles)
        keeps_tight = (distance2 >= self.allowance(tight)).all(axis=1)
        keeps_wide = (distance2 >= self.allowance(wide)).all(axis=1)
        return np.asarray(keeps_tight), np.asarray(keeps_wide)


class RecentObstacles:
    """Points that left the field of view but are still near: at most `capacity`, 16 B each."""

    def __init__(self, reach: float, capacity: int = 256) -> None:
        self.reach = reach
        self.capacity = capacity
        self.points: FloatArray = NO_POINTS

    def beside(self, pose: Pose, half_view: float) -> FloatArray:
        """The remembered points that the laser cannot see from `pose`, (n, 2) [m]."""
        dx, dy = self.points[:, 0] - pose.x, self.points[:, 1] - pose.y
        bearing = elementary.directions(dy, dx) - pose.heading
        hidden = elementary.cosines(bearing) < elementary.cos(half_view - 0.02)
        return self.points[hidden & (dx * dx + dy * dy < self.reach * self.reach)]

    def keep(self, view: View) -> None:
        """Remember the obstacles of this view that are within reach, the nearest first."""
        points = view.obstacles
        distance2 = squared_distances(view.origin[None], points)[0]
        near = np.flatnonzero(distance2 < 2.25 * self.reach * self.reach)
        order = near[np.argsort(distance2[near], kind="stable")]
        self.points = points[order[: self.capacity]]


def _shown_to(sight: FloatArray) -> FloatArray:
    """How far squared everything is shown between each beam and the next, (n_beams + 2,) [m2].

    The last beam counts as the space beyond it, up to rounding; outside of the fan nothing is shown.
    """
    shown = np.full(len(sight) + 2, -1.0)
    np.minimum(sight[:-1], sight[1:], out=shown[1:-2])
    shown[-2] = sight[-1]
    shown[1:-1] *= shown[1:-1]
    return shown


def _outline(hits: FloatArray, grain: float) -> FloatArray:
    """The same outline with other points: one for each step of `grain` along it where hits are dense,
    and one more between hits that are too far apart to see a wall by, but not far enough to pass.
    """
    if len(hits) < 3:
        return hits
    leg = hits[1:] - hits[:-1]
    step = elementary.lengths(leg[:, 0], leg[:, 1])
    cell = np.floor(np.cumsum(np.minimum(step, grain)) / grain)
    keep = np.ones(len(hits), dtype=np.bool_)
    keep[1] = cell[0] > 0.0
    keep[2:-1] = cell[1:-1] > cell[:-2]
    wide = np.flatnonzero((step > 5.0 * grain) & ((step < 20.0 * grain) | _same_wall(leg, step)))
    more = (step[wide] / (5.0 * grain)).astype(np.intp)
    first = np.repeat(wide, more)
    place = np.arange(1, len(first) + 1) - np.repeat(np.cumsum(more) - more, more)
    between = hits[first] + leg[first] * (place / np.repeat(more + 1, more))[:, None]
    return np.concatenate((hits[keep], between))


def _same_wall(leg: FloatArray, step: FloatArray) -> BoolArray:
    """Which gaps between consecutive hits lie in line with the gap before or after them and are not
    much wider: a wall that the beams graze, not a way through it. leg: (n, 2) gaps [m], step: lengths.
    """
    turn = (leg[1:] * leg[:-1]).sum(axis=1) > 0.99 * step[1:] * step[:-1]
    straight = np.zeros(len(step), dtype=np.bool_)
    straight[1:] = turn & (step[1:] < 1.6 * step[:-1])
    straight[:-1] |= turn & (step[:-1] < 1.6 * step[1:])
    return straight


def squared_distances(a: FloatArray, b: FloatArray) -> Float32Array:
    """All squared distances between (n, 2) and (m, 2) points, (n, m) float32 [m2].

    Single precision relative to the first point, and in place: these matrices are most of a planning
    moment, and allocating fresh ones costs more than filling them.
    """
    if not len(a) or not len(b):
        return np.empty((len(a), len(b)), dtype=np.float32)
    single_a, single_b = (a - a[0]).astype(np.float32), (b - a[0]).astype(np.float32)
    dx: Float32Array = single_a[:, :1] - single_b[:, 0]
    dy = single_a[:, 1:] - single_b[:, 1]
    dx *= dx
    dy *= dy
    dx += dy
    return dx


def segment_distances2(a: FloatArray, b: FloatArray, points: FloatArray) -> Float32Array:
    """Squared distances of (m, 2) points from segments a[i]-b[i], (n, m) float32 [m2]; as above."""
    result = np.empty((len(a), len(points)), dtype=np.float32)
    if not result.size:
        return result
    ax, ay = (a - a[0]).astype(np.float32).T
    bx, by = (b - a[0]).astype(np.float32).T
    ox, oy = (points - a[0]).astype(np.float32).T.copy()
    dx, dy = bx - ax, by - ay
    over_length2 = np.float32(1.0) / np.maximum(dx * dx + dy * dy, np.float32(1e-9))
    rows = max(1, BLOCK // len(points))
    for low in range(0, len(a), rows):
        part = slice(low, low + rows)
        px = np.subtract(ox, ax[part, None], out=result[part])
        py = oy - ay[part, None]
        t = px * dx[part, None]
        work = py * dy[part, None]
        t += work
        t *= over_length2[part, None]
        np.clip(t, 0.0, 1.0, out=t)
        px -= np.multiply(t, dx[part, None], out=work)
        py -= np.multiply(t, dy[part, None], out=work)
        px *= px
        py *= py
        px += py
    return result
