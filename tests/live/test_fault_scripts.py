"""Scripted faults of every kind: processes write the same bytes as one process, real signals too."""

import os
import signal
import time
from pathlib import Path

import pytest

from onehop.node.bus import LEASE_MS
from onehop.wire.log_reader import digest
from tests.live.mission import DEADLINE_S, Mission, gone, proven
from tests.onehop.fault_scripts import SCRIPTS
from tests.onehop.scenes import field, log_of

pytestmark = pytest.mark.live


IN_CI = {"kill", "stop", "on an event", "corrupt", "slow"}
"""The others take a minute, and the campaign has them: every kind is tried inline in CI."""


@pytest.mark.parametrize(
    "script",
    [
        pytest.param(script, id=name, marks=[] if name in IN_CI else [pytest.mark.campaign])
        for name, script in SCRIPTS.items()
    ],
)
def test_a_script_leaves_the_same_bytes_in_processes_as_in_one(tmp_path: Path, script: str) -> None:
    settings = (f"faults=[{script}]", "clock.limit_s=10")
    inline = log_of(field(tmp_path, *settings), tmp_path / "inline.mcap")
    mission = Mission(tmp_path, *settings)
    summary = mission.finish()
    assert summary["digest"] == inline
    assert digest(proven(mission.out / "mission.mcap")) == inline
    assert gone([process["pid"] for process in summary["processes"]])


def state(pid: int) -> str:
    """State letter of a process: T when it is stopped."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]


def test_a_robot_that_is_stopped_longer_than_its_lease_goes_on_as_the_same_process(
    tmp_path: Path,
) -> None:
    """Two others hold the mission up meanwhile in turn, each for less than its own lease."""
    settings = (
        "faults=[{kind='stop', at_s=1, robots=[2], duration_s=15}]", "clock.limit_s=18",
        "clock.silence_s=20",
    )  # fmt: skip
    mission = Mission(tmp_path, *settings)
    stopped, *holders = (mission.await_child(f"robot_agent {number}") for number in (2, 3, 4))
    deadline = time.monotonic() + DEADLINE_S
    while state(stopped) != "T":
        assert time.monotonic() < deadline
    os.kill(holders[0], signal.SIGSTOP)
    time.sleep(0.7 * LEASE_MS / 1000.0)
    os.kill(holders[1], signal.SIGSTOP)
    os.kill(holders[0], signal.SIGCONT)
    time.sleep(0.7 * LEASE_MS / 1000.0)
    assert state(stopped) == "T"
    os.kill(holders[1], signal.SIGCONT)
    summary = mission.finish()
    inline = log_of(field(tmp_path, *settings), tmp_path / "inline.mcap")
    assert summary["digest"] == inline
    assert [one["name"] for one in summary["processes"]].count("robot-2") == 1
