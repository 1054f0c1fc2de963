"""Missions as processes: the same bytes as in one process, and an end whatever is killed.

Every mission here ends by itself, and every log that it leaves is re-executed.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile, digest
from tests.onehop.scenes import FIELD, field, log_of

pytestmark = pytest.mark.live

DEADLINE_S = 120.0


class Mission:
    """`onehop run` of the small scene in a child, with its log growing in `out`."""

    def __init__(self, folder: Path, *settings: str) -> None:
        self.out = folder / "out"
        scenario = folder / "field.toml"
        scenario.write_text(FIELD)
        command = [
            sys.executable,
            "-m",
            "onehop",
            "run",
            str(scenario),
            "--json",
            "--out",
            str(self.out),
        ]
        for setting in settings:
            command += ["--set", setting]
        self.child = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
        )

    def finish(self) -> dict[str, Any]:
        """The summary; the child's own end is part of what is tested."""
        told, said = self.child.communicate(timeout=DEADLINE_S)
        assert told, said
        summary: dict[str, Any] = json.loads(told)
        return summary

    def family(self) -> dict[str, int]:
        """Processes of the mission by name, from the process table: what `ps` would show."""
        found: dict[str, int] = {}
        for entry in Path("/proc").iterdir():
            try:
                words = (entry / "cmdline").read_text().split("\0") if entry.name.isdigit() else []
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1]) if words else 0
            except OSError:
                continue
            if parent == self.child.pid and "-m" in words:
                name = words[words.index("-m") + 1]
                if name == "robot_agent":
                    name += f" {words[words.index('--id') + 1]}"
                found[name] = int(entry.name)
        return found

    def await_ticks(self, size: int = 60_000) -> None:
        """Wait until the log has grown: the mission is under way."""
        log = self.out / "mission.mcap"
        deadline = time.monotonic() + DEADLINE_S
        while not (log.exists() and log.stat().st_size > size):
            assert time.monotonic() < deadline
            assert self.child.poll() is None
            time.sleep(0.005)


def _gone(pids: list[int]) -> bool:
    deadline = time.monotonic() + 15.0
    while time.monotonic() < deadline:
        if not any(Path(f"/proc/{pid}").exists() for pid in pids):
            return True
        time.sleep(0.05)
    return False


@pytest.fixture
def mission(tmp_path: Path) -> Iterator[Mission]:
    running = Mission(tmp_path, "clock.limit_s=60")
    yield running
    if running.child.poll() is None:
        running.child.kill()
    running.child.communicate()


FAULTS = (
    "faults=[{kind='kill', at_s=4, robots=[2]}, {kind='restart', at_s=9, robots=[2]},"
    " {kind='cut', at_s=5, robots=[1], duration_s=3}, {kind='hold', at_s=6, robots=[4], duration_s=2}]"
)


@pytest.mark.parametrize("settings", [(), (FAULTS, "clock.limit_s=20")], ids=["quiet", "faults"])
def test_processes_log_the_same_bytes_as_one_process(tmp_path: Path, settings: tuple[str, ...]) -> None:
    inline = log_of(field(tmp_path, *settings), tmp_path / "inline.mcap")
    summary = Mission(tmp_path, *settings).finish()
    assert summary["digest"] == inline
    log = LogFile(tmp_path / "out" / "mission.mcap")
    assert digest(log) == inline
    assert replay(log).divergences == 0
    names = [process["name"] for process in summary["processes"]]
    assert names[:7] == ["world", "radio", "recorder", "robot-1", "robot-2", "robot-3", "robot-4"]
    assert _gone([process["pid"] for process in summary["processes"]])


def test_two_missions_side_by_side_do_not_disturb_each_other(tmp_path: Path) -> None:
    folders = [tmp_path / "a", tmp_path / "b"]
    for folder in folders:
        folder.mkdir()
    running = [Mission(folder, "clock.limit_s=10") for folder in folders]
    digests = {one.finish()["digest"] for one in running}
    assert digests == {log_of(field(tmp_path, "clock.limit_s=10"), tmp_path / "inline.mcap")}


def test_a_killed_robot_is_fenced_and_the_mission_goes_on(mission: Mission) -> None:
    mission.await_ticks()
    os.kill(mission.family()["robot_agent 3"], signal.SIGKILL)
    summary = mission.finish()
    assert summary["outcome"] in ("arrived", "failed")
    assert {"robot": 3, "why": "its process died"}.items() <= summary["lost"][-1].items()
    log = LogFile(mission.out / "mission.mcap")
    assert digest(log) == summary["digest"]
    assert replay(log).divergences == 0


@pytest.mark.parametrize(
    ("victim", "reason"),
    [
        ("radio_proxy", "the radio process died"),
        ("onehop.recorder", "the recorder process died"),
        ("world_server", "the world process died (SIGKILL)"),
    ],
)
def test_without_radio_recorder_or_world_the_mission_is_aborted(
    mission: Mission, victim: str, reason: str
) -> None:
    mission.await_ticks()
    family = mission.family()
    os.kill(family[victim], signal.SIGKILL)
    summary = mission.finish()
    assert (summary["outcome"], summary["reason"]) == ("aborted", reason)
    assert mission.child.returncode == 1
    assert _gone(list(family.values()))
    log = LogFile(mission.out / "mission.mcap")
    ticks = [tick.tick for tick in log.ticks()]
    assert ticks == list(range(len(ticks)))
    assert log.torn is (victim == "onehop.recorder")
    assert replay(log).divergences == 0


def test_a_stopped_robot_is_fenced_as_well(mission: Mission) -> None:
    mission.await_ticks()
    pid = mission.family()["robot_agent 2"]
    os.kill(pid, signal.SIGSTOP)
    summary = mission.finish()
    assert 2 in [lost["robot"] for lost in summary["lost"]]
    assert _gone([pid])


def test_a_killed_launcher_leaves_no_process_behind(mission: Mission) -> None:
    mission.await_ticks()
    family = mission.family()
    assert len(family) == 7
    os.kill(family["robot_agent 4"], signal.SIGSTOP)
    mission.child.kill()
    assert _gone(list(family.values()))


def test_ctrl_c_finishes_the_log_and_exits_130(mission: Mission) -> None:
    mission.await_ticks()
    family = mission.family()
    mission.child.send_signal(signal.SIGINT)
    mission.child.communicate(timeout=DEADLINE_S)
    assert mission.child.returncode == 130
    assert _gone(list(family.values()))
    log = LogFile(mission.out / "mission.mcap")
    assert digest(log)
    assert not log.torn
    assert log.summary is not None
    assert log.summary["reason"] == "stopped by the operator"
