"""Campaigns of chaos with processes, and stopped by hand."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from onehop.chaos.hunt import MISSIONS
from tests.live.mission import gone
from tests.onehop.chaos.test_campaign import MAP1, ROOT, chaos, told

pytestmark = pytest.mark.live


def test_a_sample_breaks_nothing(tmp_path: Path) -> None:
    """Some as processes, some twice; gone on with, it has nothing more to do."""
    arguments = (MAP1, "--runs", "8", "--processes", "0.1", "--twice-every", "4", "--json")
    done = chaos(*arguments, "--out", str(tmp_path / "out"))
    answer = told(done)
    assert (done.returncode, answer["failures"]) == (0, [])
    assert answer["runs"] == 8
    assert min(answer["repeated"].values()) >= 1
    assert (tmp_path / "out" / "chaos.html").read_text().count("<tr>") >= 8
    rows = (tmp_path / "out" / MISSIONS).read_bytes()
    again = told(chaos(*arguments, "--out", str(tmp_path / "out")))
    assert (again["runs"], again["missions_per_s"]) == (8, 0.0)
    assert (tmp_path / "out" / MISSIONS).read_bytes() == rows


def test_ctrl_c_keeps_what_was_found(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "onehop", "chaos", MAP1, "--runs", "1000", "--jobs", "2"]
    folder = tmp_path / "out"
    running = subprocess.Popen(
        [*command, "--out", str(folder), "--json"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT,
    )  # fmt: skip
    deadline = time.monotonic() + 120.0
    while not (folder / MISSIONS).exists() or (folder / MISSIONS).read_bytes().count(b"\n") < 4:
        assert time.monotonic() < deadline
        time.sleep(0.1)
    workers = [int(pid) for pid in _children(running.pid)]
    os.kill(running.pid, signal.SIGINT)
    printed, said = running.communicate(timeout=60)
    assert running.returncode == 130
    assert "Traceback" not in said
    answer = json.loads(printed)
    assert answer["runs"] >= 3
    assert (folder / MISSIONS).read_bytes().count(b"\n") == 1 + answer["runs"]
    assert gone(workers)


RAM = """
from onehop.robot import Action, Program, Twist

class Ram(Program):
    def __init__(self, briefing):
        self.fast = briefing.robot > 1

    def step(self, percept):
        return Action(Twist(1.0 if self.fast else 0.0, 0.0))
"""


def test_a_users_program_is_found_wherever_its_missions_are_copied(tmp_path: Path) -> None:
    """Drawn, as processes, made small, and again from the small scenario file, from elsewhere."""
    project, elsewhere = tmp_path / "mine", tmp_path / "elsewhere"
    project.mkdir()
    elsewhere.mkdir()
    (project / "ram.py").write_text(RAM)
    head = 'program = "ram:Ram"\nsize = 3\n[[robots]]\nid = 3\n[goal]\nx = 10\ny = 12\n'
    (project / "mission.toml").write_text(
        f"[map]\nwidth = 24\nheight = 24\n[start]\nx = 6\ny = 12\n[team]\n{head}"
    )
    words = (str(project / "mission.toml"), "--runs", "1", "--processes", "1", "--shrink-runs", "2")
    found = told(chaos(*words, "--json", "--out", "out", cwd=elsewhere))["failures"]
    assert {one["invariant"] for one in found} >= {"no-collision"}
    assert "same-bytes" not in {one["invariant"] for one in found}
    assert "program failed" not in (elsewhere / "out" / MISSIONS).read_text()
    small = next(one["scenario"] for one in found if one["invariant"] == "no-collision")
    again = chaos(small, "--as-is", "--shrink-runs", "0", "--json", "--out", "again", cwd=elsewhere)
    assert {one["invariant"] for one in told(again)["failures"]} >= {"no-collision"}


def test_a_program_that_is_nowhere_is_one_line_before_any_mission(tmp_path: Path) -> None:
    done = chaos(MAP1, "--set", "team.program=nowhere:Robot", "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert done.stderr.startswith(f"onehop: {MAP1}: team.program: 'nowhere:Robot': No module named")
    assert not (tmp_path / "out").exists()


def _children(pid: int) -> list[str]:
    return Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
