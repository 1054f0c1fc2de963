"""Missions in real time: nobody waits, and the log re-executes all the same (docs/realtime.md)."""

import itertools
import os
import signal
import time
from pathlib import Path

import pytest

from onehop.contracts.messages import Action, Truth
from onehop.contracts.realtime import Lateness
from onehop.mission.operator import STOPPED
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile
from onehop.wire.summary import read_summary
from tests.live.mission import DEADLINE_S, Mission, gone, proven

pytestmark = [pytest.mark.live, pytest.mark.slow]

REAL_TIME = 'clock.mode="realtime"'
SPEED = "clock.speed=2.0"
PERIOD_S = 0.05 / 2.0
SLOW_TEAM = ("robot.leader_speed=0.2", "clock.limit_s=20", "team.size=3")
FAULTS = (
    'faults=[{kind="kill", at_s=3, robots=[2]}, {kind="stop", at_s=4, robots=[4], duration_s=8},'
    ' {kind="slow", at_s=3, robots=[3], duration_s=3, delay_ticks=4},'
    ' {kind="cut", at_s=6, robots=[1], duration_s=3}, {kind="restart", at_s=5, robots=[2]}]'
)


def truths(log: LogFile) -> list[Truth]:
    return [decode(Truth, one.data) for one in log.wire.select(lambda key: key == "truth")]


def speaks(log: LogFile, robot: int) -> list[int]:
    """Ticks at which a robot has said something that counted."""
    return [one.tick for one in log.wire.select(lambda key: key == f"out/{robot}")]


def test_a_mission_with_faults_happens_again_byte_for_byte(tmp_path: Path) -> None:
    mission = Mission(tmp_path, REAL_TIME, SPEED, "clock.limit_s=25", FAULTS)
    summary = mission.finish()
    log = proven(mission.out / "mission.mcap")
    assert summary["realtime"]["unrecorded_ticks"] == 0
    assert summary["ticks"] == len(truths(log))
    assert summary["wall_s"] > 0.95 * summary["sim_s"] / 2.0
    again = next(one for one in truths(log) if any(one.incarnation == 1 for one in one.present))
    assert max(speaks(log, 2)) > again.tick  # it has come back, and acts
    assert not [tick for tick in speaks(log, 4) if 4 in truths(log)[tick].stopped]
    assert max(speaks(log, 4)) > 20 * 13  # it was stopped for longer than a lease, and goes on
    assert 4 not in [one["robot"] for one in summary["lost"] if one["why"] == "its process died"]


def test_who_is_held_up_keeps_nobody_waiting_and_no_simulated_time_is_left_out(tmp_path: Path) -> None:
    mission = Mission(tmp_path, REAL_TIME, SPEED, *SLOW_TEAM)
    mission.await_ticks(20_000)
    children = mission.children()
    hold_up(children["robot_agent 2"], 1.0)  # it leads
    hold_up(children["world_server"], 0.5)
    summary = mission.finish()
    log = proven(mission.out / "mission.mcap")
    whole, timing, ticks = truths(log), summary["realtime"], speaks(log, 2)

    silent, first = max((later - tick, tick) for tick, later in itertools.pairwise(ticks))
    assert silent > 30
    assert 2 not in [one["robot"] for one in summary["lost"] if one["why"] == "its process died"]
    resting = whole[first + 20].present[1]
    assert (resting.twist.v, resting.twist.w) == (0.0, 0.0)
    assert len(speaks(log, 3)) > 0.5 * summary["ticks"]

    late = [decode(Lateness, one.data).late_ns for one in log.wire.select(lambda key: key == "late")]
    assert len(late) == timing["late_ticks"] > 0
    assert max(late) / 1e6 == pytest.approx(timing["latest_ms"], abs=0.01)
    assert 400.0 < timing["latest_ms"] <= timing["moved_ms"] + 1e3 * PERIOD_S
    assert [one.tick for one in whole] == list(range(summary["ticks"]))


@pytest.mark.campaign
def test_a_program_that_takes_two_ticks_for_a_step_answers_every_third(tmp_path: Path) -> None:
    program = 'team.program="tests.onehop.programs.samples:Dawdler"'
    mission = Mission(tmp_path, REAL_TIME, "clock.limit_s=5", program)
    mission.finish()
    log = proven(mission.out / "mission.mcap")
    actions = [
        (one.tick, decode(Action, one.data).tick) for one in log.wire.select(lambda key: key == "out/1")
    ]
    assert len(actions) <= 100 / 2
    assert all(lies - answers >= 2 for lies, answers in actions[5:])


@pytest.mark.parametrize(
    ("victim", "how", "reason"),
    [
        ("radio_proxy", signal.SIGKILL, "the radio process died (SIGKILL)"),
        ("onehop.recorder", signal.SIGKILL, "the recorder process died (SIGKILL)"),
        ("", signal.SIGINT, STOPPED),
    ],
)
def test_a_mission_ends_in_order(tmp_path: Path, victim: str, how: int, reason: str) -> None:
    mission = Mission(tmp_path, REAL_TIME, SPEED, *SLOW_TEAM)
    mission.await_ticks(20_000)
    children = mission.children()
    os.kill(children[victim] if victim else mission.child.pid, how)
    mission.child.communicate(timeout=DEADLINE_S)
    summary = read_summary(mission.out)
    assert summary is not None
    assert (summary["outcome"], summary["reason"]) == ("aborted", reason)
    assert gone(list(children.values()))
    log = proven(mission.out / "mission.mcap")
    assert log.torn == (victim == "onehop.recorder")


@pytest.mark.campaign
def test_a_recorder_that_is_held_up_costs_no_tick(tmp_path: Path) -> None:
    mission = Mission(tmp_path, REAL_TIME, SPEED, *SLOW_TEAM)
    mission.await_ticks(20_000)
    hold_up(mission.children()["onehop.recorder"], 1.5)
    summary = mission.finish()
    assert len(truths(proven(mission.out / "mission.mcap"))) == summary["ticks"]
    assert summary["realtime"]["unrecorded_ticks"] == 0
    assert summary["realtime"]["moved_ms"] < 1000.0  # it was away for longer


def test_when_recorder_and_robot_are_cut_off_the_log_lacks_nothing_and_the_robot_joins_again(
    tmp_path: Path,
) -> None:
    """For longer than a lease: to everyone else it is as if their cables had been pulled."""
    mission = Mission(tmp_path, REAL_TIME, SPEED, *SLOW_TEAM, "clock.limit_s=30")
    mission.await_ticks(20_000)
    children = mission.children()
    hold_up(children["onehop.recorder"], 5.0, children["robot_agent 1"])
    summary = mission.finish()
    assert summary["reason"] == "time limit of 30 s"
    assert summary["realtime"]["moved_ms"] < 2500.0  # they were away for longer
    log = proven(mission.out / "mission.mcap")
    whole = truths(log)
    assert len(whole) == summary["ticks"]
    assert next(one.why for truth in whole for one in truth.departures) == "its process died"
    back = next(truth.tick for truth in whole if truth.present[0].incarnation == 1)
    assert max(speaks(log, 1)) > back


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("key", "size", "why"),
    [
        ("to/robot-1/order", 1_000, "silent for 2 s"),
        ("from/robot-3/acted", 100, "put no answer: Acted: not msgpack"),
        ("from/robot-3/acted", 100_000_000, "its process died"),
    ],
)
def test_a_robot_that_floods_the_bus_makes_no_tick_late(
    tmp_path: Path, key: str, size: int, why: str
) -> None:
    """The robot in Python that is started says what nobody may say, or much too much."""
    command = f'command=["python", "-m", "tests.live.rogue", "{key}", "{size}"]'
    where = {"PYTHONPATH": str(Path(__file__).parents[2])}
    mission = Mission(
        tmp_path,
        *(REAL_TIME, "clock.limit_s=8", "clock.silence_s=2", "robot.leader_speed=0.2"),
        f"robots=[{{id=3, {command}}}]",
        environment=where,
    )
    summary = mission.finish()
    assert summary["realtime"]["latest_ms"] < 50.0
    lost = {one["robot"]: one["why"] for one in summary["lost"]}
    assert lost[3].startswith(why)
    assert set(lost.values()) - {lost[3]} == {"did not arrive"}
    proven(mission.out / "mission.mcap")


def hold_up(pid: int, seconds: float, *others: int) -> None:
    """Stop processes for a while."""
    for number in (signal.SIGSTOP, signal.SIGCONT):
        for one in (pid, *others):
            os.kill(one, number)
        time.sleep(seconds if number == signal.SIGSTOP else 0.0)
