"""Campaigns: what was found once holds now, a sample finds nothing, and seeded bugs are found."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from onehop.chaos.hunt import MISSIONS
from onehop.chaos.trial import tried
from onehop.scenario import scenario_file
from tests.live.mission import gone
from tests.onehop.chaos import seeded_bugs

ROOT = Path(__file__).parents[3]
CORPUS = sorted(Path(__file__).with_name("corpus").glob("*.toml"))
MAP1 = "scenarios/map1.toml"


@pytest.mark.slow
@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_what_was_found_once_holds_now(path: Path) -> None:
    bundle = scenario_file.load(path)
    assert tried(bundle).failures == ()


def chaos(*arguments: str, cwd: Path = ROOT) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "onehop", "chaos", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=cwd)


def told(done: "subprocess.CompletedProcess[str]") -> dict[str, Any]:
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


@pytest.mark.live
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


@pytest.mark.slow
def test_without_a_budget_nothing_happens_that_must_never_happen(tmp_path: Path) -> None:
    done = chaos(MAP1, "--runs", "6", "--no-budget", "--json", "--out", str(tmp_path / "out"))
    assert (done.returncode, told(done)["failures"]) == (0, [])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["joining makes no new epoch", "a leader never yields"])
def test_seeded_bugs_are_found_and_made_small(tmp_path: Path, name: str) -> None:
    answer = seeded_bugs.hunt(seeded_bugs.BUGS[name], tmp_path, 20, 2, shrink_runs=40)
    assert answer["failures"]
    scenario = scenario_file.load(tmp_path / answer["failures"][0]["scenario"]).scenario
    assert len(scenario.faults) <= 3
    as_is = ("--as-is", "--json", "--shrink-runs", "0", "--out", str(tmp_path / "again"))
    again = seeded_bugs.run_in(tmp_path, answer["failures"][0]["scenario"], *as_is)
    assert {one["invariant"] for one in told(again)["failures"]} >= {answer["failures"][0]["invariant"]}
    assert again.returncode in (1, 3)


@pytest.mark.live
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


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("nowhere.toml",), "nowhere.toml"),
        ((MAP1, "--processes", "1.5"), "--processes"),
        ((MAP1, "--jobs", "0"), "--jobs"),
        ((MAP1, "--corpus", "nowhere"), "nowhere"),
        ((MAP1, "--corpus", "docs"), "--corpus docs: has no scenario file"),
    ],
)
def test_what_cannot_be_run_is_one_line(arguments: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = chaos(*arguments, "--runs", "1", "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert says in done.stderr


def test_results_of_another_campaign_are_not_mixed(tmp_path: Path) -> None:
    assert chaos(MAP1, "--runs", "0", "--out", str(tmp_path)).returncode == 0
    done = chaos(MAP1, "--runs", "0", "--no-budget", "--out", str(tmp_path))
    assert done.returncode == 2
    assert "something else (budget differ)" in done.stderr
