"""The shortest way on the known map, for comparison: no robot ever sees it.

Dijkstra from the goal over a raster of places where a disc of the given radius fits, with steps to the
16 nearest directions, then pulled taut. The raster rounds a corner by up to half a cell, so a length is
right to about one per cent.
"""

import heapq
import math

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.kernels import kernel
from onehop.contracts.sections import Point
from onehop.maps.walls import WallMap

_STEPS = np.array(
    (
        *((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)),
        *((1, 2), (2, 1), (-1, 2), (-2, 1), (1, -2), (2, -1), (-1, -2), (-2, -1)),
    )
)


class KnownMap:
    """A raster of a map for a disc of `radius` [m]. free: (rows, columns); cell: its size [m]."""

    def __init__(self, walls: WallMap, radius: float, cell: float) -> None:
        xmin, ymin, xmax, ymax = walls.bounds
        self.cell, self.origin = cell, (xmin, ymin)
        columns, rows = math.ceil((xmax - xmin) / cell), math.ceil((ymax - ymin) / cell)
        self.x: FloatArray = xmin + (np.arange(columns, dtype=np.float64) + 0.5) * cell
        self.y: FloatArray = ymin + (np.arange(rows, dtype=np.float64) + 0.5) * cell
        blocked = np.zeros((rows, columns), dtype=np.bool_)
        for segment in walls.segments:
            _mark(blocked, segment, self.x, self.y, radius)
        grid = np.stack(np.meshgrid(self.x, self.y), axis=-1).reshape(-1, 2)
        self.free: BoolArray = ~(blocked | walls.ground.solid(grid).reshape(rows, columns))

    def cell_of(self, point: Point) -> tuple[int, int]:
        """Row and column of a point."""
        return (
            min(max(int((point[1] - self.origin[1]) / self.cell), 0), len(self.y) - 1),
            min(max(int((point[0] - self.origin[0]) / self.cell), 0), len(self.x) - 1),
        )

    def distances(self, goal: Point) -> FloatArray:
        """Length of the shortest raster way from each cell, (rows, columns) [m]; inf: none."""
        return self.distances_over(self.free, goal)

    def distances_over(self, free: BoolArray, goal: Point) -> FloatArray:
        """The same where only cells of `free`, (rows, columns), can be driven over."""
        row, column = self.cell_of(goal)
        return _dijkstra(free, row, column, _STEPS) * self.cell

    def shortest(self, start: Point, distances: FloatArray) -> FloatArray | None:
        """Taut way from start to the goal of `distances`, (n, 2) [m]; None when there is none."""
        row, column = self.cell_of(start)
        if not math.isfinite(distances[row, column]):
            return None
        chain = _descend(self.free, distances, row, column, _STEPS)
        taut = _pull(self.free, chain)
        return np.column_stack((self.x[taut[:, 1]], self.y[taut[:, 0]]))


def way_length(way: FloatArray) -> float:
    """Length of a way, (n, 2) [m]."""
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def _mark(blocked: BoolArray, segment: FloatArray, x: FloatArray, y: FloatArray, radius: float) -> None:
    """Block the raster points closer to one segment than the radius."""
    x0, y0, x1, y1 = segment
    left, right = np.searchsorted(x, (min(x0, x1) - radius, max(x0, x1) + radius))
    low, high = np.searchsorted(y, (min(y0, y1) - radius, max(y0, y1) + radius))
    px, py = np.meshgrid(x[left:right] - x0, y[low:high] - y0)
    dx, dy = x1 - x0, y1 - y0
    share = np.clip((px * dx + py * dy) / max(dx * dx + dy * dy, 1e-12), 0.0, 1.0)
    blocked[low:high, left:right] |= np.hypot(px - share * dx, py - share * dy) < radius


@kernel()
def _clear(free: BoolArray, r0: int, c0: int, r1: int, c1: int) -> bool:
    """Whether the straight line between two cells stays on free cells."""
    count = 2 * max(abs(r1 - r0), abs(c1 - c0))
    for i in range(count + 1):
        share = i / max(count, 1)
        if not free[round(r0 + share * (r1 - r0)), round(c0 + share * (c1 - c0))]:
            return False
    return True


@kernel()
def _dijkstra(free: BoolArray, row: int, column: int, steps: npt.NDArray[np.int64]) -> FloatArray:
    rows, columns = free.shape
    cost = np.full((rows, columns), np.inf)
    cost[row, column] = 0.0
    heap = [(0.0, row, column)]
    while len(heap) > 0:
        reached, r, c = heapq.heappop(heap)
        if reached > cost[r, c]:
            continue
        for k in range(len(steps)):
            nr, nc = r + steps[k, 0], c + steps[k, 1]
            if nr < 0 or nc < 0 or nr >= rows or nc >= columns or not free[nr, nc]:
                continue
            if k >= 4 and not _clear(free, r, c, nr, nc):
                continue
            length = reached + math.sqrt(steps[k, 0] * steps[k, 0] + steps[k, 1] * steps[k, 1])
            if length < cost[nr, nc]:
                cost[nr, nc] = length
                heapq.heappush(heap, (length, nr, nc))
    return cost


def _descend(
    free: BoolArray, distances: FloatArray, row: int, column: int, steps: npt.NDArray[np.int64]
) -> npt.NDArray[np.int64]:
    """Cells from one cell down to the goal, (n, 2)."""
    chain = [(row, column)]
    rows, columns = free.shape
    while distances[row, column] > 0.0:
        best, where = distances[row, column], (row, column)
        for dr, dc in steps.tolist():
            r, c = row + dr, column + dc
            if 0 <= r < rows and 0 <= c < columns and distances[r, c] < best:
                best, where = distances[r, c], (r, c)
        row, column = where
        chain.append(where)
    return np.array(chain)


def _pull(free: BoolArray, chain: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """The same way pulled taut: only cells that a straight free line cannot skip."""
    keep, here = [0], 0
    while here < len(chain) - 1:
        reach = here + 1
        for ahead in range(here + 2, len(chain)):
            if _clear(free, *chain[here].tolist(), *chain[ahead].tolist()):
                reach = ahead
        here = reach
        keep.append(here)
    return chain[keep]
