"""Coloured points for viewers that draw clouds but no scenes: walls, robots, links."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from onehop.analysis.palette import WALL_EDGE, rgb
from onehop.analysis.view.scene import BODY_HEIGHT
from onehop.contracts.geometry import Pose

COLOURED = np.dtype(
    [
        ("x", "<f4"),
        ("y", "<f4"),
        ("z", "<f4"),
        ("red", "u1"),
        ("green", "u1"),
        ("blue", "u1"),
        ("alpha", "u1"),
    ]
)
"""One point: place [m] and colour."""

_LINK_HEIGHT = 0.4
"""Height at which links are drawn [m]."""


def wall_points(segments: npt.NDArray[np.float64], step: float) -> npt.NDArray[Any]:
    """Grey points along every segment, (n, 4), at most `step` apart, at two heights; COLOURED."""
    spots = [np.empty((0, 2))]
    for x0, y0, x1, y1 in segments.tolist():
        share = np.linspace(0.0, 1.0, max(2, math.ceil(math.hypot(x1 - x0, y1 - y0) / step) + 1))
        spots.append(np.column_stack((x0 + share * (x1 - x0), y0 + share * (y1 - y0))))
    x, y = np.vstack(spots).T
    grey = rgb(WALL_EDGE)
    return np.concatenate([_painted(x, y, z, grey) for z in (0.0, 0.6)])


def body_shape(radius: float, colour: str) -> npt.NDArray[Any]:
    """A robot as a small coloured ring with a nose, in its own frame, for viewers that draw no scene."""
    turn = np.linspace(0.0, math.tau, 24, endpoint=False)
    size = max(radius, 0.4)
    nose = np.linspace(0.0, 2.0 * size, 8)
    x = np.concatenate((size * np.cos(turn), nose))
    y = np.concatenate((size * np.sin(turn), np.zeros(len(nose))))
    return _painted(x, y, BODY_HEIGHT, rgb(colour))


def body_points(
    poses: Iterable[tuple[int, Pose]], shapes: dict[int, npt.NDArray[Any]]
) -> npt.NDArray[Any]:
    """The shapes of all robots where they are; COLOURED."""
    parts = [np.empty(0, dtype=COLOURED)]
    for robot, pose in poses:
        shape = shapes[robot]
        placed = shape.copy()
        c, s = math.cos(pose.heading), math.sin(pose.heading)
        placed["x"] = pose.x + c * shape["x"] - s * shape["y"]
        placed["y"] = pose.y + s * shape["x"] + c * shape["y"]
        parts.append(placed)
    return np.concatenate(parts)


def link_points(
    links: Iterable[tuple[Pose, Pose, float]], threshold_share: float = 0.5
) -> npt.NDArray[Any]:
    """Points along each link (leader, follower, throughput as a share of its best); COLOURED.

    Green when good, through orange at the threshold, red when nothing comes.
    """
    parts = []
    for one, other, share in links:
        along = np.linspace(0.0, 1.0, 24)
        x, y = one.x + along * (other.x - one.x), one.y + along * (other.y - one.y)
        parts.append(_painted(x, y, _LINK_HEIGHT, _quality(share, threshold_share)))
    return np.concatenate(parts) if parts else np.empty(0, dtype=COLOURED)


def _quality(share: float, threshold: float) -> tuple[float, float, float]:
    good, warn, bad = (0.0, 0.62, 0.45), (0.90, 0.62, 0.0), (0.70, 0.09, 0.17)
    if share >= threshold:
        part, low, high = min(1.0, (share - threshold) / (1.0 - threshold)), warn, good
    else:
        part, low, high = max(0.0, share / threshold), bad, warn
    r, g, b = (a + part * (z - a) for a, z in zip(low, high, strict=True))
    return r, g, b


def _painted(
    x: npt.NDArray[np.float64], y: npt.NDArray[np.float64], z: float, colour: tuple[float, float, float]
) -> npt.NDArray[Any]:
    points = np.empty(len(x), dtype=COLOURED)
    points["x"], points["y"], points["z"] = x, y, z
    for name, value in zip(("red", "green", "blue"), colour, strict=True):
        points[name] = round(255 * value)
    points["alpha"] = 255
    return points
