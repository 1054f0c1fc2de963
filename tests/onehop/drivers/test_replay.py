"""Re-execution: the same bytes from the log alone, and the place where they are not."""

from pathlib import Path

import msgpack
import pytest

from onehop.contracts import topics
from onehop.drivers.replay import replay
from onehop.scenario.bundle import changed
from onehop.wire.difference import first_difference
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LogWriter
from tests.onehop.scenes import field, log_of

FAULTS = (
    "faults=[{kind='kill', at_s=4, robots=[2]}, {kind='restart', at_s=8, robots=[2]},"
    " {kind='hold', at_s=3, robots=[4], duration_s=2}, {kind='cut', at_s=5, robots=[1], duration_s=3}]"
)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("log")
    path = folder / "mission.mcap"
    log_of(field(folder, "clock.limit_s=12", FAULTS), path)
    return path


def _changed(source: Path, target: Path, tick: int, key: str, place: bytes, instead: bytes) -> None:
    """A copy of a log in which one message of one tick has other bytes."""
    log = LogFile(source)
    writer = LogWriter(target, log.bundle, "inline")
    for one in log.ticks():
        messages = [
            (name, data.replace(place, instead) if (one.tick, name) == (tick, key) else data)
            for name, data in one.messages
        ]
        writer.write(one.tick, messages)
    writer.close(None)


def _first_turning(path: Path, robot: int) -> tuple[int, float]:
    """The first tick in which a robot turns, and its turn rate."""
    for tick in LogFile(path).ticks():
        data = tick.get(topics.out(robot))
        if data is not None and msgpack.unpackb(data)["twist"]["w"]:
            return tick.tick, msgpack.unpackb(data)["twist"]["w"]
    raise AssertionError(f"robot {robot} never turns")


def test_robots_radio_and_world_say_everything_again(recorded: Path) -> None:
    report = replay(LogFile(recorded))
    assert report.divergences == 0
    assert report.ticks == 240
    assert report.compared > 240 * (2 + 3 * 3)


def test_a_changed_byte_of_an_action_is_named_by_tick_robot_and_field(
    recorded: Path, tmp_path: Path
) -> None:
    path = tmp_path / "changed.mcap"
    tick, turning = _first_turning(recorded, 3)
    place = msgpack.packb(turning)
    flipped = place[:-1] + bytes([place[-1] ^ 1])
    _changed(recorded, path, tick, topics.out(3), place, flipped)
    report = replay(LogFile(path), parts=False)
    assert report.divergences == 1
    assert report.first is not None
    assert (report.first.tick, report.first.robot, report.first.field) == (tick, 3, "twist.w")
    assert report.first.recorded != report.first.replayed


def test_only_the_asked_robot_and_time_are_compared(recorded: Path, tmp_path: Path) -> None:
    path = tmp_path / "changed.mcap"
    _changed(recorded, path, 57, topics.out(3), b"remaining_distance", b"remaining_distancf")
    assert replay(LogFile(path), robots=(3,), parts=False).divergences == 1
    assert replay(LogFile(path), robots=(1,), parts=False).divergences == 0
    assert replay(LogFile(path), robots=(3,), parts=False, first_tick=58).divergences == 0
    assert replay(LogFile(path), robots=(3,), parts=False, last_tick=56).divergences == 0


def test_what_if_names_the_first_action_that_would_differ(recorded: Path) -> None:
    log = LogFile(recorded)
    slower = changed(log.bundle.scenario, ["robot.leader_speed=0.5"])
    report = replay(log, robots=(3,), parts=False, scenario=slower)
    assert report.first is not None
    assert (report.first.robot, report.first.field) == (3, "twist.v")


def test_a_first_difference_has_its_path_and_both_values() -> None:
    recorded = {"a": [1, {"b": 2.0}], "c": "x"}
    assert first_difference(recorded, {"a": [1, {"b": 2.0}], "c": "x"}) is None
    assert first_difference(recorded, {"a": [1, {"b": 2.5}], "c": "x"}) == ("a[1].b", 2.0, 2.5)
    assert first_difference(recorded, {"a": [1], "c": "x"}) == ("a.length", 2, 1)
    assert first_difference({"a": 1}, {"a": 1, "z": 2}) == ("z", None, 2)
    assert first_difference({"a": 1}, {"a": 1.0}) == ("a", 1, 1.0)
    assert first_difference({"a": 1}, {"a": True}) == ("a", 1, True)
    assert first_difference({"a": float("nan")}, {"a": float("nan")}) is None
    assert first_difference({"a": float("nan")}, {"a": 1.0}) is not None
    assert first_difference({"a": 1.0}, {"a": float("nan")}) is not None
