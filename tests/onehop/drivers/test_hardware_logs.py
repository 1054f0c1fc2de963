"""Logs of missions with a real base: executed again from its measurements, judged, and forged."""

import contextlib
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from onehop.checking import judge
from onehop.contracts.errors import LogError
from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile
from onehop.wire.selection import one_of
from tests.onehop.command_line import in_shell as onehop
from tests.onehop.forgery import Fields, Forgery
from tests.onehop.jitter import Jitter
from tests.onehop.scenes import field

REAL = 3
SETTINGS = (
    'clock.mode="realtime"',
    "start.poses=[[8,8,0],[8,11,0],[11,8,0],[5,8,0]]",
    f'robots=[{{id={REAL}, base="hardware"}}]',
)
FAULTS = (
    'faults=[{kind="kill", at_s=4, robots=[2]}, {kind="restart", at_s=6, robots=[3]},'
    ' {kind="hold", at_s=2, robots=[3], duration_s=1}, {kind="stop", at_s=7, robots=[3], duration_s=1},'
    ' {kind="blind", at_s=3, robots=[3], duration_s=1}, {kind="kill", at_s=9, robots=[3]},'
    ' {kind="slow", at_s=5, robots=[3], duration_s=1, delay_ticks=3}]'
)


def mission(folder: Path, *settings: str) -> Path:
    bundle = field(folder, *SETTINGS, *settings)
    path = folder / "mission.mcap"
    Jitter(bundle, seed=3).write(path, bundle)
    return path


@pytest.fixture(scope="module")
def quiet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return mission(tmp_path_factory.mktemp("base"), "clock.limit_s=8")


@pytest.mark.parametrize(
    "settings", [(), ("robot.pose_noise=0.05", "robot.laser_noise=0.02"), (FAULTS,)]
)
def test_a_mission_with_a_base_is_executed_again_and_keeps_every_promise(
    tmp_path: Path, settings: tuple[str, ...]
) -> None:
    log = LogFile(mission(tmp_path, "clock.limit_s=12", *settings))
    report = replay(log)
    assert (report.divergences, report.flaws, report.bases) == (0, [], (REAL,))
    assert judge(log).violations == ()
    taken = [one.tick for one in log.wire.select(one_of(f"base/{REAL}"))]
    assert taken[0] == 0
    assert 100 < len(taken) < 240  # it has not measured anew at every tick


def everywhere(log: Forgery, robot: int, x: float, y: float) -> None:
    """From a tick in the middle on a real base is there, and measures so."""

    def change(one: Fields) -> None:
        one["pose"].update(x=x, y=y)

    ticks = range(measured(log), len(log.ticks))
    log.present(ticks, robot, change)
    for tick in ticks:
        if log.has(tick, f"base/{robot}"):
            log.change(tick, f"base/{robot}", lambda taken: change(taken["measured"]))


def test_what_is_real_between_real_things_is_not_judged(tmp_path: Path) -> None:
    two = f'robots=[{{id={REAL}, base="hardware"}}, {{id=4, base="hardware"}}]'
    forgery = Forgery(mission(tmp_path, two, "clock.limit_s=6"))
    assert judge(forgery.write(tmp_path / "sound.mcap")).violations == ()
    everywhere(forgery, REAL, 39.95, 39.9)  # in a wall
    everywhere(forgery, 4, 39.9, 39.95)  # and on each other
    assert judge(forgery.write(tmp_path / "forged.mcap")).violations == ()


def test_a_real_body_is_where_it_is_measured_after_its_robot_has_left(tmp_path: Path) -> None:
    gone = f'faults=[{{kind="kill", at_s=2, robots=[{REAL}]}}]'
    forgery = Forgery(mission(tmp_path, gone, "clock.limit_s=6"))
    assert judge(forgery.write(tmp_path / "sound.mcap")).violations == ()
    tick = next(tick for tick in range(80, 120) if forgery.has(tick, f"base/{REAL}"))
    other = next(one for one in forgery.get(tick, "truth")["present"] if one["robot"] == 1)
    forgery.change(
        tick, f"base/{REAL}", lambda taken: taken["measured"].update(pose=dict(other["pose"]))
    )
    report = judge(forgery.write(tmp_path / "forged.mcap"))
    assert set(report.broken) == {"no-collision"}


def test_people_are_told_what_is_taken_from_the_log(quiet: Path) -> None:
    said = onehop("replay", quiet).stdout
    assert f"real base of robot {REAL}: what it measured is taken from the log\n" in said
    assert "0 divergences: every message is the same, byte for byte\n" in said


def measured(log: Forgery) -> int:
    """A tick in the middle, while it drives, at which it has measured anew, as at the next one."""
    driving = (
        t for t in range(60, 150) if log.has(t, f"base/{REAL}") and log.has(t + 1, f"base/{REAL}")
    )
    return next(t for t in driving if log.get(t, f"base/{REAL}")["measured"]["twist"]["v"] > 0.1)


def lose_a_measurement(log: Forgery) -> None:
    log.remove(measured(log), f"base/{REAL}")


def lose_the_first(log: Forgery) -> None:
    log.remove(0, f"base/{REAL}")


def measure_another_place(log: Forgery) -> None:
    def change(taken: Fields) -> None:
        taken["measured"]["pose"]["x"] += 0.01

    log.change(measured(log), f"base/{REAL}", change)


def measure_another_speed(log: Forgery) -> None:
    def change(taken: Fields) -> None:
        taken["measured"]["twist"]["v"] += 0.01

    log.change(measured(log), f"base/{REAL}", change)


def measure_nothing_that_is(log: Forgery) -> None:
    def change(taken: Fields) -> None:
        taken["measured"]["pose"]["x"] = float("nan")

    log.change(measured(log), f"base/{REAL}", change)


def measure_at_another_tick(log: Forgery) -> None:
    log.change(measured(log), f"base/{REAL}", lambda taken: taken.update(tick=5))


def be_elsewhere(log: Forgery) -> None:
    def change(one: Fields) -> None:
        one["pose"]["y"] += 0.01

    tick = measured(log)
    log.present(range(tick, tick + 1), REAL, change)


def look_through_what_is_there(log: Forgery) -> None:
    tick = measured(log)

    def shorten(taken: Fields) -> None:
        taken["measured"]["scan"] = struct.pack("<181f", *[1.5] * 181)

    log.change(tick, f"base/{REAL}", shorten)


def stand_on_somebody(log: Forgery) -> None:
    tick = measured(log)
    (other,) = [one["pose"] for one in log.get(tick, "truth")["present"] if one["robot"] == 1]

    def change(one: Fields) -> None:
        one["pose"].update(x=other["x"] + 0.1, y=other["y"])

    log.present(range(tick, tick + 1), REAL, change)
    log.change(tick, f"base/{REAL}", lambda taken: change(taken["measured"]))


@pytest.mark.parametrize(
    ("forge", "broken"),
    [
        (lose_a_measurement, {"motion"}),
        (lose_the_first, {"motion"}),
        (measure_another_place, {"motion"}),
        (measure_another_speed, {"motion"}),
        (measure_nothing_that_is, {"complete", "motion"}),
        (measure_at_another_tick, {"complete", "motion"}),
        (be_elsewhere, {"motion"}),
        (look_through_what_is_there, {"own-voice"}),
        (stand_on_somebody, {"no-collision"}),
    ],
)
def test_what_is_forged_is_found_and_cannot_be_executed_again(
    quiet: Path, tmp_path: Path, forge: Callable[[Forgery], Any], broken: set[str]
) -> None:
    forgery = Forgery(quiet)
    forge(forgery)
    log = forgery.write(tmp_path / "forged.mcap")
    assert set(judge(log).broken) == broken
    with contextlib.suppress(LogError):
        assert replay(log).divergences > 0
