"""Our values as ROS 2 messages: frames and units by REP 103 and 105, scans by REP 117.

Frames: map -> robot_<i>/odom (the same, since odometry here is ground truth) -> robot_<i>/base_link
-> robot_<i>/laser (the same).
"""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from onehop.analysis.ros2.occupancy import Occupancy
from onehop.analysis.ros2.types import LINK
from onehop.analysis.told import Gravity, Told
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Reception
from onehop.contracts.team import Status

MAP = "map"

_LEVELS = {Gravity.DEBUG: 10, Gravity.INFO: 20, Gravity.WARNING: 30, Gravity.ERROR: 40}
"""Of rcl_interfaces/msg/Log."""


def ros_name(robot: int) -> str:
    """Namespace of a robot: names in ROS have no hyphen."""
    return f"robot_{robot}"


class RosMessages:
    """Makes messages. store: a rosbags typestore."""

    def __init__(self, store: Any) -> None:
        types = store.types
        self._type = {name.rpartition("/")[2]: types[name] for name in _TYPES}
        no_covariance = np.zeros(36)
        make = self._type
        self._origin = make["Vector3"](0.0, 0.0, 0.0)
        self._straight = make["Quaternion"](0.0, 0.0, 0.0, 1.0)
        self._no_covariance = no_covariance

    def stamp(self, at_ns: int) -> Any:
        """builtin_interfaces/msg/Time"""
        return self._type["Time"](at_ns // 1_000_000_000, at_ns % 1_000_000_000)

    def clock(self, at_ns: int) -> Any:
        """rosgraph_msgs/msg/Clock"""
        return self._type["Clock"](self.stamp(at_ns))

    def transforms(self, at_ns: int, poses: Iterable[tuple[int, Pose]]) -> Any:
        """tf2_msgs/msg/TFMessage: odom -> base_link of every robot present."""
        make = self._type
        return make["TFMessage"](
            [
                make["TransformStamped"](
                    self._header(at_ns, f"{ros_name(robot)}/odom"),
                    f"{ros_name(robot)}/base_link",
                    make["Transform"](make["Vector3"](pose.x, pose.y, 0.0), self._turn(pose.heading)),
                )
                for robot, pose in poses
            ]
        )

    def fixed_transforms(self, at_ns: int, robots: Iterable[int]) -> Any:
        """tf2_msgs/msg/TFMessage: map -> odom and base_link -> laser of every robot."""
        make = self._type
        nothing = make["Transform"](self._origin, self._straight)
        return make["TFMessage"](
            [
                make["TransformStamped"](self._header(at_ns, parent), child, nothing)
                for robot in robots
                for parent, child in (
                    (MAP, f"{ros_name(robot)}/odom"),
                    (f"{ros_name(robot)}/base_link", f"{ros_name(robot)}/laser"),
                )
            ]
        )

    def grid(self, at_ns: int, ground: Occupancy) -> Any:
        """nav_msgs/msg/OccupancyGrid"""
        make, frame = self._type, ground.frame
        rows, columns = ground.cells.shape
        origin = make["Pose"](make["Point"](frame.x, frame.y, 0.0), self._turn(frame.yaw))
        about = make["MapMetaData"](self.stamp(at_ns), frame.cell, columns, rows, origin)
        return make["OccupancyGrid"](self._header(at_ns, MAP), about, ground.cells.reshape(-1))

    def odometry(self, at_ns: int, robot: int, pose: Pose, twist: Twist) -> Any:
        """nav_msgs/msg/Odometry, exact: all covariances are 0."""
        make = self._type
        where = make["Pose"](make["Point"](pose.x, pose.y, 0.0), self._turn(pose.heading))
        return make["Odometry"](
            self._header(at_ns, f"{ros_name(robot)}/odom"),
            f"{ros_name(robot)}/base_link",
            make["PoseWithCovariance"](where, self._no_covariance),
            make["TwistWithCovariance"](self.twist(twist), self._no_covariance),
        )

    def twist(self, twist: Twist) -> Any:
        """geometry_msgs/msg/Twist"""
        make = self._type
        return make["Twist"](make["Vector3"](twist.v, 0.0, 0.0), make["Vector3"](0.0, 0.0, twist.w))

    def scan(
        self, at_ns: int, robot: int, ranges: npt.NDArray[np.float32], beams: Beams, period_s: float
    ) -> Any:
        """sensor_msgs/msg/LaserScan. ranges: (n_beams,) [m], +inf where nothing is in range."""
        return self._type["LaserScan"](
            self._header(at_ns, f"{ros_name(robot)}/laser"),
            -beams.half_view, beams.half_view, beams.spacing, 0.0, period_s, 0.0, beams.range,
            ranges.astype(np.float32, copy=False), np.empty(0, dtype=np.float32),
        )  # fmt: skip

    def link(self, at_ns: int, robot: int, status: Status, heard: Reception | None) -> Any:
        """onehop_msgs/msg/Link (types.py). heard: the last message that arrived."""
        snr_db, bit_error_rate, hops = (
            (math.nan, math.nan, 0)
            if heard is None
            else (heard.snr_db, heard.bit_error_rate, heard.hops)
        )
        return self._type["Link"](
            self._header(at_ns, f"{ros_name(robot)}/base_link"),
            robot, status.leader, max(0.0, status.throughput_bps), status.threshold_bps, snr_db,
            bit_error_rate, hops, status.k_rho, status.error,
        )  # fmt: skip

    def word(self, text: str) -> Any:
        """std_msgs/msg/String"""
        return self._type["String"](text)

    def log(self, at_ns: int, told: Told) -> Any:
        """rcl_interfaces/msg/Log"""
        who = told.who.replace("-", "_")
        return self._type["Log"](self.stamp(at_ns), _LEVELS[told.gravity], who, told.text, "", "", 0)

    def _header(self, at_ns: int, frame: str) -> Any:
        return self._type["Header"](self.stamp(at_ns), frame)

    def _turn(self, heading: float) -> Any:
        return self._type["Quaternion"](0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))


_TYPES = (
    "builtin_interfaces/msg/Time", "std_msgs/msg/Header", "std_msgs/msg/String",
    "rosgraph_msgs/msg/Clock", "geometry_msgs/msg/Vector3", "geometry_msgs/msg/Quaternion",
    "geometry_msgs/msg/Point", "geometry_msgs/msg/Pose", "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/PoseWithCovariance", "geometry_msgs/msg/TwistWithCovariance",
    "geometry_msgs/msg/Transform", "geometry_msgs/msg/TransformStamped", "tf2_msgs/msg/TFMessage",
    "nav_msgs/msg/MapMetaData", "nav_msgs/msg/OccupancyGrid", "nav_msgs/msg/Odometry",
    "sensor_msgs/msg/LaserScan", "rcl_interfaces/msg/Log", LINK,
)  # fmt: skip
