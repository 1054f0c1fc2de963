"""A log held against its own word: the ticks, the digest, and what it may not hold."""

from pathlib import Path
from random import Random

import pytest

from onehop.contracts.errors import LogError
from onehop.wire.audit import audit
from onehop.wire.log_reader import LogFile, digest
from onehop.wire.log_writer import LogWriter
from tests.onehop.log_forms import (
    CHUNK_DAMAGES,
    FORMS,
    Form,
    chunks,
    ticks_of,
    write_form,
)
from tests.onehop.scenes import field, log_of


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "mission.mcap"
    log_of(field(path.parent, "clock.limit_s=2"), path)
    return path


@pytest.fixture
def flushed(recorded: Path, tmp_path: Path) -> Path:
    """The same log in chunks of three ticks."""
    path = tmp_path / "flushed.mcap"
    write_form(recorded, path, Form(), ticks_of(recorded))
    return path


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS.keys())
def test_every_form_that_mcap_allows_is_read(recorded: Path, tmp_path: Path, form: Form) -> None:
    path = tmp_path / "form.mcap"
    write_form(recorded, path, form, ticks_of(recorded))
    log = LogFile(path)
    assert log.flaws == []
    assert not log.torn
    assert audit(log) == []
    assert digest(log) == digest(LogFile(recorded))


def test_a_stretch_of_a_log_without_chunks_is_found(recorded: Path, tmp_path: Path) -> None:
    path = tmp_path / "plain.mcap"
    write_form(recorded, path, FORMS["no chunks"], ticks_of(recorded))
    found = list(LogFile(path).wire.select(lambda key: key == "out/3", 10, 12))
    assert [message.tick for message in found] == [10, 11, 12]


def test_a_sound_log_has_no_flaw(recorded: Path) -> None:
    assert LogFile(recorded).flaws == []
    assert audit(LogFile(recorded)) == []


def test_a_last_chunk_that_is_gone_is_missed_at_once(flushed: Path, tmp_path: Path) -> None:
    head, *middle, tail = chunks(flushed.read_bytes(), tmp_path / "scratch")
    short = tmp_path / "short.mcap"
    short.write_bytes(b"".join((head, *middle[:-1], tail)))
    log = LogFile(short)
    assert log.flaws == ["ticks 37..39 are missing of 40"]
    assert audit(log) == log.flaws


def test_a_chunk_that_is_gone_from_the_middle_is_missed_at_once(flushed: Path, tmp_path: Path) -> None:
    head, *middle, tail = chunks(flushed.read_bytes(), tmp_path / "scratch")
    holed = tmp_path / "holed.mcap"
    holed.write_bytes(b"".join((head, *middle[:4], *middle[5:], tail)))
    assert LogFile(holed).flaws == ["ticks 10..12 are missing of 40"]


@pytest.mark.parametrize("damage", ["swapped", "doubled"])
def test_chunks_in_another_order_are_noticed_at_once_and_not_read(
    flushed: Path, tmp_path: Path, damage: str
) -> None:
    mixed = tmp_path / "mixed.mcap"
    mixed.write_bytes(CHUNK_DAMAGES[damage](flushed.read_bytes(), Random(3), tmp_path / "scratch"))
    log = LogFile(mixed)
    assert any("comes after tick" in flaw for flaw in log.flaws)
    with pytest.raises(LogError, match="comes after tick"):
        audit(log)


def test_a_message_too_many_is_noticed_by_its_channel(recorded: Path, tmp_path: Path) -> None:
    ticks = ticks_of(recorded)
    ticks[7][1].append(ticks[7][1][-1])
    path = tmp_path / "twice.mcap"
    write_form(recorded, path, Form(), ticks)
    assert audit(LogFile(path)) == ["tick 7 has two messages of one channel"]


def test_a_changed_message_is_noticed_by_the_digest(recorded: Path, tmp_path: Path) -> None:
    ticks = ticks_of(recorded)
    key, data = ticks[7][1][3]
    ticks[7][1][3] = key, data[:-1] + bytes([data[-1] ^ 1])
    path = tmp_path / "changed.mcap"
    write_form(recorded, path, Form(), ticks)
    assert LogFile(path).flaws == []
    (flaw,) = audit(LogFile(path))
    assert "their digest is" in flaw
    assert digest(LogFile(recorded)) in flaw


def test_a_log_without_one_tick_says_so(recorded: Path, tmp_path: Path) -> None:
    path = tmp_path / "empty.mcap"
    write_form(recorded, path, Form(), [], outcome=False)
    assert audit(LogFile(path)) == ["it has not one tick"]


def test_a_torn_log_is_not_blamed_for_what_nobody_knows(flushed: Path, tmp_path: Path) -> None:
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(flushed.read_bytes()[: flushed.stat().st_size // 2])
    log = LogFile(torn)
    assert log.torn
    assert audit(log) == log.flaws == []


def test_an_outcome_that_cannot_be_read_is_a_flaw_and_no_traceback(
    flushed: Path, tmp_path: Path
) -> None:
    path = tmp_path / "strange.mcap"
    path.write_bytes(flushed.read_bytes().replace(b'"outcome": "failed"', b'"outcome": "<b>hi!"'))
    log = LogFile(path)
    assert log.summary is None
    assert len(log.flaws) == 1
    assert "its outcome cannot be read" in log.flaws[0]


def test_a_chain_of_records_that_leads_astray_is_no_tear(flushed: Path, tmp_path: Path) -> None:
    data = bytearray(flushed.read_bytes())
    head, first, second, *_ = chunks(bytes(data), tmp_path / "scratch")
    data[len(head) + len(first) + len(second) + 6] = 1  # of the length of the third chunk
    path = tmp_path / "astray.mcap"
    path.write_bytes(data)
    log = LogFile(path)
    assert not log.torn
    assert "leads beyond the end of the file" in log.flaws[0]
    with pytest.raises(LogError, match="damaged in the record at byte"):
        audit(log)
    assert {message.tick for message in log.wire.select(lambda _: True, 0, 0)} == {0}


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        (b"/wire/out/3", b"/wire/out/9", "this mission has no channel '/wire/out/9'"),
        (b"/wire/out/3", b"/wire/out/x", "this mission has no channel '/wire/out/x'"),
        (b"/wire/out/3", b"/wire/\x1b[2J1", r"this mission has no channel '/wire/[^\x1b]*2J1'"),
    ],
)
def test_a_channel_that_no_mission_of_this_team_has_is_refused(
    recorded: Path, tmp_path: Path, old: bytes, new: bytes, why: str
) -> None:
    path = tmp_path / "channel.mcap"
    write_form(recorded, path, FORMS["no checksums"], ticks_of(recorded))
    path.write_bytes(path.read_bytes().replace(old, new))
    with pytest.raises(LogError, match=why):
        list(LogFile(path).ticks())


def test_one_channel_id_for_two_topics_is_refused(recorded: Path, tmp_path: Path) -> None:
    path = tmp_path / "clash.mcap"
    write_form(recorded, path, FORMS["no checksums"], ticks_of(recorded))
    path.write_bytes(path.read_bytes().replace(b"/wire/out/3", b"/wire/out/2", 1))
    with pytest.raises(LogError, match=r"channel \d+ is '/wire/out/3' and '/wire/out/2'"):
        list(LogFile(path).ticks())


def test_a_message_of_another_time_than_its_tick_is_refused(recorded: Path, tmp_path: Path) -> None:
    path = tmp_path / "late.mcap"
    write_form(recorded, path, FORMS["no chunks"], ticks_of(recorded))
    data = path.read_bytes()
    sequence = (7).to_bytes(4, "little")
    stamp = (10**18 + 7 * 50_000_000).to_bytes(8, "little")
    path.write_bytes(data.replace(sequence + stamp, (8).to_bytes(4, "little") + stamp, 1))
    with pytest.raises(LogError, match="tick 8 has the log time of another"):
        list(LogFile(path).ticks())


def test_a_chunk_that_promises_more_than_memory_is_refused(flushed: Path, tmp_path: Path) -> None:
    data = bytearray(flushed.read_bytes())
    head, *_ = chunks(bytes(data), tmp_path / "scratch")
    at = len(head) + 9 + 16  # record head and two times before the unpacked size
    data[at : at + 8] = (1 << 50).to_bytes(8, "little")
    path = tmp_path / "bomb.mcap"
    path.write_bytes(data)
    with pytest.raises(LogError, match=f"a chunk of {1 << 50} bytes"):
        list(LogFile(path).ticks())


def test_a_frame_of_another_size_than_its_chunk_says_is_refused(flushed: Path, tmp_path: Path) -> None:
    data = bytearray(flushed.read_bytes())
    head, *_ = chunks(bytes(data), tmp_path / "scratch")
    data[len(head) + 9 + 16] ^= 1
    path = tmp_path / "size.mcap"
    path.write_bytes(data)
    with pytest.raises(LogError, match="another size than its head says"):
        list(LogFile(path).ticks())


def test_an_unknown_compression_is_named(flushed: Path, tmp_path: Path) -> None:
    path = tmp_path / "brotli.mcap"
    path.write_bytes(flushed.read_bytes().replace(b"\4\0\0\0zstd", b"\4\0\0\0brot", 1))
    with pytest.raises(LogError, match="compression b'brot'; zstd, lz4 or none is read"):
        list(LogFile(path).ticks())


def test_a_scenario_that_was_changed_on_the_way_is_refused(recorded: Path, tmp_path: Path) -> None:
    path = tmp_path / "forged.mcap"
    path.write_bytes(recorded.read_bytes().replace(b'"seed": 3', b'"seed": 4', 1))
    with pytest.raises(LogError, match=r"the checksum of attachment 'scenario\.json' is wrong"):
        LogFile(path)


def test_a_writer_that_was_ended_without_an_outcome_leaves_a_log_without_flaws(
    recorded: Path, tmp_path: Path
) -> None:
    path = tmp_path / "aborted.mcap"
    writer = LogWriter(path, LogFile(recorded).bundle, "inline")
    for tick, messages in ticks_of(recorded)[:5]:
        writer.write(tick, messages)
    writer.close(None)
    log = LogFile(path)
    assert (log.summary, log.torn, audit(log)) == (None, False, [])
