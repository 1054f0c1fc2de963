"""Re-execution of logs that are not all that was said: never a success over what was not compared."""

from pathlib import Path

import msgpack
import pytest

from onehop.contracts import topics
from onehop.contracts.errors import LogError
from onehop.drivers.replay import Report, replay
from onehop.wire.journal import WireMessage
from onehop.wire.log_reader import LogFile
from tests.onehop.log_forms import FORMS, Form, chunks, ticks_of, write_form
from tests.onehop.scenes import field, log_of

KILLED = 2
KILLED_TICK = 40
"""Tick from which on the robot is not there."""

Ticks = list[tuple[int, list[WireMessage]]]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "mission.mcap"
    kill = f"faults=[{{kind='kill', at_s=2, robots=[{KILLED}]}}]"
    log_of(field(path.parent, "clock.limit_s=3", kill), path)
    return path


@pytest.fixture
def ticks(recorded: Path) -> Ticks:
    return ticks_of(recorded)


def _replayed(recorded: Path, tmp_path: Path, ticks: Ticks, outcome: bool = False) -> Report:
    """Re-execution of a log of these messages; without an outcome, nothing but replay can notice."""
    path = tmp_path / "log.mcap"
    write_form(recorded, path, Form(), ticks, outcome)
    return replay(LogFile(path))


def _without(ticks: Ticks, tick: int, key: str) -> Ticks:
    return [(t, [m for m in messages if (t, m[0]) != (tick, key)]) for t, messages in ticks]


def _robots(ticks: Ticks, tick: int) -> set[str]:
    return {key for key, _ in ticks[tick][1] if key.startswith("out/")}


def test_the_robot_is_killed_when_these_tests_need_it(ticks: Ticks) -> None:
    assert topics.out(KILLED) in _robots(ticks, KILLED_TICK - 1)
    assert topics.out(KILLED) not in _robots(ticks, KILLED_TICK)


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS.keys())
def test_every_form_is_compared_in_full(recorded: Path, tmp_path: Path, form: Form) -> None:
    path = tmp_path / "form.mcap"
    write_form(recorded, path, form, ticks_of(recorded))
    report, original = replay(LogFile(path)), replay(LogFile(recorded))
    assert report == original
    assert report.same
    assert report.ticks == 60


def test_nothing_compared_is_no_success(recorded: Path, tmp_path: Path) -> None:
    report = _replayed(recorded, tmp_path, [])
    assert (report.compared, report.divergences, report.same) == (0, 0, False)
    assert report.flaws == ["it has not one tick"]


def test_a_stretch_behind_the_end_is_no_success(recorded: Path) -> None:
    report = replay(LogFile(recorded), first_tick=1000)
    assert (report.ticks, report.compared, report.same) == (0, 0, False)


def test_a_message_of_a_dead_robot_is_a_divergence(recorded: Path, tmp_path: Path, ticks: Ticks) -> None:
    last_words = dict(ticks[KILLED_TICK - 1][1])[topics.out(KILLED)]
    ticks[KILLED_TICK + 5][1].append((topics.out(KILLED), last_words))
    first = _replayed(recorded, tmp_path, ticks).first
    assert first is not None
    assert (first.tick, first.channel) == (KILLED_TICK + 5, "/wire/out/2")
    assert (first.field, first.recorded, first.replayed) == ("message", "present", None)


@pytest.mark.parametrize("key", ["radio", "rx/3", "obs/1", "out/4"])
def test_a_message_that_is_missing_is_a_divergence(
    recorded: Path, tmp_path: Path, ticks: Ticks, key: str
) -> None:
    report = _replayed(recorded, tmp_path, _without(ticks, 7, key))
    assert not report.same
    assert report.first is not None
    assert (report.first.tick, report.first.channel) == (7, topics.wire(key))
    assert (report.first.field, report.first.recorded) == ("message", None)


def test_a_log_without_truth_is_no_success(recorded: Path, tmp_path: Path, ticks: Ticks) -> None:
    blind = [(tick, [m for m in messages if m[0] != topics.TRUTH]) for tick, messages in ticks]
    report = _replayed(recorded, tmp_path, blind)
    assert not report.same
    assert report.divergences > 60


def test_a_robot_that_died_before_it_could_act_owes_nothing(
    recorded: Path, tmp_path: Path, ticks: Ticks
) -> None:
    """Killed in the middle of a tick, it has been given a percept and has said nothing."""
    report = _replayed(recorded, tmp_path, _without(ticks, KILLED_TICK - 1, topics.out(KILLED)))
    assert [key for key in report.per_channel if key != topics.wire(topics.TRUTH)] == []


def test_the_unfinished_tick_of_a_torn_log_owes_nothing(
    recorded: Path, tmp_path: Path, ticks: Ticks
) -> None:
    torn = tmp_path / "torn.mcap"
    write_form(recorded, torn, FORMS["no chunks"], ticks)
    torn.write_bytes(torn.read_bytes()[: torn.stat().st_size // 3])
    report = replay(LogFile(torn))
    assert len(list(LogFile(torn).ticks())[-1].messages) < len(ticks[0][1])
    assert report.same


def test_a_re_execution_ends_where_ticks_are_missing(
    recorded: Path, tmp_path: Path, ticks: Ticks
) -> None:
    report = _replayed(recorded, tmp_path, [*ticks[:20], *ticks[23:]])
    assert report.ticks == 20
    assert report.divergences == 0
    assert not report.same
    assert report.flaws == ["ticks 20..22 are missing"]


def test_a_last_chunk_that_is_gone_is_no_success(recorded: Path, tmp_path: Path, ticks: Ticks) -> None:
    path = tmp_path / "log.mcap"
    write_form(recorded, path, Form(), ticks)
    head, *middle, tail = chunks(path.read_bytes(), tmp_path / "scratch")
    path.write_bytes(b"".join((head, *middle[:-3], tail)))
    report = replay(LogFile(path))
    assert (report.divergences, report.same) == (0, False)
    assert report.flaws == ["ticks 52..59 are missing of 60"]
    assert replay(LogFile(path), robots=(3,), parts=False).flaws == report.flaws


def test_what_was_asked_for_can_be_the_same_in_a_log_with_less(
    recorded: Path, tmp_path: Path, ticks: Ticks
) -> None:
    path = tmp_path / "log.mcap"
    write_form(recorded, path, Form(), ticks[:50])
    assert replay(LogFile(path), last_tick=30).same
    assert not replay(LogFile(path)).same


def test_a_core_that_fails_on_what_is_recorded_is_a_divergence(
    recorded: Path, tmp_path: Path, ticks: Ticks
) -> None:
    fields = msgpack.unpackb(dict(ticks[5][1])[topics.obs(3)])
    fields["scan"] = fields["scan"][:40]
    ticks[5] = 5, [(k, msgpack.packb(fields) if k == topics.obs(3) else d) for k, d in ticks[5][1]]
    report = _replayed(recorded, tmp_path, ticks)
    assert not report.same
    assert report.first is not None
    assert report.first.tick == 5


def test_a_percept_that_is_none_is_refused_with_its_place(
    recorded: Path, tmp_path: Path, ticks: Ticks
) -> None:
    ticks[5] = 5, [(k, b"\x80" if k == topics.obs(3) else d) for k, d in ticks[5][1]]
    with pytest.raises(LogError, match=r"tick 5, /wire/obs/3: Observation: "):
        _replayed(recorded, tmp_path, ticks)


def test_a_message_of_another_tick_is_refused_with_its_place(
    recorded: Path, tmp_path: Path, ticks: Ticks
) -> None:
    later = dict(ticks[6][1])[topics.rx(3)]
    ticks[5] = 5, [(k, later if k == topics.rx(3) else d) for k, d in ticks[5][1]]
    with pytest.raises(LogError, match=r"tick 5, /wire/rx/3: it is of tick 6"):
        _replayed(recorded, tmp_path, ticks)
