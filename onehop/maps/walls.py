"""The ground truth of a map: wall segments and what is filled, whatever file they came from.

A place is free when it is inside the map, outside everything filled, and clear of every segment. Both
answers are exact: no raster stands between a query and the walls.
"""

import math
from dataclasses import dataclass
from typing import Protocol, TypeAlias

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray

Bounds: TypeAlias = tuple[float, float, float, float]

_CHUNK = 1 << 22
"""Point-segment pairs looked at in one numpy expression: bounds the memory to some 100 MB."""

_RING_STEP = 0.1
"""Distance between the rings of the search for a free point [m]."""

_RING_GROWTH = 1.05
"""Far away the rings may lie as much further apart as they are further out."""

_RING_POINTS = 240
"""Directions in which a ring is tried at most."""


_PROBE_DIRECTIONS, _PROBE_REACHES = 16, (0.25, 0.5, 0.75, 0.95)
"""Places in a disc (in parts of its radius) that are looked at before its walls are measured."""


class Ground(Protocol):
    """What is filled between the segments."""

    def solid(self, points: FloatArray) -> BoolArray:
        """Which of the points, (n, 2) [m], lie in something filled or outside the map, (n,)."""
        ...


@dataclass(frozen=True)
class WallMap:
    """A map: segments (n, 4) float64 [x0, y0, x1, y1 in m], bounds (xmin, ymin, xmax, ymax) [m].

    reading: how the map's file was understood, for people, where that may have hidden free ground.
    """

    segments: FloatArray
    bounds: Bounds
    ground: Ground
    reading: str = ""

    def clearance(self, points: FloatArray) -> FloatArray:
        """Distance from each point, (n, 2), to the nearest wall, (n,) [m]; 0 in something filled."""
        distance = np.zeros(len(points))
        outside = np.flatnonzero(~self.ground.solid(points))
        rows = max(1, _CHUNK // max(1, len(self.segments)))
        for first in range(0, len(outside), rows):
            chunk = outside[first : first + rows]
            distance[chunk] = segment_distances(points[chunk], self.segments).min(
                axis=1, initial=math.inf
            )
        return distance

    def free(self, points: FloatArray, radius: float = 0.0) -> BoolArray:
        """Where a disc of this radius fits, for centres (n, 2), (n,). A touching disc fits."""
        clearance = self.clearance(points)
        return (clearance > 0.0) & (clearance >= radius)

    def is_free(self, x: float, y: float, radius: float = 0.0) -> bool:
        """Whether a disc of this radius fits at (x, y)."""
        return bool(self.free(np.array([[x, y]]), radius)[0])

    def sees(self, x: float, y: float, to_x: float, to_y: float, margin: float) -> bool:
        """Whether a disc of radius `margin` can be pushed straight from one point to the other."""
        return self.is_free(x, y, margin) and bool(
            gap_between(np.array([x, y, to_x, to_y]), self.segments) >= margin
        )

    def nearest_free(self, x: float, y: float, radius: float) -> tuple[float, float] | None:
        """A free place for a disc near (x, y), in whole centimetres; None if the map has none.

        The nearest one to within the distance of the rings on which it is sought (0.1 m nearby).
        """
        xmin, ymin, xmax, ymax = self.bounds
        farthest = math.hypot(max(x - xmin, xmax - x), max(y - ymin, ymax - y))
        ring = 0.0
        while ring <= farthest:
            count = min(_RING_POINTS, max(1, math.ceil(math.tau * ring / _RING_STEP)))
            angles = np.arange(count, dtype=np.float64) * (math.tau / count)
            offsets = ring * np.column_stack((elementary.cosines(angles), elementary.sines(angles)))
            points = np.round(np.array([x, y]) + offsets, 2)
            points = points[self._hopeful(points, radius)]
            fits = np.flatnonzero(self.free(points, radius))
            if len(fits):
                return float(points[fits[0], 0]), float(points[fits[0], 1])
            ring = max(ring + _RING_STEP, ring * _RING_GROWTH)
        return None

    def _hopeful(self, points: FloatArray, radius: float) -> BoolArray:
        """Which discs around points, (n, 2), have nothing solid in a few places well within them, (n,).

        Solid ground in a disc means a wall in it, so that the others cannot fit: a million walls need
        not be measured for them.
        """
        angles = np.arange(_PROBE_DIRECTIONS, dtype=np.float64) * (math.tau / _PROBE_DIRECTIONS)
        directions = np.column_stack((elementary.cosines(angles), elementary.sines(angles)))
        hopeful = ~self.ground.solid(points)
        for reach in _PROBE_REACHES:
            for offset in radius * reach * directions:
                hopeful &= ~self.ground.solid(points + offset)
        return hopeful


def segment_distances(points: FloatArray, segments: FloatArray) -> FloatArray:
    """Distance from each point, (n, 2), to each segment, (m, 4), as (n, m) [m]."""
    start, run = segments[:, :2], segments[:, 2:] - segments[:, :2]
    squared = run[:, 0] * run[:, 0] + run[:, 1] * run[:, 1]
    offset = points[:, None, :] - start[None, :, :]
    reach = offset[:, :, 0] * run[:, 0] + offset[:, :, 1] * run[:, 1]
    along = reach / np.where(squared > 0.0, squared, 1.0)
    nearest = offset - np.clip(along, 0.0, 1.0)[:, :, None] * run
    distances: FloatArray = elementary.lengths(nearest[:, :, 0], nearest[:, :, 1])
    return distances


def gap_between(path: FloatArray, segments: FloatArray) -> float:
    """Distance between one segment, (4,), and the nearest of others, (n, 4) [m]; 0 when they cross."""
    if not len(segments):
        return math.inf
    ends = segment_distances(path.reshape(2, 2), segments).min()
    others = segment_distances(segments.reshape(-1, 2), path[None, :]).min()
    return 0.0 if _crossed(path, segments) else float(min(ends, others))


def _crossed(path: FloatArray, segments: FloatArray) -> bool:
    """Whether a segment, (4,), properly crosses any of the others, (n, 4)."""

    def side(of: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
        left: FloatArray = (of[..., 2] - of[..., 0]) * (y - of[..., 1]) - (of[..., 3] - of[..., 1]) * (
            x - of[..., 0]
        )
        return left

    a = side(path, segments[:, 0], segments[:, 1])
    b = side(path, segments[:, 2], segments[:, 3])
    c = side(segments, path[0], path[1])
    d = side(segments, path[2], path[3])
    return bool(np.any((a * b < 0.0) & (c * d < 0.0)))
