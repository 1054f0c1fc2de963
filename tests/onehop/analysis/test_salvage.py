"""A torn log wherever it is torn: a sound file, whole ticks, nothing missing before the last."""

from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from onehop.analysis import Log, open_log
from onehop.analysis.salvage import salvage
from onehop.analysis.view.layer import write_view
from onehop.contracts.errors import LogError
from onehop.wire.log_reader import LogFile, LoggedTick
from onehop.wire.log_writer import LogWriter
from tests.onehop.log_forms import CHUNK_DAMAGES, FORMS, Form, chunks, ticks_of, write_form

from .conftest import LEADER


def ticks(path: Path) -> list[LoggedTick]:
    return list(LogFile(path).ticks())


@pytest.fixture
def flushed(log_path: Path, tmp_path: Path) -> Path:
    """The log of the small mission in chunks of three ticks."""
    path = tmp_path / "flushed.mcap"
    write_form(log_path, path, Form(), ticks_of(log_path))
    return path


@pytest.mark.slow
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(share=st.floats(0.0, 1.0, exclude_max=True))
def test_a_log_torn_anywhere_gives_a_prefix_of_whole_ticks(
    log_path: Path, tmp_path: Path, share: float
) -> None:
    data = log_path.read_bytes()
    first = len(chunks(data, tmp_path / "scratch")[0])
    torn, saved = tmp_path / "torn.mcap", tmp_path / "saved.mcap"
    torn.write_bytes(data[: first + int(share * (len(data) - first))])
    result = salvage(torn, saved)
    whole = ticks(log_path)
    assert not open_log(saved).torn
    assert ticks(saved) == whole[: result.last_tick + 1]
    assert bool(result.damage) == open_log(torn).torn
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


def _damaged(source: Path, target: Path, number: int, at: int) -> None:
    """A log with another byte in its chunk of this number."""
    parts = chunks(source.read_bytes(), target)
    chunk = bytearray(parts[1 + number])
    chunk[at] ^= 0xFF
    parts[1 + number] = bytes(chunk)
    target.write_bytes(b"".join(parts))


@pytest.mark.parametrize("at", [2, 5, 60], ids=["length", "beyond the file", "content"])
def test_what_lies_behind_a_damaged_chunk_is_saved(flushed: Path, tmp_path: Path, at: int) -> None:
    broken, saved = tmp_path / "broken.mcap", tmp_path / "saved.mcap"
    _damaged(flushed, broken, 5, at)
    result = salvage(broken, saved)
    whole = ticks(flushed)
    assert ticks(saved) == [tick for tick in whole if tick.tick not in (13, 14, 15)]
    assert len(result.damage) == 1
    assert result.unread_bytes > 0
    assert result.flaws == [f"ticks 13..15 are missing of {len(whole)}"]
    assert open_log(saved).flaws == tuple(result.flaws)
    assert result.ended


def test_bytes_that_were_cut_out_cost_no_more_than_their_chunk(flushed: Path, tmp_path: Path) -> None:
    head, *middle, tail = chunks(flushed.read_bytes(), tmp_path / "scratch")
    middle[5] = middle[5][:200] + middle[5][900:]
    cut, saved = tmp_path / "cut.mcap", tmp_path / "saved.mcap"
    cut.write_bytes(b"".join((head, *middle, tail)))
    salvage(cut, saved)
    assert ticks(saved) == [tick for tick in ticks(flushed) if tick.tick not in (13, 14, 15)]


def test_a_torn_log_with_a_damaged_chunk_gives_both_sides(flushed: Path, tmp_path: Path) -> None:
    broken, torn, saved = (tmp_path / f"{name}.mcap" for name in ("broken", "torn", "saved"))
    _damaged(flushed, broken, 5, 60)
    torn.write_bytes(broken.read_bytes()[: broken.stat().st_size // 2])
    result = salvage(torn, saved)
    assert {tick.tick for tick in ticks(saved)} == {*range(result.last_tick + 1)} - {13, 14, 15}
    assert result.flaws == ["ticks 13..15 are missing"]
    assert not result.ended


@pytest.mark.parametrize("damage", ["swapped", "doubled"])
def test_chunks_are_put_in_their_order_and_saved_once(
    flushed: Path, tmp_path: Path, damage: str
) -> None:
    mixed, saved = tmp_path / "mixed.mcap", tmp_path / "saved.mcap"
    mixed.write_bytes(CHUNK_DAMAGES[damage](flushed.read_bytes(), Random(3), tmp_path / "scratch"))
    result = salvage(mixed, saved)
    assert ticks(saved) == ticks(flushed)
    assert result.flaws == []
    assert (result.copies > 0) == (damage == "doubled")


def test_a_chunk_that_is_gone_is_missed(flushed: Path, tmp_path: Path) -> None:
    head, *middle, tail = chunks(flushed.read_bytes(), tmp_path / "scratch")
    short, saved = tmp_path / "short.mcap", tmp_path / "saved.mcap"
    short.write_bytes(b"".join((head, *middle[:-1], tail)))
    (flaw,) = salvage(short, saved).flaws
    assert flaw.endswith(f"missing of {len(ticks(flushed))}")


def test_a_tick_beside_the_damage_that_is_not_whole_is_given_up(flushed: Path, tmp_path: Path) -> None:
    split, saved = tmp_path / "split.mcap", tmp_path / "saved.mcap"
    kept = [(tick, messages[:-1] if tick == 30 else messages) for tick, messages in ticks_of(flushed)]
    write_form(flushed, split, FORMS["no chunks"], kept)
    data = split.read_bytes()
    split.write_bytes(data[: int(0.6 * len(data))])
    result = salvage(split, saved)
    assert 30 not in {tick.tick for tick in ticks(saved)}
    assert result.given_up >= len(dict(kept)[30])


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS.keys())
def test_a_log_of_any_form_is_saved(log_path: Path, tmp_path: Path, form: Form) -> None:
    path, saved = tmp_path / "form.mcap", tmp_path / "saved.mcap"
    write_form(log_path, path, form, ticks_of(log_path))
    result = salvage(path, saved)
    assert (result.flaws, result.damage, result.given_up) == ([], [], 0)
    assert ticks(saved) == ticks(log_path)


def test_a_sound_log_loses_nothing(log: Log, log_path: Path, tmp_path: Path) -> None:
    saved = tmp_path / "saved.mcap"
    result = salvage(log_path, saved)
    assert (result.damage, result.given_up, result.unread_bytes, result.ended) == ([], 0, 0, True)
    assert result.flaws == []
    assert ticks(saved) == ticks(log_path)
    assert open_log(saved).summary == log.summary


def test_a_log_with_a_robot_that_died_in_the_middle_is_saved_whole_beside_damage(
    log: Log, flushed: Path, tmp_path: Path
) -> None:
    """A killed robot owes the action of its last tick, and that tick is whole all the same."""
    died = int(log.table("departures")["tick"][0]) - 1
    ticks = ticks_of(flushed)
    ticks[died] = died, [(key, data) for key, data in ticks[died][1] if key != f"out/{LEADER}"]
    path, broken, saved = (tmp_path / f"{name}.mcap" for name in ("died", "broken", "saved"))
    write_form(flushed, path, Form(), ticks)
    _damaged(path, broken, 2, 60)
    salvage(broken, saved)
    assert died in {tick.tick for tick in LogFile(saved).ticks()}


def test_a_viewer_layer_is_saved_with_its_log(log: Log, tmp_path: Path) -> None:
    viewed, broken, saved = (tmp_path / f"{name}.mcap" for name in ("viewed", "broken", "saved"))
    write_view(log, viewed)
    _damaged(viewed, broken, 1, 60)
    result = salvage(broken, saved)
    assert result.flaws
    with saved.open("rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        seen = sum(1 for _ in reader.iter_messages(["/tf"]))
    assert summary is not None
    assert {"foxglove.FrameTransforms", "onehop.Link"} <= {one.name for one in summary.schemas.values()}
    assert 0 < seen < len(ticks(viewed))


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
