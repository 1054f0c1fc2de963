"""An exported bag, read back by rosbags and by the mcap library: types, values, frames, stamps, QoS."""

import math
import runpy
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from rosbags.typesys import get_types_from_msg

from onehop.analysis import Log
from onehop.analysis.ros2.bag import write_bag
from onehop.analysis.ros2.occupancy import FREE, OCCUPIED, occupancy
from onehop.analysis.ros2.types import LINK, typestore
from onehop.contracts.errors import InputError
from onehop.maps.map_file import load_map
from onehop.maps.walls import segment_distances
from onehop.wire.log_writer import LOG_EPOCH_NS
from tests.onehop.command_line import onehop
from world_server.core.world import KILLED

from .conftest import LEADER, SUCCESSOR

Messages = dict[str, list[tuple[int, Any]]]


@pytest.fixture(scope="module")
def bag(log: Log, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bag") / "bag"
    counts, flaws = write_bag(log, path)
    assert flaws == []
    with Reader(path) as reader:
        assert {name: topic.msgcount for name, topic in reader.topics.items()} == counts
    return path


@pytest.fixture(scope="module")
def read(bag: Path) -> Messages:
    """(tick, message) by topic, decoded by the definitions in the bag alone."""
    found: Messages = {}
    with AnyReader([bag]) as reader:
        for connection, stamp, data in reader.messages():
            tick, rest = divmod(stamp - LOG_EPOCH_NS, 50_000_000)
            assert rest == 0
            message = reader.deserialize(data, connection.msgtype)
            found.setdefault(connection.topic, []).append((tick, message))
    return found


def stamp_of(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def test_odometry_and_frames_are_the_poses_of_the_log(read: Messages, log: Log) -> None:
    poses = log.table("poses")
    for robot in log.robots:
        own, odometry = poses.of(robot), read[f"/robot_{robot}/odom"]
        assert [tick for tick, _ in odometry] == own["tick"].tolist()
        places = [(m.pose.pose.position.x, m.pose.pose.position.y) for _, m in odometry]
        assert places == list(own.rows("x", "y"))
        turns = [
            2 * math.atan2(m.pose.pose.orientation.z, m.pose.pose.orientation.w) for _, m in odometry
        ]
        assert np.allclose(turns, own["heading"], atol=1e-12)
        speeds = [(m.twist.twist.linear.x, m.twist.twist.angular.z) for _, m in odometry]
        assert speeds == list(own.rows("v", "w"))
        assert {m.header.frame_id for _, m in odometry} == {f"robot_{robot}/odom"}
    tick, last = read["/tf"][-1]
    here = poses.where(poses["tick"] == tick)
    assert [(t.child_frame_id, t.transform.translation.x) for t in last.transforms] == [
        (f"robot_{robot}/base_link", x) for robot, x in here.rows("robot", "x")
    ]


def test_the_frames_are_one_tree(read: Messages, log: Log) -> None:
    parents: dict[str, set[str]] = defaultdict(set)
    for topic in ("/tf", "/tf_static"):
        for _, message in read[topic]:
            for one in message.transforms:
                parents[one.child_frame_id].add(one.header.frame_id)
    assert all(len(of) == 1 for of in parents.values())
    assert len(parents) == 3 * len(log.robots)
    roots = {parent for of in parents.values() for parent in of} - set(parents)
    assert roots == {"map"}
    assert len(read["/tf_static"]) == 1


def test_scans_are_those_of_the_log(read: Messages, log: Log) -> None:
    scans = log.table("scans")
    own = scans.of(SUCCESSOR)["ranges"]
    sent = [message for _, message in read[f"/robot_{SUCCESSOR}/scan"]]
    assert np.array_equal(np.array([message.ranges for message in sent]), own)
    beams = own.shape[1]
    for one in (sent[0], sent[-1]):
        assert one.angle_min + (beams - 1) * one.angle_increment == pytest.approx(one.angle_max)
        assert one.header.frame_id == f"robot_{SUCCESSOR}/laser"
        assert one.range_max == log.scenario.robot.laser_range
    assert np.isinf(own).any()  # what nothing is in range of is +inf (REP 117)


def test_what_robots_say_is_what_they_said(read: Messages, log: Log) -> None:
    status = log.table("status")
    for robot in log.robots:
        own = status.of(robot)
        twists = [(m.linear.x, m.angular.z) for _, m in read[f"/robot_{robot}/cmd_vel"]]
        assert twists == list(own.rows("v", "w"))
        modes = own["mode"].tolist()
        changes = [new for old, new in zip([None, *modes], modes, strict=False) if new != old]
        assert [m.data for _, m in read[f"/robot_{robot}/mode"]] == changes
        follows = own.where((own["leader"] != robot) & (own["leader"] != 0))
        links = read.get(f"/robot_{robot}/link", [])
        assert [tick for tick, _ in links] == follows["tick"].tolist()
        said = [(m.leader, m.k_rho, m.error_m, m.threshold_bps) for _, m in links]
        assert said == list(follows.rows("leader", "k_rho", "error", "threshold_bps"))
    heard = log.table("receptions").of(SUCCESSOR)
    tick, link = read[f"/robot_{SUCCESSOR}/link"][-1]
    before = heard.where(heard["tick"] <= tick)
    assert (link.snr_db, link.hops) == (before["snr_db"][-1], before["hops"][-1])


def test_events_tell_of_the_kill(read: Messages) -> None:
    said = [(m.level, m.name, m.msg) for _, m in read["/events"]]
    assert (30, f"robot_{LEADER}", f"gone, {KILLED}") in said
    assert any(name == "world" and text.startswith("fault: kill") for _, name, text in said)


def test_stamps_increase_and_are_those_of_the_clock(read: Messages, log: Log) -> None:
    for topic, messages in read.items():
        ticks = [tick for tick, _ in messages]
        assert ticks == sorted(ticks), topic
        if hasattr(messages[0][1], "header"):
            for tick, message in messages:
                assert stamp_of(message) == LOG_EPOCH_NS + tick * log.period_ns
    clock = [m.clock.sec * 1_000_000_000 + m.clock.nanosec for _, m in read["/clock"]]
    assert np.all(np.diff(clock) == log.period_ns)


def test_the_map_is_the_ground(read: Messages, log: Log) -> None:
    ((_, grid),) = read["/map"]
    walls = load_map(log.scenario.map, log.bundle.files)
    cells = grid.data.reshape(grid.info.height, grid.info.width)
    assert np.array_equal(cells, occupancy(walls).cells)
    assert set(np.unique(cells)) == {FREE, OCCUPIED}
    size, origin = grid.info.resolution, grid.info.origin.position
    draw = np.random.default_rng(1)
    points = draw.uniform((0.0, 0.0), (30.0, 20.0), (2000, 2))
    column, row = ((points - (origin.x, origin.y)) / size).astype(int).T
    shown, clearance = cells[row, column], walls.clearance(points)
    assert np.all(shown[clearance > size * math.sqrt(2.0)] == FREE)
    deep = walls.ground.solid(points) & (segment_distances(points, walls.segments).min(axis=1) > size)
    assert np.any(deep)
    assert np.all(shown[deep] == OCCUPIED)
    assert cells[160, 150] == OCCUPIED  # a corner of the obstacle


def test_the_file_is_what_mcap_and_rosbag2_ask_for(bag: Path) -> None:
    with (bag / "bag.mcap").open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert summary is not None
        for schema in summary.schemas.values():
            assert schema.encoding == "ros2msg"
            assert get_types_from_msg(schema.data.decode(), schema.name)
        for channel in summary.channels.values():
            assert channel.message_encoding == "cdr"
            assert "reliability: reliable" in channel.metadata["offered_qos_profiles"]
        assert summary.statistics is not None
        assert summary.statistics.message_count == sum(1 for _ in reader.iter_messages())
        assert all(index.message_index_offsets for index in summary.chunk_indexes)
        assert [record.name for record in reader.iter_metadata()] == ["rosbag2"]
    metadata = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert (metadata["version"], metadata["storage_identifier"]) == (9, "mcap")
    assert metadata["relative_file_paths"] == ["bag.mcap"]
    with Reader(bag) as reader:
        lasting = {c.topic for c in reader.connections if "TRANSIENT_LOCAL" in str(c.ext)}
        assert {"/map", "/tf_static"} < lasting
        assert "/robot_1/odom" not in lasting


def test_type_hashes_are_those_of_ros() -> None:
    known = {
        "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
        "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
        "sensor_msgs/msg/LaserScan": "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828",
    }
    assert {name: typestore().hash_rihs01(name) for name in known} == {
        name: f"RIHS01_{value}" for name, value in known.items()
    }
    assert LINK in typestore().types


def test_the_command_writes_a_new_folder_or_nothing(log_path: Path, tmp_path: Path) -> None:
    done = onehop("export", log_path, "--to", "ros2", "-o", tmp_path / "a" / "bag")
    assert done.returncode == 0, done.stderr
    assert "messages on" in done.stdout
    again = onehop("export", log_path, "--to", "ros2", "-o", tmp_path / "a" / "bag")
    assert again.returncode == 2
    assert again.stderr.endswith("bag: exists already; a new folder, where one can be made\n")
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["bag"]


def test_without_rosbags_one_line_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    typestore.cache_clear()
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(InputError, match="rosbags is not installed"):
        typestore()


def test_an_example_finds_every_scan_on_a_wall_or_a_robot_and_draws_it(
    bag: Path, log: Log, tmp_path: Path
) -> None:
    """By frames and messages of the bag alone; what it finds is compared with the map."""
    example = runpy.run_path(str(Path(__file__).parents[3] / "examples" / "draw_bag.py"))
    moment = example["Moment"](bag, 1.0)
    robots = [moment.in_map(f"robot_{robot}/base_link")[:2] for robot in log.robots]
    walls = load_map(log.scenario.map, log.bundle.files).segments
    hits = [p for robot in log.robots for p in moment.points(moment.newest[f"/robot_{robot}/scan"])]
    assert hits
    for hit in hits:
        of_robots = min(abs(math.dist(hit, robot) - log.scenario.robot.radius) for robot in robots)
        assert min(of_robots, segment_distances(hit[None, :], walls).min()) < 0.01
    example["draw"](moment, tmp_path / "bag.png")
    assert (tmp_path / "bag.png").read_bytes().startswith(b"\x89PNG")
