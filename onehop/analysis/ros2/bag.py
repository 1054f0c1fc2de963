"""Write a log as a rosbag2 folder: metadata.yaml, and an MCAP file of profile ros2."""

import os
import tempfile
from pathlib import Path
from typing import Any, Literal

from onehop.analysis.log import Log
from onehop.analysis.ros2.messages import RosMessages, ros_name
from onehop.analysis.ros2.occupancy import occupancy
from onehop.analysis.ros2.types import LINK, typestore
from onehop.analysis.told import events
from onehop.contracts import topics
from onehop.contracts.beams import Beams
from onehop.contracts.errors import DecodeError, InputError
from onehop.contracts.messages import Action, Inbox, Observation, Reception, Truth
from onehop.maps.map_file import load_map
from onehop.wire.audit import Audit
from onehop.wire.log_reader import LoggedTick, forged
from onehop.wire.log_writer import LOG_EPOCH_NS
from onehop.wire.logged import value_of
from onehop.wire.output_folder import explained
from onehop.wire.selection import Selected

VERSION: Literal[9] = 9
"""Of the folder's metadata (Jazzy and later); Humble and Iron read it after `ros2 bag reindex`."""

REMEDY = "a new folder, where one can be made"


def write_bag(log: Log, out: Path) -> tuple[dict[str, int], list[str]]:
    """Write a log as a new folder, whole or not at all.

    Returns messages by topic, and the flaws of the log (audit.py). Raises InputError for a folder that
    is there already, LogError when the log is damaged.
    """
    store = typestore()
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    if out.exists():
        raise InputError(str(out), "exists already", REMEDY)
    audit = Audit(log.file)
    with explained(out, REMEDY):
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out.parent, prefix=".onehop-") as draft:
            folder = Path(draft) / out.name
            writer = Writer(folder, version=VERSION, storage_plugin=StoragePlugin.MCAP)
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
            with writer:
                bag = _Bag(log, store, writer)
                try:
                    for tick in audit.ticks():
                        bag.add(tick)
                except DecodeError as error:
                    raise forged(log.path, error) from None
            os.rename(folder, out)
    return dict(sorted(bag.counts.items())), audit.flaws


class _Bag:
    """Turns the wire messages of each tick into ROS messages. All have the stamp of their tick."""

    def __init__(self, log: Log, store: Any, writer: Any) -> None:
        self._log = log
        self._store = store
        self._writer = writer
        self._make = RosMessages(store)
        self._beams = {robot: Beams(log.scenario.body_of(robot)) for robot in log.robots}
        self._connections: dict[str, Any] = {}
        self._heard: dict[int, Reception] = {}
        self._modes: dict[int, str] = {}
        self.counts: dict[str, int] = {}

    def add(self, logged: LoggedTick) -> None:
        """The wire messages of one tick. Raises DecodeError for one that cannot have been recorded."""
        tick = logged.tick
        wire = {key: Selected(tick, key, data) for key, data in logged.messages}
        if topics.TRUTH not in wire:
            return
        truth = value_of(Truth, wire[topics.TRUTH])
        if any(one.robot not in self._beams for one in truth.present):
            raise DecodeError(f"tick {tick}, truth: a robot that is not in the team")
        at_ns = LOG_EPOCH_NS + tick * self._log.period_ns
        make = self._make
        if not self.counts:
            ground = occupancy(load_map(self._log.scenario.map, self._log.bundle.files))
            self._put("/map", "nav_msgs/msg/OccupancyGrid", at_ns, make.grid(at_ns, ground))
            fixed = make.fixed_transforms(at_ns, self._log.robots)
            self._put("/tf_static", "tf2_msgs/msg/TFMessage", at_ns, fixed)
        self._put("/clock", "rosgraph_msgs/msg/Clock", at_ns, make.clock(at_ns))
        placed = [(one.robot, one.pose) for one in truth.present]
        self._put("/tf", "tf2_msgs/msg/TFMessage", at_ns, make.transforms(at_ns, placed))
        actions = {}
        for one in truth.present:
            robot, name = one.robot, f"/{ros_name(one.robot)}"
            odometry = make.odometry(at_ns, robot, one.pose, one.twist)
            self._put(f"{name}/odom", "nav_msgs/msg/Odometry", at_ns, odometry)
            if (seen := wire.get(topics.obs(robot))) is not None:
                self._add_scan(at_ns, robot, value_of(Observation, seen), seen)
            if (heard := wire.get(topics.rx(robot))) is not None:
                for reception in value_of(Inbox, heard, self._log.in_lock_step).receptions:
                    self._heard[robot] = reception
            if (said := wire.get(topics.out(robot))) is not None:
                actions[robot] = value_of(Action, said, self._log.in_lock_step)
                self._add_action(at_ns, robot, actions[robot])
        for told in events(truth, actions):
            self._put("/events", "rcl_interfaces/msg/Log", at_ns, make.log(at_ns, told))

    def _add_scan(self, at_ns: int, robot: int, seen: Observation, wire: Selected) -> None:
        beams = self._beams[robot]
        if len(seen.scan) != len(beams.angles):
            raise DecodeError(f"tick {wire.tick}, {wire.key}: a scan of {len(seen.scan)} beams")
        scan = self._make.scan(at_ns, robot, seen.scan, beams, self._log.period_ns / 1e9)
        self._put(f"/{ros_name(robot)}/scan", "sensor_msgs/msg/LaserScan", at_ns, scan)

    def _add_action(self, at_ns: int, robot: int, action: Action) -> None:
        name, make, status = f"/{ros_name(robot)}", self._make, action.status
        self._put(f"{name}/cmd_vel", "geometry_msgs/msg/Twist", at_ns, make.twist(action.twist))
        if status is None:
            return
        mode = status.mode.value
        if self._modes.get(robot) != mode:
            self._modes[robot] = mode
            self._put(f"{name}/mode", "std_msgs/msg/String", at_ns, make.word(mode))
        if status.leader not in (robot, 0):
            link = make.link(at_ns, robot, status, self._heard.get(robot))
            self._put(f"{name}/link", LINK, at_ns, link)

    def _put(self, topic: str, kind: str, at_ns: int, message: Any) -> None:
        connection = self._connections.get(topic)
        if connection is None:
            connection = self._connections[topic] = self._writer.add_connection(
                topic, kind, typestore=self._store, offered_qos_profiles=[_qos(topic)]
            )
        self._writer.write(connection, at_ns, self._store.serialize_cdr(message, kind))
        self.counts[topic] = self.counts.get(topic, 0) + 1


def _qos(topic: str) -> Any:
    """What a publisher of this topic offers: reliable, and kept for late listeners where it lasts."""
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )

    never = QosTime(9223372036, 854775807)
    lasts = topic in ("/map", "/tf_static") or topic.endswith("/mode")
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if lasts else 10,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if lasts else QosDurability.VOLATILE,
        deadline=never,
        lifespan=never,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=never,
        avoid_ros_namespace_conventions=False,
    )
