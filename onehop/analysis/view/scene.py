"""Viewer messages from what is in a log: frames, poses, clouds of points, links, events.

Frames: `map`, and `robot-<i>/base_link` with x forward, y left, z up; SI units, radians, quaternions.
"""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from onehop.analysis.palette import WALL_EDGE, rgb
from onehop.analysis.view.schemas import (
    FrameTransforms,
    LaserScan,
    Link,
    Log,
    PointCloud,
    PoseInFrame,
    SceneUpdate,
)
from onehop.contracts.geometry import Pose
from onehop.contracts.topics import robot_name

MAP = "map"
_FLOAT32 = 7
_UINT8 = 1
"""foxglove.PackedElementField.NumericType."""

_COLOURED = np.dtype(
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
_LINK_HEIGHT = 0.4
_BODY_HEIGHT = 0.3
_SCAN_HEIGHT = 0.2
Points = npt.NDArray[np.float32]


def base_link(robot: int) -> str:
    """MessageTrace of a robot."""
    return f"{robot_name(robot)}/base_link"


def transforms(stamp_ns: int, poses: Iterable[tuple[int, Pose]]) -> Any:
    """map -> base_link of every robot present."""
    message = FrameTransforms()
    for robot, pose in poses:
        one = message.transforms.add(parent_frame_id=MAP, child_frame_id=base_link(robot))
        one.timestamp.FromNanoseconds(stamp_ns)
        one.translation.x, one.translation.y = pose.x, pose.y
        one.rotation.z, one.rotation.w = math.sin(pose.heading / 2), math.cos(pose.heading / 2)
    return message


def pose_in_map(stamp_ns: int, pose: Pose) -> Any:
    message = PoseInFrame(frame_id=MAP)
    message.timestamp.FromNanoseconds(stamp_ns)
    message.pose.position.x, message.pose.position.y = pose.x, pose.y
    message.pose.orientation.z = math.sin(pose.heading / 2)
    message.pose.orientation.w = math.cos(pose.heading / 2)
    return message


def cloud(stamp_ns: int, frame: str, points: npt.NDArray[Any]) -> Any:
    """A point cloud; points: (n, 3) float32 [m], or a structured array of _COLOURED."""
    message = PointCloud(
        frame_id=frame, point_stride=points.dtype.itemsize if points.dtype.names else 12
    )
    message.timestamp.FromNanoseconds(stamp_ns)
    message.pose.orientation.w = 1.0
    for number, name in enumerate(("x", "y", "z")):
        message.fields.add(name=name, offset=4 * number, type=_FLOAT32)
    if points.dtype.names:
        for number, name in enumerate(("red", "green", "blue", "alpha")):
            message.fields.add(name=name, offset=12 + number, type=_UINT8)
    message.data = points.tobytes()
    return message


def beam_directions(angles: npt.NDArray[np.float64]) -> Points:
    """Unit vectors of beams at these angles [rad], (n, 2)."""
    return np.column_stack((np.cos(angles), np.sin(angles))).astype(np.float32)


def scan_points(stamp_ns: int, robot: int, ranges: Points, directions: Points) -> Any:
    """What a scan hit, in the robot's frame; beams that hit nothing are left out."""
    hit = np.isfinite(ranges)
    points = np.full((np.count_nonzero(hit), 3), _SCAN_HEIGHT, dtype=np.float32)
    points[:, :2] = directions[hit] * ranges[hit, None]
    return cloud(stamp_ns, base_link(robot), points)


def laser_scan(stamp_ns: int, robot: int, ranges: Points, angles: npt.NDArray[np.float64]) -> Any:
    """The same as Foxglove's own type."""
    message = LaserScan(
        frame_id=base_link(robot), start_angle=float(angles[0]), end_angle=float(angles[-1])
    )
    message.timestamp.FromNanoseconds(stamp_ns)
    message.pose.orientation.w = 1.0
    message.ranges.extend(ranges.tolist())
    return message


def wall_points(segments: npt.NDArray[np.float64], step: float) -> npt.NDArray[Any]:
    """Grey points along every segment, (n, 4), at most `step` apart, at two heights; _COLOURED."""
    spots = [np.empty((0, 2))]
    for x0, y0, x1, y1 in segments.tolist():
        share = np.linspace(0.0, 1.0, max(2, math.ceil(math.hypot(x1 - x0, y1 - y0) / step) + 1))
        spots.append(np.column_stack((x0 + share * (x1 - x0), y0 + share * (y1 - y0))))
    x, y = np.vstack(spots).T
    grey = rgb(WALL_EDGE)
    return np.concatenate([_painted(x, y, z, grey) for z in (0.0, 0.6)])


def walls(stamp_ns: int, segments: npt.NDArray[np.float64]) -> Any:
    """The walls as lines, for Foxglove."""
    message = SceneUpdate()
    entity = message.entities.add(frame_id=MAP, id="walls")
    entity.timestamp.FromNanoseconds(stamp_ns)
    line = entity.lines.add(type=2, thickness=2.0, scale_invariant=True)
    line.pose.orientation.w = 1.0
    for x0, y0, x1, y1 in segments.tolist():
        line.points.add(x=x0, y=y0)
        line.points.add(x=x1, y=y1)
    line.color.r = line.color.g = line.color.b = 0.45
    line.color.a = 1.0
    return message


def bodies(
    stamp_ns: int, robots: Iterable[int], radius: float, colours: dict[int, str], gone: Iterable[int]
) -> Any:
    """Robots as coloured discs with their number, for Foxglove; those that are gone are taken away."""
    message = SceneUpdate()
    for robot in gone:
        message.deletions.add(id=robot_name(robot)).timestamp.FromNanoseconds(stamp_ns)
    for robot in robots:
        entity = message.entities.add(frame_id=base_link(robot), id=robot_name(robot))
        entity.timestamp.FromNanoseconds(stamp_ns)
        disc = entity.cylinders.add(bottom_scale=1.0, top_scale=0.7)
        disc.pose.orientation.w = 1.0
        disc.pose.position.z = _BODY_HEIGHT / 2
        disc.size.x = disc.size.y = 2 * max(radius, 0.3)
        disc.size.z = _BODY_HEIGHT
        disc.color.r, disc.color.g, disc.color.b = rgb(colours[robot])
        disc.color.a = 1.0
        text = entity.texts.add(text=str(robot), billboard=True, font_size=0.8)
        text.pose.position.z = 1.0
        text.pose.orientation.w = 1.0
        text.color.a = 1.0
    return message


def body_shape(radius: float, colour: str) -> npt.NDArray[Any]:
    """A robot as a small coloured ring with a nose, in its own frame, for viewers that draw no scene."""
    turn = np.linspace(0.0, math.tau, 24, endpoint=False)
    size = max(radius, 0.4)
    nose = np.linspace(0.0, 2.0 * size, 8)
    x = np.concatenate((size * np.cos(turn), nose))
    y = np.concatenate((size * np.sin(turn), np.zeros(len(nose))))
    return _painted(x, y, _BODY_HEIGHT, rgb(colour))


def body_points(
    poses: Iterable[tuple[int, Pose]], shapes: dict[int, npt.NDArray[Any]]
) -> npt.NDArray[Any]:
    """The shapes of all robots where they are; _COLOURED."""
    parts = [np.empty(0, dtype=_COLOURED)]
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
    """Points along each link (leader, follower, throughput as a share of its best); _COLOURED.

    Green when good, through orange at the threshold, red when nothing comes.
    """
    parts = []
    for one, other, share in links:
        along = np.linspace(0.0, 1.0, 24)
        x, y = one.x + along * (other.x - one.x), one.y + along * (other.y - one.y)
        parts.append(_painted(x, y, _LINK_HEIGHT, _quality(share, threshold_share)))
    return np.concatenate(parts) if parts else np.empty(0, dtype=_COLOURED)


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
    points = np.empty(len(x), dtype=_COLOURED)
    points["x"], points["y"], points["z"] = x, y, z
    for name, value in zip(("red", "green", "blue"), colour, strict=True):
        points[name] = round(255 * value)
    points["alpha"] = 255
    return points


def link(stamp_ns: int, **numbers: float) -> Any:
    """One robot's link; numbers: LINK_FIELDS."""
    message = Link(**numbers)
    message.timestamp.FromNanoseconds(stamp_ns)
    return message


def event(stamp_ns: int, robot: int, text: str, level: int) -> Any:
    """A line for the log panel."""
    message = Log(message=f"{robot_name(robot)}: {text}", name=robot_name(robot), level=level)  # type: ignore[arg-type]
    message.timestamp.FromNanoseconds(stamp_ns)
    return message
