"""Teams that break their rules: each broken rule is found by its name, and nothing else is."""

from pathlib import Path
from typing import Any

import pytest

from onehop.checking import judge
from onehop.wire.log_reader import LogFile
from tests.onehop.checking.conftest import KILLED, LEADER, QUICK, RETURNED, SUCCESSOR
from tests.onehop.forgery import Forgery
from tests.onehop.scenes import field, log_of

EVERYONE = (1, 2, 3, 4)

LONG_BOUND = 71
"""Seven Next periods of the quick missions, and a tick."""


def commanding(log: Forgery, robot: int, first: int = 50) -> int:
    """The next tick in which a robot commands."""
    return next(
        tick for tick in range(first, len(log.ticks)) if len(log.get(tick, f"out/{robot}")["outbox"]) > 1
    )


def obey_another(log: Forgery) -> None:
    log.say(range(50, 51), 4, leader=3)


def lead_without_being_the_median(log: Forgery) -> None:
    log.say(range(50, 60), 3, leader=3)


def command_as_a_stranger(log: Forgery) -> None:
    """A leader's command with a roster of which it is not the median."""

    def without_one(fields: list[Any]) -> None:
        fields[4 if fields[1] == "command" else 3] = [2, 3, 4]

    log.reword(commanding(log, LEADER), LEADER, without_one)


def everyone_obeys_the_first(log: Forgery) -> None:
    for robot in EVERYONE:
        log.say(range(50, 52), robot, leader=1)


@pytest.mark.parametrize(
    "alter",
    [obey_another, lead_without_being_the_median, command_as_a_stranger, everyone_obeys_the_first],
)
def test_a_leader_that_is_not_the_median_is_found(broken: Any, alter: Any) -> None:
    assert set(broken(alter).broken) == {"median"}


def drive_as_six(log: Forgery) -> None:
    log.say(range(50, 51), 4, shape="hexagon")


def lead_in_column_unasked(log: Forgery) -> None:
    log.say(range(50, 51), LEADER, shape="column")


def follow_in_column_unasked(log: Forgery) -> None:
    tick = next(t for t in range(50, 99) if log.get(t, "rx/4")["receptions"])
    log.say(range(tick, tick + 1), 4, shape="column")


def command_column_in_the_open(log: Forgery) -> None:
    def column(fields: list[Any]) -> None:
        fields[7 if fields[1] == "command" else 5] = True

    log.reword(commanding(log, LEADER), LEADER, column)


@pytest.mark.parametrize(
    "alter",
    [drive_as_six, lead_in_column_unasked, follow_in_column_unasked, command_column_in_the_open],
)
def test_a_shape_that_was_not_asked_for_is_found(broken: Any, alter: Any) -> None:
    assert set(broken(alter).broken) == {"shape"}


def forget_an_epoch(log: Forgery) -> None:
    log.say(range(RETURNED - 10, RETURNED - 9), SUCCESSOR, epoch=0)


def obey_a_stale_epoch(log: Forgery) -> None:
    """A follower goes back to the dead leader's roster; its epoch stays the newest that it knows."""
    stale = {"leader": LEADER, "members": list(EVERYONE), "shape": "diamond"}
    log.say(range(RETURNED - 20, RETURNED - 10), 4, **stale)


def command_in_an_old_epoch(log: Forgery) -> None:
    def old(fields: list[Any]) -> None:
        fields[3 if fields[1] == "command" else 2] = 0

    log.reword(commanding(log, SUCCESSOR, RETURNED - 40), SUCCESSOR, old)


def take_in_without_a_new_epoch(log: Forgery) -> None:
    """The successor takes the returned robot into its roster, and says so in its old epoch."""
    tick = next(
        tick
        for tick in range(RETURNED, len(log.ticks))
        if log.get(tick, f"out/{SUCCESSOR}")["status"]["members"] == list(EVERYONE)
    )
    epoch = log.get(tick - 1, f"out/{SUCCESSOR}")["status"]["epoch"]
    log.say(range(tick, tick + 1), SUCCESSOR, epoch=epoch)


@pytest.mark.parametrize(
    "alter",
    [forget_an_epoch, obey_a_stale_epoch, command_in_an_old_epoch, take_in_without_a_new_epoch],
)
def test_an_epoch_that_goes_back_or_is_not_obeyed_is_found(broken: Any, alter: Any) -> None:
    assert set(broken(alter, "troubled").broken) == {"epochs"}


ALONE = {"mode": "alone", "leader": 4, "members": [4], "shape": "solo", "epoch": 9}
UNLED = {"mode": "joining", "leader": 0, "shape": "solo"}


def two_lead(log: Forgery) -> None:
    log.say(range(30, 120), 4, **ALONE)


def three_lead(log: Forgery) -> None:
    log.say(range(30, 120), 4, **ALONE)
    log.say(range(30, 120), 1, **{**ALONE, "leader": 1, "members": [1]})


def a_part_has_its_own(log: Forgery) -> None:
    for robot in (3, 4):
        status = {"leader": 3, "members": [3, 4], "shape": "column", "epoch": 9}
        log.say(range(30, 120), robot, mode="leading" if robot == 3 else "following", **status)


def nobody_leads(log: Forgery) -> None:
    log.say(range(30, 120), LEADER, members=[LEADER], **UNLED)


@pytest.mark.parametrize(
    ("alter", "log", "who"),
    [
        (two_lead, "quiet", {(2, 4)}),
        (three_lead, "quiet", {(1, 2), (1, 4), (2, 4)}),
        (a_part_has_its_own, "quiet", {(2, 3)}),
        (nobody_leads, "quiet", {EVERYONE}),
    ],
)
def test_two_leaders_or_none_are_found(broken: Any, alter: Any, log: str, who: Any) -> None:
    report = broken(alter, log)
    assert set(report.broken) == {"one-leader", "one-team"}
    assert {one.robots for one in report.violations if one.invariant == "one-leader"} == who


def one_is_left_joining(log: Forgery) -> None:
    log.say(range(30, 120), 4, members=[4], **UNLED)


def the_leader_has_one_too_few(log: Forgery) -> None:
    log.say(range(30, 120), LEADER, members=[1, 2, 3], shape="wedge", epoch=9)


def one_obeys_who_does_not_lead(log: Forgery) -> None:
    log.say(range(30, 120), 4, leader=1, members=[1, 4], shape="column", epoch=9)


@pytest.mark.parametrize(
    "alter", [one_is_left_joining, the_leader_has_one_too_few, one_obeys_who_does_not_lead]
)
def test_robots_that_do_not_become_one_team_are_found(broken: Any, alter: Any) -> None:
    found = [one for one in broken(alter).violations if one.invariant == "one-team"]
    assert [one.robots for one in found] == [EVERYONE]
    assert found[0].tick == 30 + LONG_BOUND


def test_a_leader_that_does_not_give_up_the_dead_is_found(tmp_path: Path) -> None:
    settings = (*QUICK[:2], "clock.limit_s=9", "faults=[{kind='kill', at_s=1, robots=[4]}]")
    log_of(field(tmp_path, *settings), tmp_path / "mission.mcap")
    log = Forgery(tmp_path / "mission.mcap")
    log.say(
        range(len(log.ticks)), LEADER, leader=LEADER, members=list(EVERYONE), shape="diamond", epoch=0
    )
    found = judge(log.write(tmp_path / "forged.mcap")).violations
    assert (1, 2, 3) in {one.robots for one in found if one.invariant == "one-team"}


def test_one_that_starts_anew_while_nobody_hears_it_has_its_time_again(tmp_path: Path) -> None:
    """A robot alone, started again and again: each process has to find out that it is alone."""
    restarts = ", ".join(f"{{kind='restart', at_s={at}, robots=[1]}}" for at in (2, 4, 5.5, 7, 8.5))
    settings = (*QUICK[:2], "clock.limit_s=12", "team.size=1", f"faults=[{restarts}]")
    log_of(field(tmp_path, *settings), tmp_path / "mission.mcap")
    assert judge(LogFile(tmp_path / "mission.mcap")).violations == ()


def test_one_that_is_cut_off_from_many_gives_them_up_one_by_one(tmp_path: Path) -> None:
    settings = (
        *QUICK[:2],
        "clock.limit_s=12",
        "team.size=10",
        "faults=[{kind='cut', at_s=1, robots=[1]}]",
    )
    log_of(field(tmp_path, *settings), tmp_path / "mission.mcap")
    assert judge(LogFile(tmp_path / "mission.mcap")).violations == ()


def test_a_follower_that_is_stopped_after_its_leader_died_owes_no_successor(tmp_path: Path) -> None:
    faults = "{kind='kill', at_s=1, robots=[1]}, {kind='stop', at_s=1.5, robots=[2], duration_s=9}"
    settings = (*QUICK[:2], "clock.limit_s=14", "team.size=2", f"faults=[{faults}]")
    log_of(field(tmp_path, *settings), tmp_path / "mission.mcap")
    assert judge(LogFile(tmp_path / "mission.mcap")).violations == ()


def two_lead_for_a_while(log: Forgery) -> None:
    log.say(range(60, 95), 4, **ALONE)


def test_two_leaders_for_less_than_the_bound_are_none(broken: Any) -> None:
    assert "one-leader" not in broken(two_lead_for_a_while).broken


REST = (1, 3, 4)
OLD = {"mode": "following", "epoch": 0, "leader": 2, "members": list(EVERYONE), "shape": "diamond"}


def wait_for_the_dead(log: Forgery) -> None:
    for robot in REST:
        log.say(range(KILLED, KILLED + 50), robot, **OLD)


def the_successor_never_acts(log: Forgery) -> None:
    log.say(range(KILLED, KILLED + 50), SUCCESSOR, members=[SUCCESSOR], **UNLED)


def nobody_is_elected(log: Forgery) -> None:
    for robot in REST:
        log.say(range(KILLED, KILLED + 50), robot, members=[robot], **UNLED)


@pytest.mark.parametrize("alter", [wait_for_the_dead, the_successor_never_acts, nobody_is_elected])
def test_a_leader_without_a_successor_in_time_is_found(broken: Any, alter: Any) -> None:
    found = set(broken(alter, "troubled").broken)
    assert "re-election" in found
    assert found <= {"re-election", "one-leader"}
