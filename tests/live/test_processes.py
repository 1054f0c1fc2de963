"""Missions as processes: the same bytes as in one process, and an end whatever is killed.

Every mission here ends by itself, and every log that it leaves is re-executed.
"""

import json
import os
import signal
from pathlib import Path

import pytest

from onehop.wire.log_reader import digest
from tests.live.mission import CREEPING, Mission, contents, gone, proven
from tests.onehop.scenes import field, log_of

pytestmark = pytest.mark.live


@pytest.fixture
def mission(tmp_path: Path) -> Mission:
    return Mission(tmp_path, *CREEPING)


FAULTS = (
    "faults=[{kind='kill', at_s=4, robots=[2]}, {kind='restart', at_s=9, robots=[2]},"
    " {kind='cut', at_s=5, robots=[1], duration_s=3}, {kind='hold', at_s=6, robots=[4], duration_s=2}]"
)


@pytest.mark.parametrize("settings", [(), (FAULTS, "clock.limit_s=20")], ids=["quiet", "faults"])
def test_processes_log_the_same_bytes_as_one_process(tmp_path: Path, settings: tuple[str, ...]) -> None:
    inline = log_of(field(tmp_path, *settings), tmp_path / "inline.mcap")
    summary = Mission(tmp_path, *settings, options=("--view", "--figure")).finish()
    assert summary["digest"] == inline
    assert (tmp_path / "out" / "trajectory.png").exists()
    assert digest(proven(tmp_path / "out" / "mission.mcap")) == inline
    names = [process["name"] for process in summary["processes"]]
    assert names[:7] == ["world", "radio", "recorder", "robot-1", "robot-2", "robot-3", "robot-4"]
    assert gone([process["pid"] for process in summary["processes"]])


def test_a_password_is_in_the_environment_of_its_process_alone(mission: Mission) -> None:
    """Not on a command line, not in what the mission writes, not with another process but the world."""
    mission.await_ticks()
    children = mission.children()
    environments = {name: Path(f"/proc/{pid}/environ").read_text() for name, pid in children.items()}
    words = environments["world_server"].split("ONEHOP_CREDENTIALS=")[1].split("\0")[0].split()
    passwords = dict(word.split(":") for word in words)
    assert len(set(passwords.values())) == 8
    for name, pid in children.items():
        own = name.removeprefix("onehop.").removesuffix("_proxy").replace("_agent ", "-")
        seen = [user for user, word in passwords.items() if word in environments[name]]
        assert seen == (list(passwords) if name == "world_server" else [own])
        command = Path(f"/proc/{pid}/cmdline").read_text()
        assert not any(word in command for word in passwords.values())
        assert Path(f"/proc/{pid}/environ").stat().st_mode & 0o077 == 0
    mission.stop()
    assert not any(word.encode() in contents(mission.out) for word in passwords.values())


def test_two_missions_side_by_side_do_not_disturb_each_other(tmp_path: Path) -> None:
    folders = [tmp_path / "a", tmp_path / "b"]
    for folder in folders:
        folder.mkdir()
    running = [Mission(folder, "clock.limit_s=10") for folder in folders]
    digests = {one.finish()["digest"] for one in running}
    for one in running:
        proven(one.out / "mission.mcap")
    assert digests == {log_of(field(tmp_path, "clock.limit_s=10"), tmp_path / "inline.mcap")}


def test_a_killed_launcher_leaves_no_process_behind(mission: Mission) -> None:
    mission.await_ticks()
    children = mission.children()
    assert len(children) == 7
    os.kill(children["robot_agent 4"], signal.SIGSTOP)
    mission.child.kill()
    assert gone(list(children.values()))
    proven(mission.out / "mission.mcap")


def test_ctrl_c_finishes_the_log_and_exits_130(mission: Mission) -> None:
    mission.await_ticks()
    children = mission.children()
    mission.stop()
    assert gone(list(children.values()))
    log = proven(mission.out / "mission.mcap")
    assert digest(log)
    assert not log.torn
    assert log.summary is not None
    assert log.summary["reason"] == "stopped by the operator"
    written = json.loads((mission.out / "summary.json").read_text())
    assert (written["reason"], written["digest"]) == (log.summary["reason"], digest(log))
