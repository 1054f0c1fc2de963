"""The viewer channels of a log, made of its wire messages tick by tick.

Poses ten times a second, scans five times, links twice: enough for the eye. Every viewer message has the
log time of its tick.
"""

import math
from typing import Any

import numpy as np
from mcap.writer import Writer

from onehop.analysis.log import Log
from onehop.analysis.palette import robot_colours
from onehop.analysis.told import Gravity, events
from onehop.analysis.view import points, scene
from onehop.analysis.view.schemas import Log as TextLog
from onehop.analysis.view.schemas import schema_of
from onehop.contracts import topics
from onehop.contracts.beams import Beams
from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Action, Inbox, Observation, Truth
from onehop.contracts.topics import robot_name
from onehop.maps.map_file import load_map
from onehop.wire.log_reader import LoggedTick
from onehop.wire.log_writer import LOG_EPOCH_NS
from onehop.wire.logged import value_of
from onehop.wire.selection import Selected

POSE_S, SCAN_S, LINK_S, BODY_S = 0.1, 0.2, 0.5, 5.0
"""Simulated time between two messages of a kind [s]. A body moves with its frame; it is sent again for
those who start to look in the middle."""

WALL_STEP = 0.25
"""Distance between two points of a wall [m]."""

FARTHEST = 1e9
"""No map reaches so far [m]; clouds of points are float32."""

MOST_VALUES = 32
"""Values of a robot that are shown; the world takes no more."""

_LEVELS = {
    Gravity.DEBUG: TextLog.DEBUG,
    Gravity.INFO: TextLog.INFO,
    Gravity.WARNING: TextLog.WARNING,
    Gravity.ERROR: TextLog.ERROR,
}


class ViewerChannels:
    """Turns the wire messages of each tick into viewer messages."""

    def __init__(self, log: Log, writer: Writer) -> None:
        scenario = log.scenario
        self._writer = writer
        self._period_ns = log.period_ns
        self._strides = {
            s: max(1, round(s * 1e9 / log.period_ns)) for s in (POSE_S, SCAN_S, LINK_S, BODY_S)
        }
        self._in_lock_step = log.in_lock_step
        self._walls = load_map(scenario.map, log.bundle.files).segments
        bodies = dict(zip(log.robots, scenario.bodies, strict=True))
        self._radii = {robot: body.radius for robot, body in bodies.items()}
        self._colours = robot_colours(log.robots)
        self._beams = {robot: Beams(body) for robot, body in bodies.items()}
        self._shapes = {
            robot: points.body_shape(self._radii[robot], colour)
            for robot, colour in self._colours.items()
        }
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._heard: dict[int, tuple[float, float]] = {}
        self._present: frozenset[int] = frozenset()
        self.counts: dict[str, int] = {}

    def add(self, logged: LoggedTick) -> None:
        """The wire messages of one tick. Raises DecodeError for one that cannot have been recorded."""
        tick = logged.tick
        wire = {key: Selected(tick, key, data) for key, data in logged.messages}
        if topics.TRUTH not in wire:
            return
        truth = value_of(Truth, wire[topics.TRUTH])
        poses = self._poses(truth)
        stamp = LOG_EPOCH_NS + tick * self._period_ns
        if not self._channels:
            outline = points.wall_points(self._walls, WALL_STEP)
            self._put("/map/points", tick, scene.cloud(stamp, scene.MAP, outline))
            self._put("/map/walls", tick, scene.walls(stamp, self._walls))
        self._hear(wire, poses)
        self._add_poses(tick, stamp, poses)
        if tick % self._strides[SCAN_S] == 0:
            self._add_scans(tick, stamp, wire, poses)
        actions = {
            robot: value_of(Action, wire[topics.out(robot)], self._in_lock_step)
            for robot in poses
            if topics.out(robot) in wire
        }
        if tick % self._strides[LINK_S] == 0:
            self._add_links(tick, stamp, actions, poses)
        for told in events(truth, actions):
            level = _LEVELS[told.gravity]
            self._put("/events", tick, scene.event(stamp, told.who, told.text, level))

    def _poses(self, truth: Truth) -> dict[int, Pose]:
        for one in truth.present:
            numbers = (one.pose.x, one.pose.y, one.pose.heading)
            if one.robot not in self._colours or not all(abs(x) < FARTHEST for x in numbers):
                raise DecodeError(f"tick {truth.tick}, truth: no robot of the team is there")
        return {one.robot: one.pose for one in truth.present}

    def _put(self, topic: str, tick: int, message: Any) -> None:
        channel = self._channels.get(topic)
        if channel is None:
            name, data = schema_of(type(message))
            if name not in self._schemas:
                self._schemas[name] = self._writer.register_schema(name, "protobuf", data)
            channel = self._writer.register_channel(topic, "protobuf", self._schemas[name])
            self._channels[topic] = channel
        stamp = LOG_EPOCH_NS + tick * self._period_ns
        self._writer.add_message(channel, stamp, message.SerializeToString(), stamp, tick)
        self.counts[topic] = self.counts.get(topic, 0) + 1

    def _hear(self, wire: dict[str, Selected], poses: dict[int, Pose]) -> None:
        """Remember SNR and bit error rate of the last message that each robot received."""
        for robot in poses:
            message = wire.get(topics.rx(robot))
            if message is not None:
                for one in value_of(Inbox, message, self._in_lock_step).receptions:
                    self._heard[robot] = one.snr_db, one.bit_error_rate

    def _add_poses(self, tick: int, stamp: int, poses: dict[int, Pose]) -> None:
        present = frozenset(poses)
        gone, came = sorted(self._present - present), present - self._present
        self._present = present
        if tick % self._strides[POSE_S] and not gone and not came:
            return
        placed = sorted(poses.items())
        self._put("/tf", tick, scene.transforms(stamp, placed))
        for robot, pose in placed:
            self._put(f"/{robot_name(robot)}/pose", tick, scene.pose_in_map(stamp, pose))
        if gone or came or tick % self._strides[BODY_S] == 0:
            discs = scene.bodies(stamp, sorted(poses), self._radii, self._colours, gone)
            self._put("/robots/bodies", tick, discs)
        rings = points.body_points(placed, self._shapes)
        self._put("/robots/points", tick, scene.cloud(stamp, scene.MAP, rings))

    def _add_scans(
        self, tick: int, stamp: int, wire: dict[str, Selected], poses: dict[int, Pose]
    ) -> None:
        for robot in sorted(poses):
            message = wire.get(topics.obs(robot))
            if message is None:
                continue
            ranges, beams = value_of(Observation, message).scan, self._beams[robot]
            if len(ranges) != len(beams.angles):
                raise DecodeError(f"tick {tick}, {message.key}: a scan of {len(ranges)} beams")
            name = robot_name(robot)
            hits = scene.scan_points(stamp, robot, ranges, beams.directions.astype(np.float32))
            self._put(f"/{name}/scan_points", tick, hits)
            self._put(f"/{name}/scan", tick, scene.laser_scan(stamp, robot, ranges, beams.angles))

    def _add_links(
        self, tick: int, stamp: int, actions: dict[int, Action], poses: dict[int, Pose]
    ) -> None:
        links = []
        for robot, action in sorted(actions.items()):
            if action.values:
                shown = scene.values(stamp, dict(list(action.values.items())[:MOST_VALUES]))
                self._put(f"/{robot_name(robot)}/values", tick, shown)
            status = action.status
            if status is None:
                continue
            leader = poses.get(status.leader)
            if leader is None or status.leader == robot:
                continue
            pose = poses[robot]
            snr_db, bit_error_rate = self._heard.get(robot, (math.nan, math.nan))
            message = scene.link(
                stamp, throughput_bps=status.throughput_bps, threshold_bps=status.threshold_bps,
                snr_db=snr_db, bit_error_rate=bit_error_rate, k_rho_per_s=status.k_rho,
                error_m=status.error, distance_m=math.hypot(pose.x - leader.x, pose.y - leader.y),
            )  # fmt: skip
            self._put(f"/{robot_name(robot)}/link", tick, message)
            best = 2.0 * status.threshold_bps
            links.append((leader, pose, status.throughput_bps / best if best > 0 else 1.0))
        self._put("/links/points", tick, scene.cloud(stamp, scene.MAP, points.link_points(links)))
