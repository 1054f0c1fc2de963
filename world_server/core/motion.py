"""Unicycle motion with contact: exact arcs, and no tunnelling at any speed (thesis eq. 3.3).

A robot is a disc. Over one period its twist is constant and its path an arc. Where discs and walls may
touch within the period, the arcs are followed by conservative advancement: the gap to the nearest
thing divided by the closing speed is a time in which nothing can touch. At a contact the robots that
drive into it stop at their last free place; they keep turning, and may drive away in the next period.

Robots that cannot meet within the period are independent of each other, and those that can are advanced
together, so the result does not depend on the order of the robots.

Leaves out: mass, friction and impact.
"""

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.geometry import TAU
from onehop.contracts.kernels import kernel
from onehop.contracts.sections import RobotSection
from onehop.maps.walls import WallMap
from world_server.core.cells import CellList, cell_at, cell_list, point_gap
from world_server.core.turning import direction

WALL = -1
"""Stands for "an obstacle" where the row of another robot could stand."""

NOBODY = -2
"""Stands for "no contact"."""

_OVERLAP = 1e-9
"""Overlap that is touching and not yet a collision: above rounding, far below anything seen [m]."""

_FINEST = 5e-4
"""Shortest step along an arc near a wall [m]; grazes less deep than _FINEST^2 / (8 radius) go unseen."""

_HALVINGS = 32
"""Halvings of the step in which a contact happened: 50 ms / 2^32 is 12 ps."""

_MARGIN = 0.05
"""How far beyond one period's drive the walls around a robot are known [m]."""

Rows: TypeAlias = npt.NDArray[np.int64]


@kernel()
def _place(pose: FloatArray, v: float, w: float, time: float) -> tuple[float, float]:
    """Where the arc leads in `time` [s]: a chord of length v*time*sin(z)/z, z half the turn.

    Equals the integral of eq. 3.3 for every w; at w = 0 it is the straight line.
    """
    turn = 0.5 * w * time
    chord = v * time
    if abs(turn) > 1e-9:
        _, sine = direction(turn)
        chord *= sine / turn
    ahead, left = direction(pose[2] + turn)
    return pose[0] + chord * ahead, pose[1] + chord * left


@kernel()
def _wall_gap(x: float, y: float, radius: float, cells: CellList) -> float:
    """Distance from a robot's rim to the nearest wall in its cell list [m]."""
    frame, columns, rows, first, segments = cells
    gap: float = math.inf
    cell = cell_at(frame, columns, rows, x, y)
    for item in range(first[cell], first[cell + 1]):
        gap = min(
            gap,
            point_gap(x, y, segments[item, 0], segments[item, 1], segments[item, 2], segments[item, 3]),
        )
    return gap - radius


@kernel()
def _look_ahead(
    time: float, group: Rows, poses: FloatArray, twists: FloatArray, stops: FloatArray,
    moving: BoolArray, radii: FloatArray, cells: CellList, places: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """Put a group where it is at `time`: the smallest gap there [m], and a time without contact [s].

    radii: (n,) of the bodies [m]. stops: (n,) when each robot stopped [s]. Gaps between things that
    stand still do not count.
    """
    worst, safe = math.inf, math.inf
    for k in range(len(group)):
        i = group[k]
        x, y = _place(poses[i], twists[i, 0], twists[i, 1], min(time, stops[i]))
        places[i, 0], places[i, 1] = x, y
        speed = abs(twists[i, 0]) if moving[i] else 0.0
        if moving[i]:
            gap = _wall_gap(x, y, radii[i], cells)
            worst, safe = min(worst, gap), min(safe, gap / speed)
        for m in range(k):
            j = group[m]
            if moving[i] or moving[j]:
                closing = speed + (abs(twists[j, 0]) if moving[j] else 0.0)
                dx, dy = x - places[j, 0], y - places[j, 1]
                gap = math.sqrt(dx * dx + dy * dy) - (radii[i] + radii[j])
                worst, safe = min(worst, gap), min(safe, gap / closing)
    return worst, safe


@kernel()
def _approach(
    i: int, j: int, time: float, poses: FloatArray, twists: FloatArray, places: FloatArray
) -> float:
    """How fast robot i itself drives towards robot j at `time`, times their distance."""
    ahead, left = direction(poses[i, 2] + twists[i, 1] * time)
    dx, dy = places[j, 0] - places[i, 0], places[j, 1] - places[i, 1]
    return float(twists[i, 0] * (ahead * dx + left * dy))


@kernel()
def _stop_colliding(
    free: float, hit: float, group: Rows, poses: FloatArray, twists: FloatArray, stops: FloatArray,
    moving: BoolArray, radii: FloatArray, cells: CellList, places: FloatArray, touched: Rows,
) -> None:  # fmt: skip
    """Stop at `free` whoever drives into something at `hit`; places are those of `hit`.

    Of two robots that meet, the one that drives towards the other stops; both if neither seems to.
    """
    for k in range(len(group)):
        i = group[k]
        if moving[i] and _wall_gap(places[i, 0], places[i, 1], radii[i], cells) < -_OVERLAP:
            touched[i] = WALL
        for m in range(k):
            j = group[m]
            dx, dy = places[i, 0] - places[j, 0], places[i, 1] - places[j, 1]
            apart = math.sqrt(dx * dx + dy * dy)
            if not (moving[i] or moving[j]) or apart - (radii[i] + radii[j]) >= -_OVERLAP:
                continue
            by_i = moving[i] and _approach(i, j, hit, poses, twists, places) > 0.0
            by_j = moving[j] and _approach(j, i, hit, poses, twists, places) > 0.0
            if moving[i] and touched[i] == NOBODY and (by_i or not by_j):
                touched[i] = j
            if moving[j] and touched[j] == NOBODY and (by_j or not by_i):
                touched[j] = i
    for k in range(len(group)):
        i = group[k]
        if moving[i] and touched[i] != NOBODY:
            moving[i] = False
            stops[i] = free


@kernel()
def _sweep(
    period: float, group: Rows, poses: FloatArray, twists: FloatArray, stops: FloatArray,
    moving: BoolArray, radii: FloatArray, cells: CellList, places: FloatArray, touched: Rows,
) -> None:  # fmt: skip
    """Follow the arcs of a group through one period, stopping robots where they touch something."""
    time = 0.0
    _, safe = _look_ahead(time, group, poses, twists, stops, moving, radii, cells, places)
    while time < period:
        fastest = 0.0
        for k in range(len(group)):
            if moving[group[k]]:
                fastest = max(fastest, abs(twists[group[k], 0]))
        if fastest == 0.0:
            return
        later = min(period, time + max(safe, _FINEST / fastest))
        worst, safe = _look_ahead(later, group, poses, twists, stops, moving, radii, cells, places)
        if worst >= -_OVERLAP:
            time = later
            continue
        free, hit = time, later
        for _ in range(_HALVINGS):
            middle = 0.5 * (free + hit)
            worst, _ = _look_ahead(middle, group, poses, twists, stops, moving, radii, cells, places)
            if worst >= -_OVERLAP:
                free = middle
            else:
                hit = middle
        _look_ahead(hit, group, poses, twists, stops, moving, radii, cells, places)
        _stop_colliding(
            free, hit, group, poses, twists, stops, moving, radii, cells, places, touched
        )  # fmt: skip
        time = free
        _, safe = _look_ahead(time, group, poses, twists, stops, moving, radii, cells, places)


@kernel()
def _group_rows(
    period: float, poses: FloatArray, twists: FloatArray, radii: FloatArray
) -> tuple[Rows, Rows]:
    """Label, (n,), equal for robots that may meet within the period, and the size of each label."""
    count = len(poses)
    label = np.arange(count)
    for i in range(count):
        for j in range(i):
            closing = (abs(twists[i, 0]) + abs(twists[j, 0])) * period
            near = radii[i] + radii[j] + closing
            dx, dy = poses[i, 0] - poses[j, 0], poses[i, 1] - poses[j, 1]
            if closing > 0.0 and dx * dx + dy * dy < near * near and label[i] != label[j]:
                old, new = max(label[i], label[j]), min(label[i], label[j])
                for k in range(count):
                    if label[k] == old:
                        label[k] = new
    sizes = np.zeros(count, dtype=np.int64)
    for i in range(count):
        sizes[label[i]] += 1
    return label, sizes


@kernel()
def _drive(
    period: float, poses: FloatArray, twists: FloatArray, radii: FloatArray, cells: CellList
) -> Rows:
    """Move everyone through one period, in place; what each robot drove into, (n,)."""
    count = len(poses)
    touched = np.full(count, NOBODY)
    stops = np.full(count, period)
    moving = twists[:, 0] != 0.0
    places = np.empty((count, 2))
    label, sizes = _group_rows(period, poses, twists, radii)
    for i in range(count):
        alone = sizes[label[i]] == 1
        if alone:
            gap = _wall_gap(poses[i, 0], poses[i, 1], radii[i], cells) if moving[i] else math.inf
            if gap > abs(twists[i, 0]) * period:
                continue
        if label[i] == i:
            group = np.flatnonzero(label == i)
            _sweep(
                period, group, poses, twists, stops, moving, radii, cells, places, touched
            )  # fmt: skip
    for i in range(count):
        x, y = _place(poses[i], twists[i, 0], twists[i, 1], stops[i])
        heading = poses[i, 2] + twists[i, 1] * period
        if heading > math.pi or heading <= -math.pi:
            heading -= TAU * math.ceil((heading - math.pi) / TAU)
        poses[i, 0], poses[i, 1], poses[i, 2] = x, y, heading
        if touched[i] != NOBODY:
            twists[i, 0] = 0.0
    return touched


class Motion:
    """Moves the robots of a team on one map, period by period. Making one loads the compiled kernels.

    bodies: of the robots, row by row.
    """

    def __init__(self, walls: WallMap, bodies: Sequence[RobotSection], period_ns: int) -> None:
        self._period = period_ns / 1e9
        self.radii: FloatArray = np.array([body.radius for body in bodies])
        reach = max(body.radius + body.max_speed * self._period for body in bodies) + _MARGIN
        self._cells = cell_list(walls.segments, walls.bounds, reach)
        self.advance(np.empty((0, 3)), np.empty((0, 2)))
        self.wall_gap(0, 0.0, 0.0)

    def advance(self, poses: FloatArray, twists: FloatArray, radii: FloatArray | None = None) -> Rows:
        """Move robots by their twists, (n, 2) [m/s, rad/s], at poses, (n, 3) [m, m, rad], in place.

        |v| must not exceed the body's max_speed. A robot that was stopped gets v = 0. radii: of the
        bodies, (n,) [m], where they are not their own. Returns what each robot drove into, (n,): the row
        of another robot, WALL or NOBODY.
        """
        radii = self.radii if radii is None else radii
        touched: Rows = _drive(self._period, poses, twists, radii, self._cells)
        return touched

    def wall_gap(self, row: int, x: float, y: float) -> float:
        """Distance from a robot's rim, at (x, y), to the nearest wall nearby [m]; inf if none is."""
        return float(_wall_gap(x, y, self.radii[row], self._cells))
