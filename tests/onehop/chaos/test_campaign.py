"""Campaigns: what was found once holds now, a sample finds nothing, and seeded bugs are found."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from onehop.chaos.trial import tried
from onehop.scenario import scenario_file
from tests.onehop.chaos import seeded_bugs
from tests.onehop.command_line import onehop

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


@pytest.mark.slow
def test_without_a_budget_nothing_happens_that_must_never_happen(tmp_path: Path) -> None:
    done = chaos(MAP1, "--runs", "3", "--no-budget", "--json", "--out", str(tmp_path / "out"))
    assert (done.returncode, told(done)["failures"]) == (0, [])


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "joining makes no new epoch",
        pytest.param("a leader never yields", marks=pytest.mark.campaign),
    ],
)
def test_seeded_bugs_are_found_and_made_small(tmp_path: Path, name: str) -> None:
    answer = seeded_bugs.hunt(seeded_bugs.BUGS[name], tmp_path, 20, 2, shrink_runs=40)
    assert answer["failures"]
    scenario = scenario_file.load(tmp_path / answer["failures"][0]["scenario"]).scenario
    assert len(scenario.faults) <= 3
    as_is = ("--as-is", "--json", "--shrink-runs", "0", "--out", str(tmp_path / "again"))
    again = seeded_bugs.run_in(tmp_path, answer["failures"][0]["scenario"], *as_is)
    assert {one["invariant"] for one in told(again)["failures"]} >= {answer["failures"][0]["invariant"]}
    assert again.returncode in (1, 3)


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
    done = onehop("chaos", *arguments, "--runs", "1", "--out", tmp_path / "out", cwd=ROOT)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert says in done.stderr


def test_results_of_another_campaign_are_not_mixed(tmp_path: Path) -> None:
    assert chaos(MAP1, "--runs", "0", "--out", str(tmp_path)).returncode == 0
    done = chaos(MAP1, "--runs", "0", "--no-budget", "--out", str(tmp_path))
    assert done.returncode == 2
    assert "something else (budget differ)" in done.stderr
