"""The laser range finder of every robot: exact, in one batch (thesis 3.2, 3.4).

A wall segment near the robot covers an interval of beams, and only those beams are tested against it;
candidates come from a cell list. Beams pass no joint between two walls: whether a beam hits is decided
by the sides on which the ends lie, and walls that share an end share the answer.

Leaves out: noise, beam width and mirror speed; all beams of a scan are taken at one instant.
"""

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import FloatArray
from onehop.contracts.beams import Beams
from onehop.contracts.kernels import kernel
from onehop.contracts.sections import RobotSection
from onehop.maps.walls import WallMap
from world_server.core.cells import CellList, IntArray, cell_at, cell_list
from world_server.core.turning import direction

Scans: TypeAlias = npt.NDArray[np.float32]

_SLACK = 1e-4
"""What `_direction` may be wrong by, and an interval is widened by at each end [rad]."""


@kernel(error_model="numpy")
def _direction(x: float, y: float) -> float:
    """atan2(y, x) within _SLACK: cheap, since it only selects the beams that are tested exactly.

    The polynomial is a least-maximum fit of atan on [0, 1]; its error is 8.2e-5.
    """
    flat, steep = abs(x), abs(y)
    turned = steep > flat
    if turned:
        flat, steep = steep, flat
    slope = steep / flat if flat > 0.0 else 0.0
    square = slope * slope
    angle = slope * (0.99921378 + square * (-0.32117473 + square * (0.14626394 - 0.0389862 * square)))
    if turned:
        angle = 0.5 * math.pi - angle
    if x < 0.0:
        angle = math.pi - angle
    return -angle if y < 0.0 else angle


@kernel(error_model="numpy")
def _edge_beams(
    ax: float, ay: float, bx: float, by: float, first: int, last: int,
    directions: FloatArray, ranges: FloatArray,
) -> None:  # fmt: skip
    """Shorten those of the beams first..last that hit the segment a-b, given in the robot's frame.

    With d the beam's direction, the ends' sides are a x d, b x d; the range is a x b / (a x d - b x d).
    """
    area = ax * by - ay * bx
    for beam in range(max(0, first), min(len(ranges) - 1, last) + 1):
        dx, dy = directions[0, beam], directions[1, beam]
        side_a, side_b = ax * dy - ay * dx, bx * dy - by * dx
        if (side_a > 0.0 and side_b > 0.0) or (side_a < 0.0 and side_b < 0.0):
            continue
        turn = side_a - side_b
        reach = area / turn if turn != 0.0 else min(ax * dx + ay * dy, bx * dx + by * dy)
        if 0.0 <= reach < ranges[beam]:
            ranges[beam] = reach


@kernel(error_model="numpy")
def _inner_beams(
    ax: float, ay: float, bx: float, by: float, first: int, last: int,
    directions: FloatArray, ranges: FloatArray,
) -> None:  # fmt: skip
    """Shorten the beams first..last, all known to hit the segment: without a branch, hence fast."""
    first, stop = max(0, first), min(len(ranges), last + 1)
    if stop <= first:
        return
    area, ex, ey = ax * by - ay * bx, ax - bx, ay - by
    dx, dy, inner = directions[0, first:stop], directions[1, first:stop], ranges[first:stop]
    for beam in range(len(inner)):
        reach = area / (ex * dy[beam] - ey * dx[beam])
        inner[beam] = reach if reach < inner[beam] else inner[beam]


@kernel(error_model="numpy")
def _look_at_wall(
    ax: float, ay: float, bx: float, by: float, limit: float, half: float, per_radian: float,
    directions: FloatArray, ranges: FloatArray,
) -> None:  # fmt: skip
    """Shorten the beams that hit one segment a-b, given in the robot's frame [m]."""
    if half <= 0.5 * math.pi and ax < 0.0 and bx < 0.0:
        return
    ex, ey = bx - ax, by - ay
    squared = ex * ex + ey * ey
    along = min(1.0, max(0.0, -(ax * ex + ay * ey) / squared)) if squared > 0.0 else 0.0
    nx, ny = ax + along * ex, ay + along * ey
    if nx * nx + ny * ny > limit * limit:
        return
    from_a, from_b = _direction(ax, ay), _direction(bx, by)
    low, high = min(from_a, from_b), max(from_a, from_b)
    if high - low < math.pi - 2.0 * _SLACK:
        outer = math.ceil((low - _SLACK + half) * per_radian)
        first = max(outer, math.floor((low + _SLACK + half) * per_radian) + 1)
        last = math.ceil((high - _SLACK + half) * per_radian) - 1
        if last < first:
            last = first - 1
        _edge_beams(ax, ay, bx, by, outer, first - 1, directions, ranges)
        _inner_beams(ax, ay, bx, by, first, last, directions, ranges)
        outer = math.floor((high + _SLACK + half) * per_radian)
        _edge_beams(ax, ay, bx, by, last + 1, outer, directions, ranges)
    elif high - low <= math.pi + 2.0 * _SLACK:
        _edge_beams(ax, ay, bx, by, 0, len(ranges) - 1, directions, ranges)
    else:
        left = math.ceil((high - _SLACK + half) * per_radian)
        _edge_beams(ax, ay, bx, by, left, len(ranges) - 1, directions, ranges)
        right = math.floor((low + _SLACK + half) * per_radian)
        _edge_beams(ax, ay, bx, by, 0, right, directions, ranges)


@kernel(error_model="numpy")
def _look_at_disc(
    cx: float, cy: float, radius: float, limit: float, half: float, per_radian: float,
    directions: FloatArray, ranges: FloatArray,
) -> None:  # fmt: skip
    """Shorten the beams that hit a disc, centre in the robot's frame [m].

    A robot does not see the disc in which it is, and that is its own.
    """
    squared = cx * cx + cy * cy
    if squared > (limit + radius) * (limit + radius) or squared <= radius * radius:
        return
    middle, width = math.atan2(cy, cx), math.asin(radius / math.sqrt(squared)) + _SLACK
    for lap in (-math.tau, 0.0, math.tau):
        right = max(0, math.ceil((middle + lap - width + half) * per_radian))
        left = min(len(ranges) - 1, math.floor((middle + lap + width + half) * per_radian))
        for beam in range(right, left + 1):
            dx, dy = directions[0, beam], directions[1, beam]
            off = cx * dy - cy * dx
            if abs(off) > radius:
                continue
            reach = cx * dx + cy * dy - math.sqrt(radius * radius - off * off)
            if 0.0 <= reach < ranges[beam]:
                ranges[beam] = reach


@kernel(error_model="numpy")
def _scan_all(
    poses: FloatArray, looking: IntArray, radii: FloatArray, limit: float, half: float,
    directions: FloatArray, frame: FloatArray, columns: int, rows: int, first: IntArray,
    segments: FloatArray, scans: Scans,
) -> None:  # fmt: skip
    """Scan from the poses, (n, 3), numbered in `looking` into rows of scans; the others are seen.

    radii: (n,) of their bodies [m].
    """
    beams = directions.shape[1]
    per_radian = (beams - 1) / (2.0 * half)
    ranges = np.empty(beams)
    for row in range(len(looking)):
        own = looking[row]
        x, y = poses[own, 0], poses[own, 1]
        c, s = direction(poses[own, 2])
        ranges[:] = math.inf
        cell = cell_at(frame, columns, rows, x, y)
        for item in range(first[cell], first[cell + 1]):
            ax, ay = segments[item, 0] - x, segments[item, 1] - y
            bx, by = segments[item, 2] - x, segments[item, 3] - y
            _look_at_wall(
                c * ax + s * ay, c * ay - s * ax, c * bx + s * by, c * by - s * bx,
                limit, half, per_radian, directions, ranges,
            )  # fmt: skip
        for other in range(len(poses)):
            ax, ay = poses[other, 0] - x, poses[other, 1] - y
            _look_at_disc(
                c * ax + s * ay, c * ay - s * ax, radii[other], limit, half, per_radian,
                directions, ranges,
            )  # fmt: skip
        for beam in range(beams):
            scans[row, beam] = ranges[beam] if ranges[beam] <= limit else math.inf


class Laser:
    """Lasers of one kind on one map. Making it loads the compiled kernel: no tick waits for that.

    Directions of the beams are of full precision, as all sines in these kernels; those of Beams are
    rounded to 0.007 nrad.
    """

    def __init__(self, walls: WallMap, body: RobotSection) -> None:
        beams = Beams(body)
        self._half = beams.half_view
        self._directions = np.array([direction(angle) for angle in beams.angles]).T.copy()
        self._range = beams.range
        self._radius = body.radius
        self._cells: CellList = cell_list(walls.segments, walls.bounds, body.laser_range)
        self.scans(np.empty((0, 3)), np.empty(0, dtype=np.int32))

    def scans(self, poses: FloatArray, looking: IntArray, radii: FloatArray | None = None) -> Scans:
        """One scan for each robot in `looking`, (k,) int32, rows of poses (n, 3) [m, m, rad].

        radii: (n,) of the robots that may be seen [m], by default those of this laser's own robot.
        (k, n_beams) float32 [m], right to left; +inf where neither a wall nor a robot is in range.
        """
        if radii is None:
            radii = np.full(len(poses), self._radius)
        scans = np.empty((len(looking), self._directions.shape[1]), dtype=np.float32)
        _scan_all(
            poses, looking, radii, self._range, self._half, self._directions, *self._cells, scans
        )  # fmt: skip
        return scans


class Lasers:
    """The lasers of a team, of as many kinds as it has. bodies: of the robots, row by row."""

    def __init__(self, walls: WallMap, bodies: Sequence[RobotSection]) -> None:
        self._radii = np.array([body.radius for body in bodies])
        of_kind: dict[tuple[float, int, float], list[int]] = {}
        for row, body in enumerate(bodies):
            kind = body.laser_range, body.laser_beams, body.laser_fov_deg
            of_kind.setdefault(kind, []).append(row)
        self._kinds = [(Laser(walls, bodies[rows[0]]), frozenset(rows)) for rows in of_kind.values()]

    def scans(self, poses: FloatArray, looking: Sequence[int]) -> list[Scans]:
        """The scan of each robot in `looking`, by row of poses (n, 3): (n_beams of its own,)."""
        found: dict[int, Scans] = {}
        for laser, rows in self._kinds:
            own = [row for row in looking if row in rows]
            scans = laser.scans(poses, np.array(own, dtype=np.int32), self._radii)
            found.update(zip(own, scans, strict=True))
        return [found[row] for row in looking]
