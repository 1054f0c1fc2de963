"""Processes that die or stop, at the start and in the middle: who it was is said at once, and why.

Every log that such a mission leaves is re-executed.
"""

import os
import signal
import time
from pathlib import Path

import pytest

from onehop.node.bus import LEASE_MS
from onehop.wire.log_reader import LogFile, digest
from tests.live.mission import CREEPING, DEADLINE_S, Mission, gone, proven

pytestmark = pytest.mark.live

SOON_S = 20.0
"""A mission that cannot go on ends within this time of the death that ends it, on a busy machine: a
second on one that has nothing else to do, and a minute if the end waited for anything."""

STOPPED_S = LEASE_MS / 1000.0 + SOON_S
"""The same for a process that is stopped: its lease, time for its account, and the end of the rest."""

TO_ITS_END = ("robot.leader_speed=0.05", "clock.limit_s=60")
"""Settings of a mission that goes on when a robot is lost, and in which nobody arrives."""

NAMES = {
    "world_server": "world",
    "radio_proxy": "radio",
    "onehop.recorder": "recorder",
    "robot_agent 3": "robot-3",
}
"""What `ps` shows of a process, and its name in the mission."""


@pytest.fixture
def mission(tmp_path: Path) -> Mission:
    return Mission(tmp_path, *CREEPING)


def _replayed(mission: Mission) -> LogFile:
    """The log of a mission that was broken off: whole ticks, each of which happens again."""
    log = proven(mission.out / "mission.mcap")
    ticks = [tick.tick for tick in log.ticks()]
    assert ticks == list(range(len(ticks)))
    return log


@pytest.mark.parametrize("victim", NAMES)
def test_a_process_that_dies_as_soon_as_it_is_started_is_named(mission: Mission, victim: str) -> None:
    os.kill(mission.await_child(victim), signal.SIGKILL)
    killed_s = time.time()
    children = mission.children()
    summary = mission.finish()
    expected = ("aborted", f"the {NAMES[victim]} process died (SIGKILL)")
    assert (summary["outcome"], summary["reason"]) == expected
    assert mission.child.returncode == 1
    assert mission.end_s() - killed_s < SOON_S
    assert gone(list(children.values()))


@pytest.mark.parametrize("victim", NAMES)
def test_a_process_that_dies_while_others_still_start_is_named(mission: Mission, victim: str) -> None:
    """Robot 4 is stopped in its start, so that the world waits for it when the victim dies."""
    os.kill(mission.await_child("robot_agent 4"), signal.SIGSTOP)
    deadline = time.monotonic() + DEADLINE_S
    while not (mission.out / "mission.mcap").exists():  # the recorder has been briefed by then
        assert time.monotonic() < deadline
        time.sleep(0.01)
    time.sleep(1.0)
    children = mission.children()
    os.kill(children[victim], signal.SIGKILL)
    killed_s = time.time()
    summary = mission.finish()
    assert summary["reason"] == f"the {NAMES[victim]} process died (SIGKILL)"
    assert gone(list(children.values()))
    assert mission.end_s() - killed_s < SOON_S
    assert not (mission.out / "stderr").exists()


SLOW_STARTER = """
import pathlib, sys, time

words = sys.orig_argv
if "robot_agent" in words and words[words.index("--id") + 1] == "2":
    marker = pathlib.Path({marker!r})
    if marker.exists():
        time.sleep(600.0)
    marker.touch()
"""


def test_a_robot_that_dies_when_it_is_started_again_is_named(tmp_path: Path) -> None:
    restart = "faults=[{kind='restart', at_s=1, robots=[2]}]"
    (tmp_path / "sitecustomize.py").write_text(SLOW_STARTER.format(marker=str(tmp_path / "started")))
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    mission = Mission(tmp_path, restart, *CREEPING, environment={"PYTHONPATH": path})
    first = mission.await_child("robot_agent 2")
    while (second := mission.children().get("robot_agent 2")) in (first, None):
        assert mission.child.poll() is None
    os.kill(second, signal.SIGKILL)
    killed_s = time.time()
    summary = mission.finish()
    assert summary["reason"] == "the robot-2 process died (SIGKILL)"
    assert mission.end_s() - killed_s < SOON_S
    assert digest(_replayed(mission)) == summary["digest"]


@pytest.mark.parametrize("victim", ["world_server", "radio_proxy", "onehop.recorder"])
def test_without_world_radio_or_recorder_a_mission_is_aborted(mission: Mission, victim: str) -> None:
    mission.await_ticks()
    children = mission.children()
    os.kill(children[victim], signal.SIGKILL)
    killed_s = time.time()
    summary = mission.finish()
    expected = ("aborted", f"the {NAMES[victim]} process died (SIGKILL)")
    assert (summary["outcome"], summary["reason"]) == expected
    assert mission.child.returncode == 1
    assert mission.end_s() - killed_s < SOON_S
    assert gone(list(children.values()))
    log = _replayed(mission)
    assert log.torn is (victim == "onehop.recorder")
    if victim == "radio_proxy":
        assert log.summary is not None
        assert log.summary["reason"] == expected[1]


@pytest.mark.parametrize("victim", ["world_server", "radio_proxy", "onehop.recorder"])
def test_a_stopped_process_ends_the_mission_after_its_lease(mission: Mission, victim: str) -> None:
    mission.await_ticks()
    children = mission.children()
    os.kill(children[victim], signal.SIGSTOP)
    stopped_s = time.time()
    summary = mission.finish()
    assert summary["outcome"] == "aborted"
    assert summary["reason"].startswith(f"the {NAMES[victim]} process is gone from the bus")
    assert mission.end_s() - stopped_s < STOPPED_S
    assert gone(list(children.values()))
    _replayed(mission)


def test_a_killed_robot_is_fenced_and_the_mission_goes_on(tmp_path: Path) -> None:
    mission = Mission(tmp_path, *TO_ITS_END)
    mission.await_ticks()
    os.kill(mission.children()["robot_agent 3"], signal.SIGKILL)
    summary, said = mission.finish_and_say()
    assert summary["reason"] == "time limit of 60 s"
    assert {lost["robot"]: lost["why"] for lost in summary["lost"]}[3] == "its process died"
    assert "the robot-3 process died (SIGKILL)" in said
    assert digest(_replayed(mission)) == summary["digest"]


def test_a_stopped_robot_is_fenced_as_well(tmp_path: Path) -> None:
    mission = Mission(tmp_path, *TO_ITS_END, "clock.silence_s=4")
    mission.await_ticks()
    pid = mission.children()["robot_agent 2"]
    os.kill(pid, signal.SIGSTOP)
    summary = mission.finish()
    assert 2 in [lost["robot"] for lost in summary["lost"]]
    assert gone([pid])
    assert digest(_replayed(mission)) == summary["digest"]


def test_what_the_world_finds_wrong_is_one_line_and_exit_status_2(tmp_path: Path) -> None:
    mission = Mission(tmp_path, "start.x=20", "start.y=26")
    printed, said = mission.child.communicate(timeout=DEADLINE_S)
    assert mission.child.returncode == 2
    assert printed == ""
    assert len(said.strip().splitlines()) == 1
    assert "start" in said
