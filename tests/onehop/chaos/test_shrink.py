"""A failing mission becomes small: what is left is what it takes, and nothing else."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest

from onehop.chaos.properties import ARRIVAL
from onehop.chaos.shrink import shrink
from onehop.chaos.swarm import draw_mission
from onehop.chaos.trial import Failure, Trial
from onehop.contracts.scenario import Scenario
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle

Breaks = Callable[[Scenario], bool]


def judge_of(breaks: Breaks, name: str, tick: int) -> Callable[[Bundle, str], Trial]:
    """Stands for a run: a mission fails when `breaks` says so."""

    def call(bundle: Bundle, only: str) -> Trial:
        assert only == name
        ends = bundle.scenario.clock.limit_s * 1000.0 / bundle.scenario.clock.period_ms
        fails = breaks(bundle.scenario) and (name == ARRIVAL or ends > tick)
        return Trial({}, (Failure(name, tick, (), "broken"),) if fails else (), {}, {})

    return call


def a_mission(breaks: Breaks) -> Bundle:
    """The first drawn mission that a condition holds of."""
    base = scenario_file.load(Path(__file__).parents[3] / "scenarios" / "map1.toml")
    missions = (draw_mission(base, seed, budget=True) for seed in range(1, 500))
    return next(one for one in missions if breaks(one.scenario) and len(one.scenario.faults) > 6)


def kills_and_cuts(scenario: Scenario) -> bool:
    return {"kill", "cut"} <= {fault.kind for fault in scenario.faults}


def has_three_robots_and_one_hold(scenario: Scenario) -> bool:
    return len(scenario.team.robots) >= 3 and any(fault.kind == "hold" for fault in scenario.faults)


def relays_over_blocks(scenario: Scenario) -> bool:
    return scenario.radio.routing == "mrsr" and len(scenario.map.obstacles) >= 2


def stops_for_long(scenario: Scenario) -> bool:
    return any(fault.kind == "stop" and fault.duration_s >= 2.0 for fault in scenario.faults)


@pytest.mark.parametrize(
    ("breaks", "faults", "robots", "obstacles"),
    [
        (kills_and_cuts, 2, 2, 0),
        (has_three_robots_and_one_hold, 1, 3, 0),
        (relays_over_blocks, 0, 1, 2),
        (stops_for_long, 1, 1, 0),
    ],
)
def test_what_is_left_is_what_it_takes(breaks: Breaks, faults: int, robots: int, obstacles: int) -> None:
    bundle = a_mission(breaks)
    failure = Failure("median", 100, (), "broken")
    small = shrink(bundle, failure, 2000, judge_of(breaks, "median", 100))
    left = small.bundle.scenario
    assert small.is_smallest
    assert breaks(left)
    assert (len(left.faults), len(left.team.robots), len(left.map.obstacles)) == (
        faults,
        robots,
        obstacles,
    )
    assert left.clock.limit_s == pytest.approx(101 * 0.05, abs=0.1)
    assert list(left.problems()) == []


def test_values_become_the_usual_ones_but_for_what_it_takes() -> None:
    bundle = a_mission(relays_over_blocks)
    judge = judge_of(relays_over_blocks, "median", 1)
    left = shrink(bundle, Failure("median", 1, (), "broken"), 2000, judge).bundle.scenario
    usual = type(left.radio)(routing="mrsr")
    assert left.radio == usual
    assert left.gains == type(left.gains)()


def test_times_become_short_and_round() -> None:
    bundle = a_mission(stops_for_long)
    judge = judge_of(stops_for_long, "median", 1)
    (fault,) = shrink(bundle, Failure("median", 1, (), "broken"), 2000, judge).bundle.scenario.faults
    assert fault.duration_s in (2.0, 3.0)
    assert fault.at_s in (0.0, None)


def test_a_mission_that_does_not_arrive_keeps_its_time() -> None:
    bundle = a_mission(kills_and_cuts)
    small = shrink(
        bundle, Failure(ARRIVAL, 4000, (), "broken"), 2000, judge_of(kills_and_cuts, ARRIVAL, 4000)
    )
    assert small.bundle.scenario.clock.limit_s == bundle.scenario.clock.limit_s


def test_it_ends_when_its_runs_are_used_up() -> None:
    bundle = a_mission(kills_and_cuts)
    judge = judge_of(kills_and_cuts, "median", 100)
    small = shrink(bundle, Failure("median", 100, (), "broken"), 5, judge)
    assert (small.runs, small.is_smallest) == (5, False)
    assert kills_and_cuts(small.bundle.scenario)


def test_a_failure_of_another_kind_does_not_count() -> None:
    bundle = a_mission(kills_and_cuts)

    def judge(candidate: Bundle, only: str) -> Trial:
        return Trial({}, (Failure("epochs", 1, (), f"not {only}, {candidate}"),), {}, {})

    small = shrink(bundle, Failure("median", 100, (), "broken"), 50, judge)
    assert small.bundle == bundle
    assert dataclasses.asdict(small.failure)["property"] == "median"
