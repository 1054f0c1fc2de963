"""The ground truth of a map as an occupancy grid, as nav_msgs/OccupancyGrid has it."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import BoolArray
from onehop.maps.grid import GridFrame, GridGround
from onehop.maps.walls import WallMap

CELL = 0.1
"""Side of a cell where the map has none of its own [m]."""

MOST_CELLS = 1 << 24
"""A map that would have more of them gets larger ones."""

FREE, OCCUPIED = 0, 100

_STEPS = 4
"""Places looked at on a wall, for each cell of its length."""


class Occupancy(NamedTuple):
    """cells: (rows, columns) int8, row 0 at the bottom, FREE or OCCUPIED. frame: where they lie."""

    cells: npt.NDArray[np.int8]
    frame: GridFrame


def occupancy(walls: WallMap) -> Occupancy:
    """A map of cells as it is; one of polygons in cells whose middle is solid, or that a wall passes."""
    if isinstance(walls.ground, GridGround):
        filled, frame = walls.ground.filled, walls.ground.frame
    else:
        filled, frame = _cells(walls)
    return Occupancy(np.where(filled, OCCUPIED, FREE).astype(np.int8), frame)


def _cells(walls: WallMap) -> tuple[BoolArray, GridFrame]:
    xmin, ymin, xmax, ymax = walls.bounds
    width, height = xmax - xmin, ymax - ymin
    cell = max(CELL, math.sqrt(width * height / MOST_CELLS))
    columns, rows = math.ceil(width / cell), math.ceil(height / cell)
    x = xmin + cell * (np.arange(columns) + 0.5)
    middles = [np.column_stack((x, np.full(columns, ymin + cell * (n + 0.5)))) for n in range(rows)]
    filled = np.array([walls.ground.solid(row) for row in middles])
    for x0, y0, x1, y1 in walls.segments.tolist():
        steps = np.linspace(0.0, 1.0, 2 + math.ceil(_STEPS * math.hypot(x1 - x0, y1 - y0) / cell))
        column = ((x0 + steps * (x1 - x0) - xmin) / cell).astype(np.int64)
        row = ((y0 + steps * (y1 - y0) - ymin) / cell).astype(np.int64)
        filled[row.clip(0, rows - 1), column.clip(0, columns - 1)] = True
    return filled, GridFrame(xmin, ymin, 0.0, cell)
