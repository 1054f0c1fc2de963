"""Where on a map a mission can begin, end, and have things happen: places that can be driven between."""

import math

import numpy as np

from onehop.analysis.shortest import KnownMap
from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.sections import Point
from onehop.maps.walls import WallMap

CELLS = 250
"""Cells of the raster along the longer side of a large map."""

FINEST = 0.25
"""Cell of the raster of a small map [m]."""

MARGIN = 0.3
"""What drawn places have beyond the clearance that the planner keeps [m]."""

BESIDE_M = 0.5
"""How far from a place its way may begin [m]."""

_DRAWS = 200
"""Places drawn until one fits."""


class Places:
    """The free places of a map, for a planner that keeps `inflation` from walls [m]."""

    def __init__(self, walls: WallMap, inflation: float) -> None:
        xmin, ymin, xmax, ymax = walls.bounds
        cell = max(FINEST, max(xmax - xmin, ymax - ymin) / CELLS)
        self._walls = walls
        self._clearance = inflation + MARGIN
        self._known = KnownMap(walls, self._clearance, cell)

    def drawn(self, random: np.random.Generator) -> Point | None:
        """A free place, in whole decimetres; None when the map has hardly any."""
        free = np.argwhere(self._known.free)
        for _ in range(_DRAWS if len(free) else 0):
            row, column = free[int(random.integers(len(free)))]
            x, y = round(float(self._known.x[column]), 1), round(float(self._known.y[row]), 1)
            if self._walls.is_free(x, y, self._clearance):
                return x, y
        return None

    def ways_to(self, goal: Point) -> "Ways":
        """How far it is to a place from everywhere."""
        return Ways(self._known, self._known.free, goal)

    def ways_past(self, goal: Point, bodies: list[Point], radius: float) -> "Ways":
        """The same where bodies stand in the way for good, whose middles are passed at `radius` [m]."""
        blocked = np.zeros_like(self._known.free)
        x, y = np.meshgrid(self._known.x, self._known.y)
        for body in bodies:
            blocked |= np.hypot(x - body[0], y - body[1]) < radius
        return Ways(self._known, self._known.free & ~blocked, goal)


class Ways:
    """Lengths of the shortest ways to one goal."""

    def __init__(self, known: KnownMap, free: BoolArray, goal: Point) -> None:
        self._known = known
        self._lengths: FloatArray = known.distances_over(free, goal)

    def length(self, start: Point) -> float:
        """From one place, or right beside it if that is too close to a wall [m]; inf: none."""
        row, column = self._known.cell_of(start)
        off = math.ceil(BESIDE_M / self._known.cell)
        near = self._lengths[max(0, row - off) : row + off + 1, max(0, column - off) : column + off + 1]
        return float(near.min(initial=math.inf))
