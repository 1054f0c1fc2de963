"""What a team publishes in each tick, as ROS 2 topics: the same for a bag and for nodes that listen."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from onehop.analysis.log import Log
from onehop.analysis.ros2.messages import RosMessages, ros_name
from onehop.analysis.ros2.occupancy import occupancy
from onehop.analysis.ros2.types import LINK
from onehop.analysis.told import events
from onehop.contracts import topics
from onehop.contracts.beams import Beams
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Action, Inbox, Observation, Reception, Truth
from onehop.maps.map_file import load_map
from onehop.wire.log_reader import LoggedTick
from onehop.wire.log_writer import LOG_EPOCH_NS
from onehop.wire.logged import value_of
from onehop.wire.selection import Selected

LASTING_DEPTH, DEPTH = 1, 10
"""How many messages a publisher keeps, of topics that last and of others."""

DRIVEN_BY_ROS = ("ros2", "onehop.ros2.robot:Ros2Robot")
"""Names of the program whose robots hear their cmd_vel from others: theirs is not published."""


class Publication(NamedTuple):
    """One message. kind: its type. at_ns: the stamp of its tick. message: a value of that type."""

    topic: str
    kind: str
    at_ns: int
    message: Any


def lasts(topic: str) -> bool:
    """Whether late listeners get what was published last (transient local)."""
    return topic in ("/map", "/tf_static") or topic.endswith("/mode")


class Publications:
    """Turns the wire messages of ticks into ROS messages. All have the stamp of their tick."""

    def __init__(self, log: Log, store: Any) -> None:
        self._log = log
        self._make = RosMessages(store)
        self._beams = {robot: Beams(log.scenario.body_of(robot)) for robot in log.robots}
        self._heard: dict[int, Reception] = {}
        self._modes: dict[int, str] = {}
        self._driven = {
            robot for robot in log.robots if log.scenario.program_of(robot)[0] in DRIVEN_BY_ROS
        }
        self._has_begun = False

    def of(self, logged: LoggedTick, whole: bool = True) -> Iterator[Publication]:
        """Of one tick. Raises DecodeError for what cannot have been recorded.

        whole: with what the next tick will say anew; without it events and changes alone.
        """
        tick = logged.tick
        wire = {key: Selected(tick, key, data) for key, data in logged.messages}
        if topics.TRUTH not in wire:
            return
        truth = value_of(Truth, wire[topics.TRUTH])
        if any(one.robot not in self._beams for one in truth.present):
            raise DecodeError(f"tick {tick}, truth: a robot that is not in the team")
        at_ns = LOG_EPOCH_NS + tick * self._log.period_ns
        make = self._make
        if not self._has_begun:
            self._has_begun = True
            yield from self._once(at_ns)
        if whole:
            yield Publication("/clock", "rosgraph_msgs/msg/Clock", at_ns, make.clock(at_ns))
            placed = [(one.robot, one.pose) for one in truth.present]
            yield Publication("/tf", "tf2_msgs/msg/TFMessage", at_ns, make.transforms(at_ns, placed))
        actions = {}
        for one in truth.present:
            robot = one.robot
            if whole:
                odometry = make.odometry(at_ns, robot, one.pose, one.twist)
                yield Publication(f"/{ros_name(robot)}/odom", "nav_msgs/msg/Odometry", at_ns, odometry)
                if (seen := wire.get(topics.obs(robot))) is not None:
                    yield self._scan(at_ns, robot, value_of(Observation, seen), seen)
            if (heard := wire.get(topics.rx(robot))) is not None:
                for reception in value_of(Inbox, heard, self._log.in_lock_step).receptions:
                    self._heard[robot] = reception
            if (said := wire.get(topics.out(robot))) is not None:
                actions[robot] = value_of(Action, said, self._log.in_lock_step)
                yield from self._mode(at_ns, robot, actions[robot])
                if whole:
                    yield from self._driving(at_ns, robot, actions[robot])
        for told in events(truth, actions):
            yield Publication("/events", "rcl_interfaces/msg/Log", at_ns, make.log(at_ns, told))

    def _once(self, at_ns: int) -> Iterator[Publication]:
        ground = occupancy(load_map(self._log.scenario.map, self._log.bundle.files))
        yield Publication("/map", "nav_msgs/msg/OccupancyGrid", at_ns, self._make.grid(at_ns, ground))
        fixed = self._make.fixed_transforms(at_ns, self._log.robots)
        yield Publication("/tf_static", "tf2_msgs/msg/TFMessage", at_ns, fixed)

    def _scan(self, at_ns: int, robot: int, seen: Observation, wire: Selected) -> Publication:
        beams = self._beams[robot]
        if len(seen.scan) != len(beams.angles):
            raise DecodeError(f"tick {wire.tick}, {wire.key}: a scan of {len(seen.scan)} beams")
        scan = self._make.scan(at_ns, robot, seen.scan, beams, self._log.period_ns / 1e9)
        return Publication(f"/{ros_name(robot)}/scan", "sensor_msgs/msg/LaserScan", at_ns, scan)

    def _driving(self, at_ns: int, robot: int, action: Action) -> Iterator[Publication]:
        name, make, status = f"/{ros_name(robot)}", self._make, action.status
        if robot not in self._driven:
            twist = make.twist(action.twist)
            yield Publication(f"{name}/cmd_vel", "geometry_msgs/msg/Twist", at_ns, twist)
        if status is not None and status.leader not in (robot, 0):
            link = make.link(at_ns, robot, status, self._heard.get(robot))
            yield Publication(f"{name}/link", LINK, at_ns, link)

    def _mode(self, at_ns: int, robot: int, action: Action) -> Iterator[Publication]:
        """Its mode, when it changes."""
        mode = None if action.status is None else action.status.mode.value
        if mode is not None and mode != self._modes.get(robot):
            self._modes[robot] = mode
            topic = f"/{ros_name(robot)}/mode"
            yield Publication(topic, "std_msgs/msg/String", at_ns, self._make.word(mode))
