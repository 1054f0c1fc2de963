"""TangentBug on the known map, as the baseline of the planner's campaign.

Kamon, Rimon and Rivlin, "TangentBug: a range-sensor-based navigation algorithm" (IJRR 17(9), 1998), for
an ideal robot: a point on the raster of free places that sees 360 degrees and moves as it likes, so it
is better off than our leader, who sees ahead only, keeps its speed and has to turn.
"""

import math

import numba
import numpy as np
import numpy.typing as npt

from world_server.core.walls import BoolArray, FloatArray

IntArray = npt.NDArray[np.int64]

RAYS = 360
AROUND = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])
"""Steps (column, row) to the eight neighbours, counter-clockwise."""


CHORD = 4
"""Steps along a wall that are measured, and looked around after, at once."""

LONGEST = 100000
"""Bound of every loop: far longer than any wall."""


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
def _best_end(
    sight: FloatArray, x: float, y: float, gx: float, gy: float, reach: float
) -> tuple[int, float]:
    """The ray whose end makes the way over it shortest (a node of the local tangent graph), and that
    end's distance to the goal.
    """
    best, value, left = -1, np.inf, np.inf
    for ray in range(RAYS):
        edge = sight[ray] >= reach - 0.5
        for other in (ray - 1, ray + 1):
            edge = (
                edge or sight[other % RAYS] > sight[ray] + 3.0 or sight[ray] > sight[other % RAYS] + 3.0
            )
        if not edge or sight[ray] < 1.0:
            continue
        angle = 2 * math.pi * ray / RAYS
        rest = math.hypot(x + sight[ray] * math.cos(angle) - gx, y + sight[ray] * math.sin(angle) - gy)
        if sight[ray] + rest < value:
            best, value, left = ray, sight[ray] + rest, rest
    return best, left


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
    least: float,
    around: IntArray,
) -> tuple[float, float, float]:
    """From the wall ahead along it, until a place closer to the goal than ever is in sight, and there.

    Place and length; the length is infinite when the loop closes without. least: distance to beat.
    Lengths are chords over CHORD steps, because steps to eight neighbours would make slanting walls
    longer than they are.
    """
    direction = math.atan2(gy - y, gx - x)
    c, s, length = math.cos(direction), math.sin(direction), 0.0
    while free[round(y + 0.5 * s), round(x + 0.5 * c)]:
        x, y, length = x + 0.5 * c, y + 0.5 * s, length + 0.5
    column, row = round(x), round(y)
    followed = min(least, math.hypot(column - gx, row - gy))
    wall = math.atan2(round(y + 0.5 * s) - row, round(x + 0.5 * c) - column)
    heading = (round(wall / (math.pi / 4)) - 2 * side) % 8
    first_column, first_row, first_heading = column, row, -1
    last_column, last_row = column, row
    for moved in range(LONGEST):
        heading = _next_heading(free, column, row, heading, side, around)
        if column == first_column and row == first_row:
            if heading == first_heading:
                break
            if first_heading < 0:
                first_heading = heading
        column, row = column + around[heading, 0], row + around[heading, 1]
        followed = min(followed, math.hypot(column - gx, row - gy))
        if moved % CHORD == CHORD - 1:
            length += math.hypot(column - last_column, row - last_row)
            last_column, last_row = column, row
            sight = _look(free, float(column), float(row), reach)
            left, ray = _nearest_seen(sight, float(column), float(row), gx, gy)
            if left < followed - 1.0:
                angle = 2 * math.pi * ray / RAYS
                x, y = column + sight[ray] * math.cos(angle), row + sight[ray] * math.sin(angle)
                return x, y, length + sight[ray]
    return float(column), float(row), np.inf


@numba.njit(cache=True)
def _way(
    free: BoolArray, x: float, y: float, gx: float, gy: float, reach: float, around: IntArray
) -> float:
    length, least = 0.0, math.hypot(x - gx, y - gy)
    for _ in range(LONGEST):
        if _straight(free, x, y, gx, gy):
            return length + math.hypot(x - gx, y - gy)
        sight = _look(free, x, y, reach)
        ray, left = _best_end(sight, x, y, gx, gy, reach)
        angle = 2 * math.pi * ray / RAYS
        if ray >= 0 and left < least - 0.5:
            step = min(2.0, sight[ray])
            x, y = x + step * math.cos(angle), y + step * math.sin(angle)
            length += step
            least = min(least, max(left, math.hypot(x - gx, y - gy)))
            continue
        cross = math.cos(angle) * (gy - y) - math.sin(angle) * (gx - x)
        side = -1 if cross > 0 else 1
        x, y, further = _follow(free, x, y, gx, gy, reach, side, least, around)
        least = min(least, math.hypot(x - gx, y - gy))
        length += further
        if math.isinf(length):
            break
    return -1.0


def tangent_bug(free: BoolArray, x: float, y: float, gx: float, gy: float, reach: float) -> float:
    """Length of the way from (x, y) to (gx, gy), all in cells; -1 if the robot finds none.

    free: (rows, columns). reach: of the range sensor.
    """
    return float(_way(free, float(x), float(y), float(gx), float(gy), reach, AROUND))
