"""Missions in real time: nobody waits, and the log re-executes all the same (docs/realtime.md)."""

import itertools
import os
import signal
import time
from pathlib import Path

import pytest

from onehop.contracts.messages import Action, Lateness, Truth
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
    'faults=[{kind="kill", at_s=3, robots=[2]}, {kind="stop", at_s=4, robots=[4], duration_s=5},'
    ' {kind="slow", at_s=3, robots=[3], duration_s=3, delay_ticks=4},'
    ' {kind="cut", at_s=6, robots=[1], duration_s=3}, {kind="restart", at_s=5, robots=[2]}]'
)


def truths(log: LogFile) -> list[Truth]:
    return [decode(Truth, one.data) for one in log.wire.select(lambda key: key == "truth")]


def speaks(log: LogFile, robot: int) -> list[int]:
    """Ticks at which a robot has said something that counted."""
    return [one.tick for one in log.wire.select(lambda key: key == f"out/{robot}")]


def test_a_mission_with_faults_happens_again_byte_for_byte(tmp_path: Path) -> None:
    mission = Mission(tmp_path, REAL_TIME, SPEED, "clock.limit_s=20", FAULTS)
    summary = mission.finish()
    log = proven(mission.out / "mission.mcap")
    assert summary["realtime"]["unrecorded_ticks"] == 0
    assert summary["ticks"] == len(truths(log))
    assert summary["wall_s"] > 0.95 * summary["sim_s"] / 2.0
    again = next(one for one in truths(log) if any(one.incarnation == 1 for one in one.present))
    assert max(speaks(log, 2)) > again.tick  # it has come back, and acts
    assert not [tick for tick in speaks(log, 4) if 4 in truths(log)[tick].stopped]


def test_a_tick_is_late_when_the_world_is_held_up_and_no_simulated_time_is_left_out(
    tmp_path: Path,
) -> None:
    mission = Mission(tmp_path, REAL_TIME, SPEED, *SLOW_TEAM)
    mission.await_ticks(20_000)
    world = mission.children()["world_server"]
    os.kill(world, signal.SIGSTOP)
    time.sleep(0.5)
    os.kill(world, signal.SIGCONT)
    summary = mission.finish()
    log = proven(mission.out / "mission.mcap")
    late = [
        decode(Lateness, one.data).late_ns / 1e6 for one in log.wire.select(lambda key: key == "late")
    ]
    timing = summary["realtime"]
    assert len(late) == timing["late_ticks"] > 0
    assert max(late) == pytest.approx(timing["latest_ms"], abs=0.01)
    assert 400.0 < timing["latest_ms"] <= timing["moved_ms"] + 1e3 * PERIOD_S
    assert [one.tick for one in truths(log)] == list(range(summary["ticks"]))


def test_a_robot_that_is_held_up_keeps_nobody_waiting_and_rests_after_a_moment(tmp_path: Path) -> None:
    mission = Mission(tmp_path, REAL_TIME, SPEED, *SLOW_TEAM)
    mission.await_ticks(20_000)
    robot = mission.children()["robot_agent 2"]  # it leads
    os.kill(robot, signal.SIGSTOP)
    time.sleep(1.0)
    os.kill(robot, signal.SIGCONT)
    summary = mission.finish()
    log = proven(mission.out / "mission.mcap")
    ticks = speaks(log, 2)
    silent, first = max((later - tick, tick) for tick, later in itertools.pairwise(ticks))
    assert silent > 30
    assert 2 not in [one["robot"] for one in summary["lost"] if one["why"] == "its process died"]
    resting = truths(log)[first + 20].present[1]
    assert (resting.twist.v, resting.twist.w) == (0.0, 0.0)
    assert len(speaks(log, 3)) > 0.9 * summary["ticks"]


def test_a_program_that_takes_two_ticks_for_a_step_answers_every_third(tmp_path: Path) -> None:
    program = 'team.program="tests.onehop.programs.samples:Dawdler"'
    mission = Mission(tmp_path, REAL_TIME, "clock.limit_s=5", program)
    mission.finish()
    log = proven(mission.out / "mission.mcap")
    actions = [
        (one.tick, decode(Action, one.data).tick) for one in log.wire.select(lambda key: key == "out/1")
    ]
    assert len(actions) <= 100 / 2
    assert all(lies - answers in (1, 2, 3) for lies, answers in actions[5:])


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


def test_a_recorder_that_is_held_up_costs_no_tick(tmp_path: Path) -> None:
    mission = Mission(tmp_path, REAL_TIME, SPEED, *SLOW_TEAM)
    mission.await_ticks(20_000)
    recorder = mission.children()["onehop.recorder"]
    os.kill(recorder, signal.SIGSTOP)
    time.sleep(1.5)
    os.kill(recorder, signal.SIGCONT)
    summary = mission.finish()
    assert len(truths(proven(mission.out / "mission.mcap"))) == summary["ticks"]
    assert summary["realtime"]["unrecorded_ticks"] == 0
    assert summary["realtime"]["moved_ms"] < 500.0
