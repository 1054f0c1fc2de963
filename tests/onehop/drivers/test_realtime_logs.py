"""Logs of real time: executed again, judged, forged, torn and saved (docs/realtime.md)."""

import contextlib
from collections.abc import Callable
from pathlib import Path

import pytest

from onehop.analysis import open_log
from onehop.analysis.salvage import salvage
from onehop.checking import judge
from onehop.contracts.errors import LogError, ScenarioError
from onehop.drivers import inline
from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile
from tests.onehop.forgery import Fields, Forgery
from tests.onehop.jitter import Jitter
from tests.onehop.scenes import field

REAL_TIME = 'clock.mode="realtime"'
FAULTS = (
    'faults=[{kind="kill", at_s=4, robots=[2]}, {kind="restart", at_s=7, robots=[2]},'
    ' {kind="stop", at_s=5, robots=[4], duration_s=3}, {kind="restart", at_s=9, robots=[1]},'
    ' {kind="slow", at_s=3, robots=[3], duration_s=5, delay_ticks=4},'
    ' {kind="cut", at_s=8, robots=[1], duration_s=3}, {kind="hold", at_s=10, robots=[3], duration_s=1},'
    ' {kind="corrupt", at_s=2, probability=0.3, duration_s=4},'
    ' {kind="jam", at_s=6, x=8, y=8, radius=3, noise_dbm=-60, duration_s=2}]'
)


@pytest.fixture(scope="module")
def quiet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("quiet")
    bundle = field(folder, REAL_TIME, "clock.limit_s=12")
    Jitter(bundle).write(folder / "mission.mcap", bundle)
    return folder / "mission.mcap"


@pytest.mark.parametrize(
    "settings",
    [
        (),
        ("radio.neighbours=true", 'radio.routing="mrsr"'),
        ('radio.link="perfect"',),
        ('radio.fast_fading="rician"', "robot.pose_noise=0.05"),
    ],
)
def test_a_log_with_faults_and_late_robots_is_executed_again(
    tmp_path: Path, settings: tuple[str, ...]
) -> None:
    bundle = field(tmp_path, REAL_TIME, "clock.limit_s=14", FAULTS, *settings)
    path = tmp_path / "mission.mcap"
    Jitter(bundle, seed=5).write(path, bundle)
    log = LogFile(path)
    report = replay(log)
    assert (report.divergences, report.flaws) == (0, [])
    assert judge(log).violations == ()
    judged = judge(log)
    assert judged.checked["fault-bit"] == 9
    assert {"one-leader", "one-team", "re-election"} <= judged.unexercised.keys()
    forgery = Forgery(path)
    lies = [tick for tick, _ in forgery.ticks if forgery.has(tick, "out/3")]
    assert any(forgery.get(tick, "out/3")["tick"] < tick for tick in lies)
    assert len(lies) < len(forgery.ticks)


def hearing(log: Forgery) -> tuple[int, str]:
    """A tick in the middle, and the channel of an inbox with a reception."""
    return next(
        (tick, key)
        for tick, messages in log.ticks[100:]
        for key, _ in messages
        if key.startswith("rx/") and log.get(tick, key)["receptions"]
    )


def handing(log: Forgery) -> int:
    """A tick in the middle in which somebody has handed over a message."""
    return next(tick for tick, _ in log.ticks[100:] if log.get(tick, "radio")["intake"]["handed"])


def lose_an_inbox(log: Forgery) -> None:
    log.remove(*hearing(log))


def answer_another_tick(log: Forgery) -> None:
    log.change(100, "rx/1", lambda inbox: inbox.update(tick=50, time_ns=50 * 50_000_000))


def answer_what_is_to_come(log: Forgery) -> None:
    log.change(100, "out/1", lambda action: action.update(tick=101))


def lose_an_observation(log: Forgery) -> None:
    log.remove(100, "obs/1")


def hear_it_twice(log: Forgery) -> None:
    log.change(*hearing(log), lambda inbox: inbox["receptions"].append(inbox["receptions"][0]))


def hear_something_else(log: Forgery) -> None:
    log.change(*hearing(log), lambda inbox: inbox["receptions"][0].update(payload=b"no"))


def hear_it_before_it_came(log: Forgery) -> None:
    tick, key = hearing(log)
    reception = log.get(tick, key)["receptions"][0]
    before = next(earlier for earlier in range(tick - 2, 0, -1) if log.has(earlier, key))
    log.change(before, key, lambda inbox: inbox["receptions"].append(reception))


def hand_over_at_another_instant(log: Forgery) -> None:
    def later(record: Fields) -> None:
        record["intake"]["handed"][0]["at_ns"] += 1

    log.change(handing(log), "radio", later)


def place_nothing(log: Forgery) -> None:
    log.change(handing(log), "radio", lambda record: record.pop("intake"))


def close_too_early(log: Forgery) -> None:
    tick, _, verdict = next(log.verdicts(first=100))
    log.change(
        tick,
        "radio",
        lambda record: record["intake"].update(until_ns=verdict["arrival_ns"] - 1),
    )


def drive_on_in_silence(log: Forgery) -> None:
    """All that a robot said in 30 ticks is gone, and it drives as before."""
    for tick in range(150, 180):
        for key in ("out/2", "rx/2"):
            if log.has(tick, key):
                log.remove(tick, key)


@pytest.mark.parametrize(
    ("forge", "invariant"),
    [
        (lose_an_inbox, "complete"),
        (answer_another_tick, "complete"),
        (answer_what_is_to_come, "complete"),
        (lose_an_observation, "complete"),
        (hear_it_twice, "radio-integrity"),
        (hear_something_else, "radio-integrity"),
        (hear_it_before_it_came, "radio-integrity"),
        (hand_over_at_another_instant, "radio-integrity"),
        (place_nothing, "radio-integrity"),
        (close_too_early, "radio-integrity"),
        (drive_on_in_silence, "motion"),
        (drive_on_in_silence, "own-voice"),
    ],
)
def test_what_is_forged_is_found_and_cannot_be_executed_again(
    quiet: Path, tmp_path: Path, forge: Callable[[Forgery], None], invariant: str
) -> None:
    forgery = Forgery(quiet)
    forge(forgery)
    log = forgery.write(tmp_path / "forged.mcap")
    assert invariant in judge(log).broken
    with contextlib.suppress(LogError):
        assert replay(log).divergences > 0


def test_a_torn_log_is_judged_and_executed_up_to_its_last_whole_tick(
    quiet: Path, tmp_path: Path
) -> None:
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(quiet.read_bytes()[: quiet.stat().st_size * 2 // 3])
    log = LogFile(torn)
    assert log.torn
    report = replay(log)
    assert report.divergences == 0
    assert report.ticks > 50
    assert judge(log).violations == ()
    saved = salvage(torn, tmp_path / "saved.mcap")
    assert saved.ticks >= report.ticks
    assert replay(LogFile(tmp_path / "saved.mcap")).divergences == 0


def test_tables_have_the_actions_of_robots_that_were_late(quiet: Path) -> None:
    log = open_log(quiet)
    said = {tick: action.tick for tick, action in log.actions(1)}
    assert any(answered < tick for tick, answered in said.items())
    assert log.table("status").of(1)["tick"].tolist() == list(said)


def test_one_process_has_no_real_time(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="one process has no real time"):
        inline.run(field(tmp_path, REAL_TIME), None)
