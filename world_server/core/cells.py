"""Cell lists: for every square of the map the wall segments that matter to a robot in it.

One look-up gives all candidates of a laser scan or of a collision test, without duplicates, so that the
cost of both follows what is near and not the size of the map.
"""

import math
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import FloatArray
from onehop.contracts.kernels import kernel
from onehop.maps.walls import Bounds

IntArray: TypeAlias = npt.NDArray[np.int32]

_FINEST = 1.0
"""Smallest side of a cell [m]: finer ones save few candidates."""

_MOST = 200
"""Cells along the longer side of the map at most."""


class CellList(NamedTuple):
    """Segments by cell, in the layout that the kernels read.

    frame: (3,) x and y of the lower left corner and side of a cell [m]. columns, rows: of cells.
    first: (columns*rows + 1,) where each cell's segments begin in `rows_of`.
    segments: (k, 4) float64, the segments of all cells one after the other.
    """

    frame: FloatArray
    columns: int
    rows: int
    first: IntArray
    segments: FloatArray


@kernel()
def point_gap(x: float, y: float, x0: float, y0: float, x1: float, y1: float) -> float:
    """Distance from a point to a segment [m]."""
    ex, ey = x1 - x0, y1 - y0
    squared = ex * ex + ey * ey
    along = 0.0
    if squared > 0.0:
        along = min(1.0, max(0.0, ((x - x0) * ex + (y - y0) * ey) / squared))
    dx, dy = x - x0 - along * ex, y - y0 - along * ey
    return math.sqrt(dx * dx + dy * dy)


@kernel()
def _fill(
    segments: FloatArray, frame: FloatArray, columns: int, rows: int, reach: float,
    first: IntArray, items: IntArray,
) -> None:  # fmt: skip
    """Count each cell's segments into first[1:] (items empty), or put their numbers into items."""
    size = frame[2]
    radius = reach + size * math.sqrt(0.5)
    counting = len(items) == 0
    for number in range(len(segments)):
        x0, y0, x1, y1 = segments[number]
        left = max(0, int((min(x0, x1) - radius - frame[0]) / size))
        right = min(columns - 1, int((max(x0, x1) + radius - frame[0]) / size))
        low = max(0, int((min(y0, y1) - radius - frame[1]) / size))
        high = min(rows - 1, int((max(y0, y1) + radius - frame[1]) / size))
        for row in range(low, high + 1):
            for column in range(left, right + 1):
                x, y = frame[0] + (column + 0.5) * size, frame[1] + (row + 0.5) * size
                if point_gap(x, y, x0, y0, x1, y1) > radius:
                    continue
                cell = row * columns + column
                if counting:
                    first[cell + 1] += 1
                else:
                    items[first[cell]] = number
                    first[cell] += 1


def cell_list(segments: FloatArray, bounds: Bounds, reach: float) -> CellList:
    """The segments, (n, 4), that lie within `reach` [m] of any point of each cell."""
    xmin, ymin, xmax, ymax = bounds
    size = max(reach / 4.0, _FINEST, max(xmax - xmin, ymax - ymin) / _MOST)
    columns = max(1, math.ceil((xmax - xmin) / size))
    rows = max(1, math.ceil((ymax - ymin) / size))
    frame = np.array([xmin, ymin, size])
    counts = np.zeros(columns * rows + 1, dtype=np.int32)
    _fill(segments, frame, columns, rows, reach, counts, np.empty(0, dtype=np.int32))
    first = np.cumsum(counts, dtype=np.int32)
    items = np.empty(max(1, int(first[-1])), dtype=np.int32)
    _fill(segments, frame, columns, rows, reach, first[:-1].copy(), items)
    gathered = segments[items[: first[-1]]] if first[-1] else np.empty((0, 4))
    return CellList(frame, columns, rows, first, np.ascontiguousarray(gathered))


@kernel()
def cell_at(frame: FloatArray, columns: int, rows: int, x: float, y: float) -> int:
    """Number of the cell of a point; a point outside the map gets the nearest cell."""
    column = min(columns - 1, max(0, int((x - frame[0]) / frame[2])))
    row = min(rows - 1, max(0, int((y - frame[1]) / frame[2])))
    return row * columns + column
