"""Studies that are killed or stopped."""

import json
import os
import signal
import subprocess
from pathlib import Path

import pytest

from onehop.study.chapter4.study import DELAYED
from onehop.study.phase.study import CELLS
from tests.live.mission import gone
from tests.live.test_sweep import await_rows, workers_of
from tests.onehop.study.test_study_command import command, told, without_rate
from tests.onehop.study.test_sweep_command import names

pytestmark = pytest.mark.live


def started(what: str, folder: Path, *arguments: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        command(what, folder, "out", *arguments),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def test_a_study_that_is_killed_is_gone_on_with(tmp_path: Path) -> None:
    """The parent is killed; its workers end with it, and no row is lost or there twice."""
    cells = tmp_path / "out" / CELLS
    running = started("policies", tmp_path, "--jobs", "2")
    await_rows(cells, 3)
    workers = workers_of(running.pid)
    os.kill(running.pid, signal.SIGKILL)
    running.communicate()
    assert gone(workers)
    before = names(cells)
    answer = told("policies", tmp_path, "out", "--jobs", "2")
    assert names(cells)[: len(before)] == before
    assert len(set(names(cells))) == len(names(cells)) == answer["missions"] == 16
    again = told("policies", tmp_path, "out", "--jobs", "1")
    assert (again["missions_per_s"], without_rate(again)) == (0.0, without_rate(answer))


def test_ctrl_c_tells_what_is_known_of_chapter_4(tmp_path: Path) -> None:
    running = started("thesis", tmp_path, "--seeds", "500", "--jobs", "2")
    await_rows(tmp_path / "out" / DELAYED, 12)
    os.kill(running.pid, signal.SIGINT)
    printed, said = running.communicate(timeout=120)
    assert running.returncode == 130
    assert "Traceback" not in said
    answer = json.loads(printed)
    assert 12 <= answer["missions"] < answer["wanted"] == 6000
    assert sum(cell["seeds"] for cell in answer["cells"]) == answer["missions"]
    assert answer["page"] is None
    assert json.loads((tmp_path / "out" / "study.json").read_text()) == answer
