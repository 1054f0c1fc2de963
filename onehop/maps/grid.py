"""Maps made of square cells: from an array of filled cells to wall segments and an exact ground."""

from typing import NamedTuple

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.errors import MapError
from onehop.maps.walls import WallMap

MOST_WALLS = 1 << 20
"""Straight pieces of wall of the largest map; a map of a large building has some 100,000."""


class GridFrame(NamedTuple):
    """Where a grid lies: its lower left corner [m], its turn [rad], and the side of a cell [m]."""

    x: float
    y: float
    yaw: float
    cell: float


class GridGround:
    """Filled cells, (rows, columns) bool, row 0 at the bottom; outside of them everything is solid."""

    def __init__(self, filled: BoolArray, frame: GridFrame) -> None:
        self._filled = np.pad(filled, 1, constant_values=True)
        self.frame = frame

    @property
    def filled(self) -> BoolArray:
        """The cells, (rows, columns)."""
        return self._filled[1:-1, 1:-1]

    def solid(self, points: FloatArray) -> BoolArray:
        """Which points, (n, 2) [m], are in a filled cell or outside the grid, (n,)."""
        frame = self.frame
        c, s = elementary.cos(frame.yaw), elementary.sin(frame.yaw)
        x, y = points[:, 0] - frame.x, points[:, 1] - frame.y
        column = np.floor((c * x + s * y) / frame.cell).astype(np.int64) + 1
        row = np.floor((c * y - s * x) / frame.cell).astype(np.int64) + 1
        rows, columns = self._filled.shape
        filled: BoolArray = self._filled[row.clip(0, rows - 1), column.clip(0, columns - 1)]
        return filled


def grid_map(filled: BoolArray, frame: GridFrame, name: str = "", reading: str = "") -> WallMap:
    """The map of filled cells, (rows, columns) bool, row 0 at the bottom.

    Raises MapError under the map's `name` when it has more walls than can be handled.
    """
    rows, columns = filled.shape
    corners = np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]], dtype=np.float64)
    outline = _placed(corners, frame)
    return WallMap(
        segments=np.ascontiguousarray(
            _placed(_edges(filled, name).reshape(-1, 2), frame).reshape(-1, 4)
        ),
        bounds=(*map(float, outline.min(axis=0)), *map(float, outline.max(axis=0))),  # type: ignore[arg-type]
        ground=GridGround(filled, frame),
        reading=reading,
    )


def _placed(points: FloatArray, frame: GridFrame) -> FloatArray:
    """Points counted in cells, (n, 2), in the map frame [m]."""
    c, s = elementary.cos(frame.yaw), elementary.sin(frame.yaw)
    x, y = points[:, 0] * frame.cell, points[:, 1] * frame.cell
    return np.column_stack((frame.x + c * x - s * y, frame.y + s * x + c * y))


def _edges(filled: BoolArray, name: str) -> FloatArray:
    """Borders between free and filled cells, (n, 4) in cells, with edges in one line joined.

    The outside counts as filled, so a free cell at the rim has a wall.
    """
    closed = np.pad(filled, 1, constant_values=True)
    upright = _runs((closed[1:-1, 1:] != closed[1:-1, :-1]).T, name)
    level = _runs(closed[1:, 1:-1] != closed[:-1, 1:-1], name)
    vertical = np.column_stack((upright[:, 0], upright[:, 1], upright[:, 0], upright[:, 2]))
    horizontal = np.column_stack((level[:, 1], level[:, 0], level[:, 2], level[:, 0]))
    return np.vstack((vertical, horizontal)).astype(np.float64)


def _runs(border: BoolArray, name: str) -> FloatArray:
    """Runs of true in each row of a mask: (n, 3) as row, first, one past the last."""
    change = np.diff(np.pad(border, ((0, 0), (1, 1))).view(np.int8), axis=1)
    count = np.count_nonzero(change == 1)
    if count > MOST_WALLS:
        raise MapError(
            name, f"{count} straight pieces of wall", f"at most {MOST_WALLS}: is the picture noise?"
        )
    row, first = np.nonzero(change == 1)
    _, last = np.nonzero(change == -1)
    return np.column_stack((row, first, last)).astype(np.float64)
