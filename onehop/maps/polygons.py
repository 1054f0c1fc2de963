"""Maps made of filled polygons inside a rectangle, as a scenario file states them."""

import numpy as np

from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.sections import MapSection, Point
from onehop.maps.walls import WallMap


class PolygonGround:
    """A rectangle (0, 0)..(width, height) with filled polygons in it, which may overlap."""

    def __init__(self, width: float, height: float, polygons: tuple[tuple[Point, ...], ...]) -> None:
        self._width, self._height = width, height
        self._polygons = [np.array(polygon, dtype=np.float64) for polygon in polygons]

    def solid(self, points: FloatArray) -> BoolArray:
        """Which points, (n, 2), are inside a polygon (even-odd rule) or outside the rectangle, (n,)."""
        x, y = points[:, 0], points[:, 1]
        filled: BoolArray = (x < 0.0) | (x > self._width) | (y < 0.0) | (y > self._height)
        for corners in self._polygons:
            filled = filled | _inside(x, y, corners)
        return filled


def _inside(x: FloatArray, y: FloatArray, corners: FloatArray) -> BoolArray:
    """Whether a ray to the right crosses the outline, (k, 2), an odd number of times."""
    odd = np.zeros(len(x), dtype=np.bool_)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        spans = (y0 <= y) != (y1 <= y)
        odd ^= spans & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return odd


def polygon_map(section: MapSection) -> WallMap:
    """The map of a scenario that states width, height and obstacles."""
    width, height = section.width, section.height
    rim = ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height))
    segments = [
        (*start, *end)
        for corners in (rim, *section.obstacles)
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True)
        if start != end
    ]
    return WallMap(
        segments=np.array(segments, dtype=np.float64),
        bounds=(0.0, 0.0, width, height),
        ground=PolygonGround(width, height, section.obstacles),
    )
