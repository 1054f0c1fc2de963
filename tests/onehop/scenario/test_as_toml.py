"""A scenario written as a file is the same scenario when it is read."""

import dataclasses
import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.chaos.swarm import draw_mission
from onehop.contracts.scenario import NAME_BYTES
from onehop.scenario import scenario_file
from onehop.scenario.as_toml import as_toml
from onehop.scenario.structure import structure
from tests.onehop.scenes import field

SCENARIOS = sorted((Path(__file__).parents[3] / "scenarios").rglob("*.toml"))


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_our_scenarios_come_back(path: Path) -> None:
    scenario = scenario_file.load(path).scenario
    assert structure(tomllib.loads(as_toml(scenario)), "it") == scenario


@pytest.mark.parametrize("seed", range(1, 31))
def test_drawn_missions_come_back(seed: int) -> None:
    base = scenario_file.load(SCENARIOS[1])
    scenario = draw_mission(base, seed, budget=bool(seed % 2)).scenario
    assert structure(tomllib.loads(as_toml(scenario)), "it") == scenario


@given(st.text(min_size=1, max_size=30).filter(lambda text: text.isprintable()))
def test_whatever_it_is_called(name: str) -> None:
    table = {"name": f"a{name}", "goal": {"x": 1.5, "y": -2e-7}, "map": {"file": "a b\x7f\"'\\.yaml"}}
    if len(table["name"].encode()) > NAME_BYTES or any(mark in name for mark in "/\\"):
        return
    scenario = structure(table, "it")
    assert structure(tomllib.loads(as_toml(scenario)), "it") == scenario


def test_what_a_profile_would_fill_in_is_said(tmp_path: Path) -> None:
    table = {
        "name": "a",
        "profile": "thesis",
        "goal": {"x": 1, "y": 1},
        "map": {"width": 9, "height": 9},
    }
    scenario = structure({**table, "gains": {"reverse": False}}, "it")
    (tmp_path / "a.toml").write_text(as_toml(scenario))
    assert scenario_file.load(tmp_path / "a.toml").scenario == scenario


def test_only_what_is_not_usual_is_said(tmp_path: Path) -> None:
    scenario = dataclasses.replace(field(tmp_path).scenario, seed=1)
    text = as_toml(scenario, "Why it is here.\nAnd how.")
    assert text.startswith("# Why it is here.\n# And how.\n\nname = ")
    assert "[radio]" not in text
    assert "seed" not in text
