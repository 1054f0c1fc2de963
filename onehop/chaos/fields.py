"""Small maps drawn at random: an empty field, scattered blocks, or a wall with one passage."""

import math

import numpy as np

from onehop.contracts.sections import MapSection, Point

Polygon = tuple[Point, ...]

SIDE_M = (28.0, 45.0)
PASSAGE_M = (2.4, 6.0)
"""Width of a passage [m]: from one that asks for a column to one that a team of any shape fits."""

_WALL_M = 1.0


def draw_field(random: np.random.Generator) -> MapSection:
    """A map of polygons, in whole decimetres."""
    width, height = (round(float(side), 1) for side in random.uniform(*SIDE_M, 2))
    kind = int(random.integers(4))
    obstacles: list[Polygon] = []
    if kind == 1:
        obstacles += _wall(random, width, height)
    if kind != 0:
        obstacles += [_block(random, width, height) for _ in range(int(random.integers(1, 7)))]
    return MapSection(width=width, height=height, obstacles=tuple(obstacles))


def _block(random: np.random.Generator, width: float, height: float) -> Polygon:
    """A convex block of three to six corners on a circle."""
    radius = float(random.uniform(0.8, 3.0))
    x, y = (float(random.uniform(radius, side - radius)) for side in (width, height))
    angles = np.sort(random.uniform(0.0, math.tau, int(random.integers(3, 7))))
    return tuple(
        (round(x + radius * math.cos(angle), 1), round(y + radius * math.sin(angle), 1))
        for angle in angles
    )


def _wall(random: np.random.Generator, width: float, height: float) -> list[Polygon]:
    """A wall from border to border with one passage."""
    upright = bool(random.integers(2))
    along, across = (height, width) if upright else (width, height)
    at = round(float(random.uniform(0.35, 0.65)) * across, 1)
    gap = round(float(random.uniform(*PASSAGE_M)), 1)
    begin = round(float(random.uniform(2.0, along - gap - 2.0)), 1)
    parts = []
    for low, high in ((0.0, begin), (round(begin + gap, 1), along)):
        corners = ((low, at), (high, at), (high, at + _WALL_M), (low, at + _WALL_M))
        parts.append(tuple((y, x) if upright else (x, y) for x, y in corners))
    return parts
