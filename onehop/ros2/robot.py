"""The program "ros2": a robot that does what a ROS 2 node publishes on its /robot_<i>/cmd_vel.

What it knows besides (its scan, its odometry) the bridge publishes. It has no team, and says nothing on
the radio.
"""

import threading
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from onehop.robot import STANDSTILL, Action, Briefing, Percept, Program, Range, Twist
from onehop.ros2 import DEFAULT_ROUTER


@dataclass(frozen=True, slots=True)
class Ros2Parameters:
    """router: of ROS 2. domain: ROS_DOMAIN_ID. distro: "humble" has no type hashes, all later ones have.

    hold_s: how long a command is in force when no other one comes [s], in the mission's time.
    """

    router: str = DEFAULT_ROUTER
    domain: Annotated[int, Range(0, 232)] = 0
    distro: Literal["humble", "jazzy"] = "jazzy"
    hold_s: Annotated[float, Range(0.01, 60.0)] = 0.5


class Ros2Robot(Program):
    """One robot that is driven from outside."""

    Parameters: ClassVar[type[Any]] = Ros2Parameters
    reproducible: ClassVar[bool] = False

    def __init__(self, briefing: Briefing) -> None:
        from onehop.analysis.ros2.publications import DEPTH
        from onehop.analysis.ros2.types import typestore
        from onehop.ros2.node import RosNode, wait_for_router
        from onehop.ros2.rmw import Qos

        given: Ros2Parameters = briefing.parameters
        self._hold_ns = round(given.hold_s * 1e9)
        self._lock = threading.Lock()
        self._newest: Twist | None = None
        self._in_force, self._since_ns = STANDSTILL, 0
        session = wait_for_router(given.router)
        name, hashes = f"robot_{briefing.robot}", given.distro != "humble"
        self._node = RosNode(session, f"{name}_driver", typestore(), given.domain, hashes)
        self._node.subscribe(
            f"/{name}/cmd_vel", "geometry_msgs/msg/Twist", Qos(False, DEPTH), self._take
        )

    def _take(self, message: Any) -> None:
        """A command, in a thread of Zenoh."""
        with self._lock:
            self._newest = Twist(float(message.linear.x), float(message.angular.z))

    def step(self, percept: Percept) -> Action:
        with self._lock:
            newest, self._newest = self._newest, None
        if newest is not None:
            self._in_force, self._since_ns = newest, percept.time_ns
        elif percept.time_ns - self._since_ns > self._hold_ns:
            self._in_force = STANDSTILL
        return Action(self._in_force)
