"""Which missions chapter 4 is made of."""

from pathlib import Path

import pytest

from onehop.contracts.errors import InputError
from onehop.contracts.team import Mode, Shape, Status
from onehop.study.chapter4 import missions
from onehop.study.chapter4.failing import EXPECTED, leader_of_most
from onehop.study.chapter4.reported import REPORTED
from onehop.study.chapter4.shown import typical_seed
from robot_agent.core.team.formation import median_leader, shape_of
from tests.onehop.study.rows import row

SCENARIOS = Path(__file__).parents[4] / "scenarios" / "thesis"


def test_the_twelve_cells_differ_in_map_routing_and_policy_alone() -> None:
    cells = missions.delayed(SCENARIOS, (), 1)
    assert [tuple(cell.values.values()) for cell in cells] == list(REPORTED)
    for cell in cells:
        scenario = cell.bundle.scenario
        assert scenario.name == f"thesis-{cell.values['map']}"
        assert scenario.radio.routing == cell.values["routing"]
        assert scenario.gains.policy == cell.values["policy"]
        assert scenario.gains.k_rho_min == missions.K_RHO_MIN
        assert scenario.planner.kind == "path"
        (hold,) = scenario.faults
        assert (hold.kind, hold.at_s, hold.robots) == ("hold", 60.0, (1, 2, 4, 5, 6))


def test_settings_of_the_command_line_win() -> None:
    (cell, *_) = missions.delayed(SCENARIOS, ["faults[0].duration_s=3", "gains.k_rho_min=0.7"], 1)
    scenario = cell.bundle.scenario
    assert (scenario.faults[0].duration_s, scenario.gains.k_rho_min) == (3.0, 0.7)


def test_nobody_is_held_in_ideal_conditions() -> None:
    assert all(not cell.bundle.scenario.faults for cell in missions.undelayed(SCENARIOS, (), 1))


def test_a_folder_without_the_missions_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"map1\.toml: no such file"):
        missions.delayed(tmp_path, (), 1)


def test_what_is_reported_is_chapter_4s_table() -> None:
    """Thesis 4.2.1 to 4.2.3."""
    lost = {place: one.lost for place, one in REPORTED.items() if place[2] == "constant"}
    assert list(lost.values()) == [1, 1, 3, 2, 3, 4]
    variable = [one.lost for place, one in REPORTED.items() if place[2] == "throughput"]
    assert variable == [0, 0, 0, 0, 0, None]


@pytest.mark.parametrize("name", EXPECTED)
def test_what_is_expected_of_failing_robots_is_algorithm_1(name: str) -> None:
    expected = EXPECTED[name]
    assert expected.leader == median_leader(expected.members)
    assert expected.shape == shape_of(len(expected.members))
    assert (SCENARIOS / f"{name}.toml").exists()


def test_the_seed_that_is_drawn_is_the_first_of_the_most_common_outcome() -> None:
    place = {"map": "map1", "routing": "mrsr"}
    lost = {1: (3, 0), 2: (1, 0), 3: (1, 1), 4: (1, 0), 5: (1, 1), 6: (1, 0)}
    rows = [
        row({**place, "policy": policy}, seed, lost=both[number])
        for seed, both in lost.items()
        for number, policy in enumerate(missions.POLICIES)
    ]
    assert typical_seed(rows, ("map1", "mrsr")) == 2


def test_the_team_at_the_end_is_the_one_that_most_robots_obey() -> None:
    def obeys(leader: int) -> Status:
        return Status(Mode.FOLLOWING, 1, leader, (1, 2, 3), Shape.WEDGE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    said = {1: obeys(4), 2: obeys(4), 3: obeys(3), 4: obeys(4), 5: obeys(3)}
    assert leader_of_most(said) == 4
    assert leader_of_most({1: obeys(5), 2: obeys(3)}) == 3
    assert leader_of_most({}) == 0
