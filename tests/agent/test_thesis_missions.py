"""The thesis's own stack as a team (`profile = "thesis"`): missions of chapter 4 (docs/thesis.md)."""

from pathlib import Path

import pytest

from onehop.contracts.messages import Outcome
from onehop.drivers import inline
from onehop.scenario import scenario_file

THESIS = Path(__file__).parents[2] / "scenarios" / "thesis"


def mission(name: str, seed: int, *settings: str) -> Outcome:
    """One of the thesis's missions, in this process."""
    return inline.run(scenario_file.load(THESIS / f"{name}.toml", settings, seed), None)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["map1", "map2", "map3"])
@pytest.mark.parametrize("routing", ["mrsr", "mrdv"])
def test_without_a_delay_all_arrive_and_nobody_touches_anything(name: str, routing: str) -> None:
    """Thesis 4.2: under ideal mission conditions all followers arrive at the goal point."""
    for seed in (1, 2):
        outcome = mission(name, seed, f"radio.routing={routing}")
        assert outcome.outcome == "arrived", outcome.reason
        assert outcome.arrived == (1, 2, 3, 4, 5, 6)
        assert outcome.collisions == 0


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["throughput", "constant"])
def test_both_policies_are_compared_on_the_same_way_with_a_delay_at_60_s(policy: str) -> None:
    """Thesis 4.2: the leader's path is saved once, and driven for each policy."""
    held = "faults=[{kind='hold', at_s=60, robots=[1, 2, 4, 5, 6], duration_s=5}]"
    outcome = mission("map1", 1, f"gains.policy={policy}", held)
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.collisions == 0


@pytest.mark.slow
def test_the_predictive_policy_keeps_whom_others_lose_in_a_delay_of_20_s() -> None:
    """docs/policies.md: on map 1 at 0.3/s, five seeds; here the first two."""
    held = "faults=[{kind='hold', at_s=60, robots=[1, 2, 4, 5, 6], duration_s=20}]"
    settings = "gains.k_rho_min=0.3", "clock.limit_s=450", held
    lost = {
        policy: [len(mission("map1", seed, f"gains.policy={policy}", *settings).lost) for seed in (1, 2)]
        for policy in ("constant", "predictive")
    }
    assert lost["predictive"] == [0, 0]
    assert min(lost["constant"]) > 0


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["predictive", "lambda2"])
def test_policies_that_steer_touch_nobody_and_arrive(policy: str) -> None:
    outcome = mission("map2", 1, f"gains.policy={policy}")
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.arrived == (1, 2, 3, 4, 5, 6)
    assert outcome.collisions == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["map1", "map2"])
def test_algorithm_2_brings_the_team_to_the_goal_without_a_saved_path(name: str) -> None:
    outcome = mission(name, 1, "planner.kind=modified", "clock.limit_s=1500")
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.collisions == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "leader", "members", "shape", "at_s"),
    [
        ("follower-5-lost", 3, (1, 2, 3, 4, 6), "wedge", 64.0),  # figure 3.3
        ("followers-6-and-1-lost", 3, (2, 3, 4, 5), "diamond", 64.0),  # figure 4.21
        ("leader-3-lost", 4, (1, 2, 4, 5, 6), "wedge", 64.5),  # figure 4.22
        ("leader-3-of-five-lost", 2, (1, 2, 4, 5), "diamond", 64.5),  # figure 3.4 a
        ("follower-4-of-five-lost", 2, (1, 2, 3, 5), "diamond", 64.0),  # figure 3.4 b
        ("leader-3-cut-off", 4, (1, 2, 4, 5, 6), "wedge", 64.5),  # 4.3
    ],
)
def test_failing_robots_lead_to_the_thesiss_leader_and_shape(
    name: str, leader: int, members: tuple[int, ...], shape: str, at_s: float
) -> None:
    outcome = mission(name, 1)
    assert outcome.outcome == "arrived", outcome.reason
    assert outcome.collisions == 0
    terms = [(term.leader, term.members, term.shape) for term in outcome.leaders if term.at_s < at_s]
    assert terms[-1] == (leader, members, shape)
    assert set(members) <= set(outcome.arrived)
