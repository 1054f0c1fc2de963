"""`onehop plan`: what it says, for people and as JSON."""

import json
import tomllib
from pathlib import Path

import pytest

from onehop.commands.plan import plan

MAP = Path(__file__).resolve().parents[3] / "scenarios" / "map1.toml"

PROMISED = {
    "reached", "answer", "steps", "path_length_m", "shortest_m", "replans", "backtracks",
    "min_clearance_m", "contacts", "plan_ms_p50", "plan_ms_p99", "follow_us_mean",
}  # fmt: skip


def run(limit_s: float, goal: str, as_json: bool) -> int:
    settings = [f"clock.limit_s={limit_s}"]
    return plan(MAP, "10,10", goal, None, 1, None, settings, None, None, as_json)


def test_a_leader_that_arrives_is_told_with_the_promised_keys(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(30.0, "15,10", True) == 0
    answer = json.loads(capsys.readouterr().out)
    assert set(answer) == PROMISED
    assert answer["reached"] is True
    assert answer["answer"] == "arrived"


@pytest.mark.parametrize("as_json", [False, True])
def test_the_time_limit_is_told_with_the_key_that_sets_it(
    as_json: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(2.5, "90,90", as_json) == 1
    told = capsys.readouterr().out
    if as_json:
        answer = json.loads(told)
        assert answer["reached"] is False
        assert answer["answer"] == "time limit of 2.5 s (clock.limit_s)"
    else:
        assert "answer         time limit of 2.5 s (clock.limit_s)" in told


def test_the_way_can_be_written_as_a_path_and_driven_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    way = tmp_path / "way.toml"
    assert plan(MAP, "10,10", "22,10", "modified", 1, None, [], None, way, True) == 0
    table = tomllib.loads(way.read_text())["planner"]
    settings = [f"planner.path={table['path']}"]
    capsys.readouterr()
    assert plan(MAP, "10,10", "22,10", table["kind"], 1, None, settings, None, None, True) == 0
    assert json.loads(capsys.readouterr().out)["path_length_m"] == pytest.approx(11.8, abs=0.4)


def test_a_path_is_not_written_of_a_way_that_did_not_arrive(tmp_path: Path) -> None:
    way = tmp_path / "way.toml"
    settings = ["clock.limit_s=2"]
    assert plan(MAP, "10,10", "90,90", None, 1, None, settings, None, way, True) == 1
    assert not way.exists()
