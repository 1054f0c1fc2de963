"""TangentBug on the known map, as the baseline of the planner's campaign.

Kamon, Rimon and Rivlin, "TangentBug: a range-sensor-based navigation algorithm" (IJRR 17(9), 1998), for
an ideal robot: a point on the raster of free places that sees 360 degrees and moves as it likes, so it
is better off than our leader, who sees ahead only, keeps its speed and has to turn.
"""

import math

import numba
import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import BoolArray, FloatArray

IntArray = npt.NDArray[np.int64]

RAYS = 360
AROUND = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])
"""Steps (column, row) to the eight neighbours, counter-clockwise."""


STEP = 2.0
"""Of the robot between two looks, in cells."""


@numba.njit(cache=True)
def _look(free: BoolArray, x: float, y: float, reach: float) -> FloatArray:
    """Free range along each ray, in cells."""
    rows, columns = free.shape
    sight = np.empty(RAYS)
    for ray in range(RAYS):
        c, s = math.cos(2 * math.pi * ray / RAYS), math.sin(2 * math.pi * ray / RAYS)
        distance = 0.0
        while distance < reach:
            column, row = round(x + c * (distance + 0.5)), round(y + s * (distance + 0.5))
            if (
                row < 0
                or column < 0
                or row >= rows
                or column >= columns
                or not free[int(row), int(column)]
            ):
                break
            distance += 0.5
        sight[ray] = min(distance, reach)
    return sight


@numba.njit(cache=True)
def _straight(free: BoolArray, x0: float, y0: float, x1: float, y1: float) -> bool:
    count = int(2 * max(abs(x1 - x0), abs(y1 - y0))) + 1
    for i in range(count + 1):
        x, y = x0 + (x1 - x0) * i / count, y0 + (y1 - y0) * i / count
        if not free[round(y), round(x)]:
            return False
    return True


@numba.njit(cache=True)
def _best_node(
    sight: FloatArray, x: float, y: float, gx: float, gy: float, reach: float, bound: float
) -> int:
    """The node of the local tangent graph over which the way to the goal is shortest, as its ray.

    Nodes are the ends of rays beside a jump of the range and of those that nothing stops; they count if
    they are closer to the goal than `bound`. -1: there is none, a local minimum.
    """
    best, value = -1, np.inf
    for ray in range(RAYS):
        here, before, after = sight[ray], sight[ray - 1], sight[(ray + 1) % RAYS]
        edge = max(abs(here - before), abs(here - after)) > 3.0
        if here < 1.0 or not (edge or here >= reach - 0.5):
            continue
        angle = 2 * math.pi * ray / RAYS
        left = math.hypot(x + here * math.cos(angle) - gx, y + here * math.sin(angle) - gy)
        if left < bound and here + left < value:
            best, value = ray, here + left
    return best


@numba.njit(cache=True)
def _nearest_seen(sight: FloatArray, x: float, y: float, gx: float, gy: float) -> tuple[float, int]:
    """Distance to the goal of the nearest place in sight, and the ray that it ends."""
    least, best = np.inf, 0
    for ray in range(RAYS):
        angle = 2 * math.pi * ray / RAYS
        left = math.hypot(x + sight[ray] * math.cos(angle) - gx, y + sight[ray] * math.sin(angle) - gy)
        if left < least:
            least, best = left, ray
    return least, best


@numba.njit(cache=True)
def _next_heading(
    free: BoolArray, column: int, row: int, heading: int, side: int, around: IntArray
) -> int:
    """First free step after one of `heading`, the wall on the left (side +1) or on the right (-1)."""
    turn = (heading + 2 * side) % 8
    for _ in range(8):
        if free[row + around[turn, 1], column + around[turn, 0]]:
            break
        turn = (turn - side) % 8
    return turn


@numba.njit(cache=True)
def _follow(
    free: BoolArray,
    x: float,
    y: float,
    gx: float,
    gy: float,
    reach: float,
    side: int,
    around: IntArray,
) -> tuple[float, float, float]:
    """Along the boundary that blocks the way to the goal, to a place closer to it than all of that.

    The robot heads for the end of the boundary in sight, which cuts concave corners. Returns the place
    and the length of the way; the length is infinite when the boundary closes without such a place
    (seen by a step that is met again; the steps to compare with are 1, 2, 4, ... of it).
    """
    direction = math.atan2(gy - y, gx - x)
    c, s, length, to_wall = math.cos(direction), math.sin(direction), 0.0, 0.0
    while free[round(y + (to_wall + 0.5) * s), round(x + (to_wall + 0.5) * c)]:
        to_wall += 0.5
    column, row = round(x + to_wall * c), round(y + to_wall * s)
    wall = math.atan2(round(y + (to_wall + 0.5) * s) - row, round(x + (to_wall + 0.5) * c) - column)
    heading = (round(wall / (math.pi / 4)) - 2 * side) % 8
    followed = min(math.hypot(x - gx, y - gy), math.hypot(column - gx, row - gy))
    mark_column, mark_row, mark_heading, steps, marked = column, row, -1, 0, 1
    while True:
        while True:
            following = _next_heading(free, column, row, heading, side, around)
            there_column, there_row = column + around[following, 0], row + around[following, 1]
            shown = math.hypot(there_column - x, there_row - y) <= reach and _straight(
                free, x, y, float(there_column), float(there_row)
            )
            if not shown and math.hypot(column - x, row - y) > 1e-9:
                break
            column, row, heading, steps = there_column, there_row, following, steps + 1
            followed = min(followed, math.hypot(column - gx, row - gy))
            if column == mark_column and row == mark_row and heading == mark_heading:
                return x, y, np.inf
            if steps == 2 * marked:
                mark_column, mark_row, mark_heading, marked = column, row, heading, steps
        rest = math.hypot(column - x, row - y)
        step = min(STEP, rest)
        x, y, length = x + step / rest * (column - x), y + step / rest * (row - y), length + step
        sight = _look(free, x, y, reach)
        left, ray = _nearest_seen(sight, x, y, gx, gy)
        if left < followed - 0.5:
            angle = 2 * math.pi * ray / RAYS
            return (
                x + sight[ray] * math.cos(angle),
                y + sight[ray] * math.sin(angle),
                length + sight[ray],
            )


@numba.njit(cache=True)
def _way(
    free: BoolArray, x: float, y: float, gx: float, gy: float, reach: float, around: IntArray
) -> float:
    length, left_at = 0.0, np.inf
    while True:
        if _straight(free, x, y, gx, gy):
            return length + math.hypot(x - gx, y - gy)
        sight, here = _look(free, x, y, reach), math.hypot(x - gx, y - gy)
        ray = _best_node(sight, x, y, gx, gy, reach, min(here, left_at) - 0.5)
        if ray >= 0:
            angle, step = 2 * math.pi * ray / RAYS, min(STEP, sight[ray])
            x, y, length = x + step * math.cos(angle), y + step * math.sin(angle), length + step
            continue
        ray = _best_node(sight, x, y, gx, gy, reach, np.inf)
        angle = 2 * math.pi * ray / RAYS
        cross = math.cos(angle) * (gy - y) - math.sin(angle) * (gx - x)
        side = -1 if cross > 0 else 1
        x, y, further = _follow(free, x, y, gx, gy, reach, side, around)
        length += further
        if math.isinf(length):
            return -1.0
        left_at = math.hypot(x - gx, y - gy)


def tangent_bug(free: BoolArray, x: float, y: float, gx: float, gy: float, reach: float) -> float:
    """Length of the way from (x, y) to (gx, gy), all in cells; -1 if the robot finds none.

    free: (rows, columns). reach: of the range sensor.
    """
    return float(_way(free, float(x), float(y), float(gx), float(gy), reach, AROUND))
