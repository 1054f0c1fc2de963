"""What signals from outside do to each process of a mission: docs/faults.md, "From outside"."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from onehop.contracts.messages import Truth
from onehop.drivers.replay import replay
from onehop.mission.operator import STOPPED
from onehop.node.bus import LEASE_MS
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile, digest
from tests.live.mission import CREEPING, DEADLINE_S, Mission, gone, proven
from tests.onehop.scenes import field, log_of
from world_server.process_faults import RESTART_S

pytestmark = pytest.mark.live

PAUSE_S = 0.25 * LEASE_MS / 1000.0
LIMIT = "clock.limit_s=60"


@pytest.fixture
def mission(tmp_path: Path) -> Mission:
    running = Mission(tmp_path, LIMIT, "robot.leader_speed=0.2")
    running.await_ticks()
    return running


def state(pid: int) -> str:
    """State letter of a process; Z when it has ended and its parent has not looked."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]


@pytest.mark.campaign
def test_a_pause_that_is_shorter_than_the_lease_changes_nothing(
    mission: Mission, tmp_path: Path
) -> None:
    children = mission.children()
    paused = [children["radio_proxy"], children["onehop.recorder"], children["world_server"]]
    for pid in (*paused, children["robot_agent 2"], mission.child.pid):
        os.kill(pid, signal.SIGSTOP)
        time.sleep(PAUSE_S)
        os.kill(pid, signal.SIGCONT)
    summary = mission.finish()
    quiet = field(tmp_path, LIMIT, "robot.leader_speed=0.2")
    assert summary["digest"] == log_of(quiet, tmp_path / "inline.mcap")


@pytest.mark.parametrize(
    ("victim", "outcome", "reason"),
    [
        ("robot_agent 3", "failed", "time limit of 60 s"),
        ("radio_proxy", "aborted", "the radio process died (SIGTERM)"),
        ("onehop.recorder", "aborted", "the recorder process died (SIGTERM)"),
        ("world_server", "aborted", STOPPED),
    ],
)
def test_a_process_that_is_asked_to_end_ends_as_the_table_says(
    mission: Mission, victim: str, outcome: str, reason: str
) -> None:
    children = mission.children()
    os.kill(children[victim], signal.SIGTERM)
    summary = mission.finish()
    assert (summary["outcome"], summary["reason"]) == (outcome, reason)
    assert mission.child.returncode == 1
    assert gone(list(children.values()))
    log = proven(mission.out / "mission.mcap")
    assert log.torn == (victim == "onehop.recorder")
    if victim != "onehop.recorder":
        assert digest(log) == summary["digest"]


def test_a_mission_whose_launcher_is_stopped_ends_by_itself_when_it_cannot_go_on(
    mission: Mission,
) -> None:
    children = mission.children()
    mission.child.send_signal(signal.SIGSTOP)
    os.kill(children["radio_proxy"], signal.SIGKILL)
    deadline = time.monotonic() + DEADLINE_S
    while any(state(pid) != "Z" for pid in children.values()):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    mission.child.send_signal(signal.SIGCONT)
    summary = mission.finish()
    assert summary["reason"].startswith("the radio process is gone from the bus")
    assert digest(LogFile(mission.out / "mission.mcap")) == summary["digest"]


def test_a_process_that_somebody_starts_again_takes_part_as_after_a_restart(tmp_path: Path) -> None:
    """As with a container: the same program with the same password, and no launcher that knows it."""
    mission = Mission(tmp_path, *CREEPING)
    mission.await_ticks()
    pid = mission.children()["robot_agent 3"]
    words = Path(f"/proc/{pid}/environ").read_text().split("\0")
    command = Path(f"/proc/{pid}/cmdline").read_text().split("\0")[:-1]
    lifeline = command.index("--lifeline")
    os.kill(pid, signal.SIGKILL)
    again = subprocess.Popen(
        command[:lifeline] + command[lifeline + 2 :],
        env=dict(word.split("=", 1) for word in words if "=" in word),
    )
    try:
        mission.await_line("s: restart 3")
        mission.await_ticks(mission.log_bytes() + 20_000)
        summary = mission.stop()
    finally:
        again.kill()
        again.wait()
    log = LogFile(mission.out / "mission.mcap")
    assert digest(log) == summary["digest"]
    assert replay(log).divergences == 0
    last = list(log.ticks())[-1]
    present = {one.robot: one.incarnation for one in decode(Truth, last.get("truth") or b"").present}
    assert present == {1: 0, 2: 0, 3: 1, 4: 0}


FAINTING = """
import os, signal
from pathlib import Path
from onehop.robot import Action, Program

class Fainting(Program):
    def __init__(self, briefing):
        fainted = Path(__file__).with_name("fainted")
        if briefing.robot == 2 and not fainted.exists():
            fainted.touch()
            os.kill(os.getpid(), signal.SIGSTOP)

    def step(self, percept):
        return Action()
"""


@pytest.mark.parametrize("mode", ["lockstep", "realtime"])
def test_a_robot_that_loses_its_session_in_its_start_takes_part_all_the_same(
    tmp_path: Path, mode: str
) -> None:
    """It has been briefed, and is not there yet: as when a busy machine stands still for a lease."""
    (tmp_path / "fainting.py").write_text(FAINTING)
    settings = ("team.program='fainting:Fainting'", f"clock.mode='{mode}'", "clock.limit_s=2")
    mission = Mission(tmp_path, *settings)
    pid = mission.await_child("robot_agent 2")
    deadline = time.monotonic() + DEADLINE_S
    while not ((tmp_path / "fainted").exists() and state(pid) == "T"):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    time.sleep(1.5 * LEASE_MS / 1000.0)
    os.kill(pid, signal.SIGCONT)
    summary = mission.finish()
    assert {one["why"] for one in summary["lost"]} == {"did not arrive"}
    proven(mission.out / "mission.mcap")


@pytest.mark.campaign
def test_a_restart_that_nobody_carries_out_ends_the_mission(tmp_path: Path) -> None:
    restart = "faults=[{kind='restart', at_s=12, robots=[2]}]"
    mission = Mission(tmp_path, restart, LIMIT, "robot.leader_speed=0.2")
    mission.await_ticks()
    world = mission.children()["world_server"]
    mission.child.send_signal(signal.SIGSTOP)
    deadline = time.monotonic() + DEADLINE_S
    while state(world) != "Z":
        assert time.monotonic() < deadline
        time.sleep(0.05)
    mission.child.send_signal(signal.SIGCONT)
    reason = f"not started within {RESTART_S:g} s: robot-2"
    assert mission.finish()["reason"] == reason
    proven(mission.out / "mission.mcap")
