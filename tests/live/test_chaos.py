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


def _children(pid: int) -> list[str]:
    return Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
