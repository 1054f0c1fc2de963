"""Viewer messages: coordinate frames, poses, scans, clouds of points, scenes, links, values, events.

Frames: `map`, and `robot-<i>/base_link` with x forward, y left, z up; SI units, radians, quaternions.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from onehop.analysis.palette import rgb
from onehop.analysis.view.schemas import (
    FrameTransforms,
    LaserScan,
    Link,
    Log,
    PointCloud,
    PoseInFrame,
    SceneUpdate,
    Values,
)
from onehop.contracts.geometry import Pose
from onehop.contracts.printable import printable
from onehop.contracts.topics import robot_name

MAP = "map"
_FLOAT32 = 7
_UINT8 = 1
"""foxglove.PackedElementField.NumericType."""

BODY_HEIGHT = 0.3
_SCAN_HEIGHT = 0.2
"""Heights above the ground at which things are drawn [m]."""

Points = npt.NDArray[np.float32]


def base_link(robot: int) -> str:
    """Coordinate frame of a robot."""
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
    """A point cloud; points: (n, 3) float32 [m], or points.COLOURED."""
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
    stamp_ns: int, robots: Iterable[int], radii: dict[int, float], colours: dict[int, str],
    gone: Iterable[int],
) -> Any:  # fmt: skip
    """Robots as coloured discs with their number, for Foxglove; those that are gone are taken away."""
    message = SceneUpdate()
    for robot in gone:
        message.deletions.add(id=robot_name(robot)).timestamp.FromNanoseconds(stamp_ns)
    for robot in robots:
        entity = message.entities.add(frame_id=base_link(robot), id=robot_name(robot))
        entity.timestamp.FromNanoseconds(stamp_ns)
        disc = entity.cylinders.add(bottom_scale=1.0, top_scale=0.7)
        disc.pose.orientation.w = 1.0
        disc.pose.position.z = BODY_HEIGHT / 2
        disc.size.x = disc.size.y = 2 * max(radii[robot], 0.3)
        disc.size.z = BODY_HEIGHT
        disc.color.r, disc.color.g, disc.color.b = rgb(colours[robot])
        disc.color.a = 1.0
        text = entity.texts.add(text=str(robot), billboard=True, font_size=0.8)
        text.pose.position.z = 1.0
        text.pose.orientation.w = 1.0
        text.color.a = 1.0
    return message


def link(stamp_ns: int, **numbers: float) -> Any:
    """One robot's link; numbers: LINK_FIELDS."""
    message = Link(**numbers)
    message.timestamp.FromNanoseconds(stamp_ns)
    return message


def values(stamp_ns: int, shown: Mapping[str, float]) -> Any:
    """What a program shows of itself, by name."""
    message = Values()
    message.timestamp.FromNanoseconds(stamp_ns)
    for name, value in shown.items():
        message.values.add(name=printable(name), value=value)
    return message


def event(stamp_ns: int, name: str, text: str, level: int) -> Any:
    """A line for the log panel. name: of the process that it is about."""
    message = Log(message=f"{name}: {text}", name=name, level=level)  # type: ignore[arg-type]
    message.timestamp.FromNanoseconds(stamp_ns)
    return message
