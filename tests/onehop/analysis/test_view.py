"""The viewer layer: every channel can be decoded, and the wire channels stay what they were."""

import math
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from google.protobuf import descriptor_pool, message_factory
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.reader import make_reader

from onehop.analysis import Log, open_log
from onehop.analysis.view.layer import write_view
from onehop.analysis.view.schemas import LINK_FIELDS
from onehop.wire.log_reader import LogFile, digest
from onehop.wire.log_writer import LOG_EPOCH_NS

from .conftest import LEADER


@pytest.fixture(scope="module")
def viewed(log: Log, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("view") / "view.mcap"
    write_view(log, path)
    return path


def decoded(path: Path) -> list[tuple[str, int, Any]]:
    """(topic, tick, message) of every viewer channel, by nothing but the schema in the file."""
    found = []
    classes: dict[int, Any] = {}
    with path.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            if schema is None:
                continue
            assert (schema.encoding, channel.message_encoding) == ("protobuf", "protobuf")
            if schema.id not in classes:
                classes[schema.id] = class_of(schema.name, schema.data)
            content = classes[schema.id].FromString(message.data)
            assert message.log_time == message.publish_time
            found.append((channel.topic, message.sequence, content))
    return found


def class_of(name: str, data: bytes) -> Any:
    pool = descriptor_pool.DescriptorPool()
    for file in FileDescriptorSet.FromString(data).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


def test_the_wire_channels_are_untouched(log_path: Path, viewed: Path) -> None:
    assert digest(LogFile(viewed)) == digest(LogFile(log_path))
    assert open_log(viewed).summary == open_log(log_path).summary


def test_every_topic_of_the_design_is_there(viewed: Path, log: Log) -> None:
    topics = {topic for topic, _, _ in decoded(viewed)}
    each = {f"/robot-{robot}/{name}" for robot in log.robots for name in ("pose", "scan", "scan_points")}
    assert topics >= each | {"/tf", "/map/points", "/map/walls", "/links/points", "/events"}
    assert f"/robot-{LEADER}/link" not in topics


def test_transforms_place_every_robot_where_the_truth_has_it(viewed: Path, log: Log) -> None:
    truths = dict(log.truths())
    frames = [(tick, message) for topic, tick, message in decoded(viewed) if topic == "/tf"]
    assert len(frames) > 50
    for tick, message in frames:
        expected = {f"robot-{one.robot}/base_link": one.pose for one in truths[tick].present}
        assert {one.child_frame_id for one in message.transforms} == set(expected)
        for one in message.transforms:
            pose = expected[one.child_frame_id]
            assert one.parent_frame_id == "map"
            assert (one.translation.x, one.translation.y) == (pose.x, pose.y)
            assert one.rotation.z**2 + one.rotation.w**2 == pytest.approx(1.0)
            turn = 2.0 * math.atan2(one.rotation.z, one.rotation.w)
            assert math.cos(turn - pose.heading) == pytest.approx(1.0)
            assert one.timestamp.ToNanoseconds() == LOG_EPOCH_NS + truths[tick].time_ns


def test_scan_points_in_the_map_lie_on_something_solid(viewed: Path, log: Log) -> None:
    """A point of a scan is the range at the angle of its beam: the beams are given back by atan2."""
    seen = {tick: observation.scan for tick, observation in log.observations(3)}
    checked = 0
    for topic, tick, message in decoded(viewed):
        if topic != "/robot-3/scan_points":
            continue
        points = np.frombuffer(message.data, dtype="<f4").reshape(-1, 3)
        ranges = seen[tick][np.isfinite(seen[tick])]
        assert np.allclose(np.hypot(points[:, 0], points[:, 1]), ranges, rtol=1e-5)
        assert (points[:, 0] >= -1e-5).all()
        checked += len(points)
    assert checked > 100


def test_links_carry_the_robots_own_numbers(viewed: Path, log: Log) -> None:
    actions = dict(log.actions(4))
    links = [(tick, m) for topic, tick, m in decoded(viewed) if topic == "/robot-4/link"]
    assert len(links) > 10
    for tick, message in links:
        status = actions[tick].status
        assert message.throughput_bps == status.throughput_bps
        assert message.error_m == status.error
        assert all(hasattr(message, name) for name in LINK_FIELDS)


def test_the_death_of_the_leader_is_an_event(viewed: Path) -> None:
    texts = [message.message for topic, _, message in decoded(viewed) if topic == "/events"]
    assert any(text.startswith(f"robot-{LEADER}: gone, killed") for text in texts)


def test_a_layer_is_replaced_and_never_doubled(viewed: Path, tmp_path: Path) -> None:
    again = tmp_path / "again.mcap"
    shutil.copy(viewed, again)
    write_view(open_log(again), again)
    assert Counter(t for t, _, _ in decoded(again)) == Counter(t for t, _, _ in decoded(viewed))
    assert digest(LogFile(again)) == digest(LogFile(viewed))
    assert list(tmp_path.iterdir()) == [again]


def test_the_official_decoder_reads_every_channel(viewed: Path) -> None:
    support = pytest.importorskip("mcap_protobuf.decoder", reason="mcap-protobuf-support is not here")
    with viewed.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[support.DecoderFactory()])
        names = {
            schema.name
            for schema, channel, _, _ in reader.iter_decoded_messages(
                topics=sorted({topic for topic, _, _ in decoded(viewed)})
            )
        }
    assert names >= {"foxglove.FrameTransforms", "foxglove.PointCloud", "onehop.Link", "foxglove.Log"}
