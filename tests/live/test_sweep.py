"""Sweeps that are killed, stopped, or run as processes."""

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from onehop.study.sweeping import ROWS
from tests.live.mission import gone
from tests.onehop.study.test_sweep_command import HOLD, OVER, command, names, sweep, told

pytestmark = pytest.mark.live


def started(folder: Path, *arguments: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        command(folder, *arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def await_rows(folder: Path, count: int) -> None:
    """Wait until so many missions have their rows."""
    deadline = time.monotonic() + 120.0
    while not (folder / ROWS).exists() or (folder / ROWS).read_bytes().count(b"\n") <= count:
        assert time.monotonic() < deadline
        time.sleep(0.02)


def workers_of(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def test_a_sweep_that_is_killed_is_gone_on_with(tmp_path: Path) -> None:
    """Each time the parent is killed; its workers end with it, and only what was in flight is lost."""
    out = tmp_path / "out"
    arguments = (*OVER, *HOLD, "--seeds", "3", "--jobs", "2", "--out", str(out), "--json")
    for count in (2, 6):
        running = started(tmp_path, *arguments)
        await_rows(out, count)
        workers = workers_of(running.pid)
        os.kill(running.pid, signal.SIGKILL)
        running.communicate()
        assert gone(workers)
    before = names(out)
    assert len(before) >= 6
    answer = told(sweep(tmp_path, *arguments))
    assert answer["missions"] == 12
    assert names(out)[: len(before)] == before
    assert len(set(names(out))) == len(names(out)) == 12


def test_a_worker_that_is_killed_costs_no_mission(tmp_path: Path) -> None:
    out = tmp_path / "out"
    running = started(tmp_path, *OVER, *HOLD, "--seeds", "3", "--jobs", "2", "--out", str(out), "--json")
    await_rows(out, 2)
    for pid in workers_of(running.pid):
        if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes():
            os.kill(pid, signal.SIGKILL)
            break
    printed, said = running.communicate(timeout=120)
    assert running.returncode == 0, said
    answer = json.loads(printed)
    assert (answer["missions"], answer["crashed"]) == (12, [])
    assert len(set(names(out))) == len(names(out)) == 12


def test_ctrl_c_keeps_what_is_done(tmp_path: Path) -> None:
    out = tmp_path / "out"
    running = started(
        tmp_path, *OVER, *HOLD, "--seeds", "500", "--jobs", "2", "--out", str(out), "--json"
    )
    await_rows(out, 5)
    workers = workers_of(running.pid)
    os.kill(running.pid, signal.SIGINT)
    printed, said = running.communicate(timeout=60)
    assert running.returncode == 130
    assert "Traceback" not in said
    answer = json.loads(printed)
    assert 5 <= answer["missions"] == len(names(out)) < answer["wanted"] == 2000
    assert sum(cell["seeds"] for cell in answer["cells"]) == answer["missions"]
    assert gone(workers)
    if answer["table"] is not None:
        polars = pytest.importorskip("polars")
        assert len(polars.read_parquet(answer["table"])) == answer["missions"]


def test_missions_as_processes_leave_the_same_bytes(tmp_path: Path) -> None:
    limit = ("--set", "clock.limit_s=4", "--set", "team.size=2")
    out = ("--out", str(tmp_path / "out"), "--json")
    answer = told(sweep(tmp_path, *limit, "--seeds", "2", "--jobs", "1", "--processes", "1", *out))
    assert answer["as_processes"] == {"same": 2}
