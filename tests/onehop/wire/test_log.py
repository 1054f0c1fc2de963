"""Logs: the digest of the run, the prefix of a torn file, a clear line for what is none."""

import tracemalloc
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import Message, Metadata
from mcap.stream_reader import StreamReader

from onehop.contracts.errors import LogError
from onehop.wire.log_reader import LogFile, digest
from onehop.wire.log_writer import LogWriter
from tests.onehop.scenes import field, log_of


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    folder = tmp_path_factory.mktemp("log")
    path = folder / "mission.mcap"
    return path, log_of(field(folder, "clock.limit_s=6"), path)


def test_the_log_has_the_digest_of_the_run(recorded: tuple[Path, str]) -> None:
    path, printed = recorded
    log = LogFile(path)
    assert digest(log) == printed
    assert not log.torn
    assert log.summary is not None
    assert log.summary["digest"] == printed


def test_the_log_carries_its_own_mission(recorded: tuple[Path, str], tmp_path: Path) -> None:
    assert LogFile(recorded[0]).bundle == field(tmp_path, "clock.limit_s=6")


def test_every_tick_of_every_present_robot_has_its_three_messages(recorded: tuple[Path, str]) -> None:
    keys = {"truth", "radio", *(f"{stem}/{i}" for stem in ("rx", "obs", "out") for i in (1, 2, 3, 4))}
    ticks = list(LogFile(recorded[0]).ticks())
    assert [tick.tick for tick in ticks] == list(range(120))
    for tick in ticks:
        names = [key for key, _ in tick.messages]
        assert set(names) == keys
        assert len(names) == len(keys)


def test_the_official_reader_sees_the_wire_channels(recorded: tuple[Path, str]) -> None:
    with recorded[0].open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    wire = [channel for channel in summary.channels.values() if channel.topic.startswith("/wire/")]
    assert {channel.message_encoding for channel in wire} == {"msgpack"}
    assert {channel.schema_id for channel in wire} == {0}
    assert "/wire/obs/1" in {channel.topic for channel in wire}


def test_the_outcome_is_the_last_word(recorded: tuple[Path, str]) -> None:
    with recorded[0].open("rb") as stream:
        records = list(StreamReader(stream).records)
    outcome = [place for place, one in enumerate(records) if isinstance(one, Metadata)][-1]
    assert records[outcome].name == "outcome"
    assert outcome > max(place for place, one in enumerate(records) if isinstance(one, Message))


@pytest.mark.parametrize("share", [0.3, 0.7, 0.99])
def test_a_torn_log_gives_its_whole_prefix(
    recorded: tuple[Path, str], tmp_path: Path, share: float
) -> None:
    whole = list(LogFile(recorded[0]).ticks())
    data = recorded[0].read_bytes()
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(data[: int(len(data) * share)])
    log = LogFile(torn)
    ticks = list(log.ticks())
    assert log.torn
    assert ticks == whole[: len(ticks)]


def test_a_flushed_log_loses_nothing_when_its_writer_dies(tmp_path: Path) -> None:
    path = tmp_path / "mission.mcap"
    log = LogWriter(path, field(tmp_path), "inline")
    for tick in range(10):
        log.write(tick, [("truth", b"t"), ("out/1", b"o")])
        log.flush()
    read = LogFile(path)
    assert [tick.tick for tick in read.ticks()] == list(range(10))
    assert read.torn
    log.close(None)


def test_the_bytes_of_a_log_are_those_of_the_package_s_own_writer(
    recorded: tuple[Path, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("onehop.wire.log_writer._Index", list)
    log = LogFile(recorded[0])
    plain = tmp_path / "plain.mcap"
    writer = LogWriter(plain, log.bundle, "inline")
    for tick in log.ticks():
        writer.write(tick.tick, list(tick.messages))
    writer.close(log.summary)
    assert plain.read_bytes() == recorded[0].read_bytes()


def test_what_a_log_in_the_making_keeps_in_memory_is_the_bytes_of_its_index(tmp_path: Path) -> None:
    """Ten for each channel of a chunk and some for the chunk: a mission may last for days."""
    log = LogWriter(tmp_path / "mission.mcap", field(tmp_path), "inline")
    keys = [f"obs/{robot}" for robot in range(50)]
    chunks = 1000

    def write(ticks: range) -> int:
        for tick in ticks:
            log.write(tick, [(key, b"o") for key in keys])
            log.flush()
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    before = write(range(10))
    kept = write(range(10, 10 + chunks)) - before
    tracemalloc.stop()
    log.close(None)
    assert kept / chunks < 1.25 * (10 * len(keys) + 100)


@pytest.mark.parametrize("content", [b"", b"\x89MC", b"not a log at all, but text\n"])
def test_a_file_that_is_no_log_is_refused_in_one_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.mcap"
    path.write_bytes(content)
    with pytest.raises(LogError) as refusal:
        LogFile(path)
    assert str(path) in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_log_of_another_wire_version_is_refused_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "new.mcap"
    monkeypatch.setattr("onehop.wire.log_writer.WIRE_VERSION", 99)
    LogWriter(path, field(tmp_path), "inline").close(None)
    with pytest.raises(LogError, match=r"wire schema version 99; this program reads version 3"):
        LogFile(path)


def test_a_log_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="No such file"):
        LogFile(tmp_path / "none.mcap")
