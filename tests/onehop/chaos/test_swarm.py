"""What is drawn: missions that can be run, the same for a seed, and survivable within the budget."""

from pathlib import Path
from typing import get_args

import pytest

from onehop.chaos.swarm import draw_mission
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GainPolicyName
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle

SEEDS = range(1, 61)


@pytest.fixture(scope="module")
def base() -> Bundle:
    return scenario_file.load(Path(__file__).parents[3] / "scenarios" / "map1.toml")


@pytest.fixture(scope="module")
def drawn(base: Bundle) -> list[Scenario]:
    return [draw_mission(base, seed, budget=True).scenario for seed in SEEDS]


def test_drawn_missions_are_possible(base: Bundle, drawn: list[Scenario]) -> None:
    without = [draw_mission(base, seed, budget=False).scenario for seed in SEEDS]
    for scenario in (*drawn, *without):
        assert list(scenario.problems()) == []


def test_a_seed_always_draws_the_same(base: Bundle, drawn: list[Scenario]) -> None:
    assert [draw_mission(base, seed, budget=True).scenario for seed in SEEDS[:10]] == drawn[:10]


def test_seeds_draw_different_things(drawn: list[Scenario]) -> None:
    assert {len(one.team.robots) for one in drawn} >= set(range(2, 9))
    assert {one.radio.routing for one in drawn} == {"direct", "mrsr", "mrdv"}
    assert {one.gains.policy for one in drawn} == set(get_args(GainPolicyName))
    assert {one.map.width for one in drawn} > {100.0}
    assert {fault.kind for one in drawn for fault in one.faults} >= {"kill", "cut", "kidnap", "slow"}


def for_good(scenario: Scenario) -> set[int]:
    """Robots that a script leaves dead, stopped, held, blind, slow or cut off from all the rest."""
    lasting: set[int] = set()
    for fault in scenario.faults:
        lasts = fault.kind in ("stop", "hold", "blind", "slow") or (
            fault.kind == "cut" and not fault.others
        )
        if fault.kind in ("restart", "continue"):
            lasting -= set(fault.robots)
        elif (fault.kind == "kill" and not fault.on) or (lasts and not fault.duration_s):
            lasting |= set(fault.robots)
    return lasting


def test_within_the_budget_somebody_is_whole_in_the_end(drawn: list[Scenario]) -> None:
    for scenario in drawn:
        assert for_good(scenario) < set(scenario.team.robots)
        for fault in scenario.faults:
            assert fault.kind not in ("corrupt", "jam", "hold", "blind", "slow") or fault.duration_s


def test_without_it_anything_may_break_for_good(base: Bundle) -> None:
    free = [draw_mission(base, seed, budget=False).scenario for seed in SEEDS]
    assert any(for_good(scenario) == set(scenario.team.robots) for scenario in free)


def test_what_is_drawn_of_one_thing_changes_nothing_of_another(base: Bundle) -> None:
    """The same seed on another map: the team, its gains and the radio stay."""
    other = scenario_file.load(Path(__file__).parents[3] / "scenarios" / "indoor.toml")
    for seed in SEEDS[:10]:
        one, two = (draw_mission(bundle, seed, budget=True).scenario for bundle in (base, other))
        assert (one.team, one.gains, one.robot) == (two.team, two.gains, two.robot)
