"""A torn log wherever it is torn: a sound file, whole ticks, nothing missing before the last."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode

from onehop.analysis import Log, open_log
from onehop.analysis.salvage import salvage
from onehop.contracts.errors import LogError
from onehop.wire.log_reader import LogFile, LoggedTick
from onehop.wire.log_writer import LogWriter
from onehop.wire.selection import walk


def ticks(path: Path) -> list[LoggedTick]:
    return list(LogFile(path).ticks())


def head_size(path: Path) -> int:
    """Bytes before the first chunk: without them no log can be told from any other file."""
    with path.open("rb") as stream:
        for opcode, _ in walk(stream):
            if opcode == Opcode.CHUNK:
                return stream.tell() - 9
    raise AssertionError("a log without a chunk")


@pytest.mark.slow
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0.0, 1.0, exclude_max=True))
def test_a_log_torn_anywhere_gives_a_prefix_of_whole_ticks(
    log_path: Path, tmp_path: Path, share: float
) -> None:
    data = log_path.read_bytes()
    first = head_size(log_path)
    torn, saved = tmp_path / "torn.mcap", tmp_path / "saved.mcap"
    torn.write_bytes(data[: first + int(share * (len(data) - first))])
    result = salvage(torn, saved)
    whole = ticks(log_path)
    assert not open_log(saved).torn
    assert ticks(saved) == whole[: result.last_tick + 1]
    assert result.damage
    assert result.messages == sum(len(tick.messages) for tick in whole[: result.last_tick + 1])


def test_what_was_readable_is_saved_but_for_the_unfinished_tick(log_path: Path, tmp_path: Path) -> None:
    torn, saved = tmp_path / "torn.mcap", tmp_path / "saved.mcap"
    torn.write_bytes(log_path.read_bytes()[: log_path.stat().st_size * 2 // 3])
    result = salvage(torn, saved)
    readable = ticks(torn)
    assert len(ticks(saved)) in (len(readable), len(readable) - 1)
    missing = sum(len(t.messages) for t in readable) - sum(len(t.messages) for t in ticks(saved))
    assert result.given_up == missing


def test_an_unfinished_tick_is_given_up_and_counted(log_path: Path, tmp_path: Path) -> None:
    source = LogFile(log_path)
    first, second, *_ = source.ticks()
    torn, saved = tmp_path / "torn.mcap", tmp_path / "saved.mcap"
    writer = LogWriter(tmp_path / "growing.mcap", source.bundle, "inline")
    writer.write(first.tick, first.messages)
    writer.write(second.tick, second.messages[:-1])
    writer.flush()
    torn.write_bytes((tmp_path / "growing.mcap").read_bytes())
    writer.close(None)
    result = salvage(torn, saved)
    assert (result.last_tick, result.given_up) == (first.tick, len(second.messages) - 1)
    assert ticks(saved) == [first]


def test_a_damaged_log_is_saved_up_to_the_damage(log_path: Path, tmp_path: Path) -> None:
    data = bytearray(log_path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    broken, saved = tmp_path / "broken.mcap", tmp_path / "saved.mcap"
    broken.write_bytes(data)
    result = salvage(broken, saved)
    assert "damaged near byte" in result.damage
    assert 0 < result.last_tick < len(ticks(log_path)) - 1
    assert ticks(saved) == ticks(log_path)[: result.last_tick + 1]


def test_a_sound_log_loses_nothing(log: Log, log_path: Path, tmp_path: Path) -> None:
    saved = tmp_path / "saved.mcap"
    result = salvage(log_path, saved)
    assert (result.damage, result.given_up, result.unread_bytes, result.ended) == ("", 0, 0, True)
    assert ticks(saved) == ticks(log_path)
    assert open_log(saved).summary == log.summary


def test_the_saved_log_carries_scenario_and_versions(log: Log, log_path: Path, tmp_path: Path) -> None:
    torn, saved = tmp_path / "torn.mcap", tmp_path / "saved.mcap"
    torn.write_bytes(log_path.read_bytes()[: log_path.stat().st_size // 2])
    salvage(torn, saved)
    opened = open_log(saved)
    assert opened.scenario == log.scenario
    assert opened.metadata == log.metadata


def test_something_else_is_not_salvaged(tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("no log")
    with pytest.raises(LogError):
        salvage(path, tmp_path / "saved.mcap")
    assert not (tmp_path / "saved.mcap").exists()
