"""The grid of a sweep: every combination, values as the scenario has them, and what is refused."""

from pathlib import Path

import pytest

from onehop.contracts.errors import InputError
from onehop.study.grid import Axis, axis, cells
from tests.onehop.scenes import FIELD

HOLD = 'faults=[{kind="hold", at_s=5, robots=[1, 2]}]'


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "field.toml"
    path.write_text(FIELD)
    return path


@pytest.mark.parametrize(
    ("text", "key", "values"),
    [
        ("gains.k_rho_min=0.1,0.2,0.5", "gains.k_rho_min", [0.1, 0.2, 0.5]),
        ("gains.policy=constant, throughput", "gains.policy", ["constant", "throughput"]),
        ('gains.policy="constant","smooth"', "gains.policy", ["constant", "smooth"]),
        ("gains.reverse=true,false", "gains.reverse", [True, False]),
        ("team.ids=[1,2],[1,2,3]", "team.ids", [[1, 2], [1, 2, 3]]),
        ('name="a,b",\'c,[d\'', "name", ["a,b", "c,[d"]),
        ('faults=[{kind="kill", at_s=3, robots=[1,2]}],[]', "faults",
         [[{"kind": "kill", "at_s": 3, "robots": [1, 2]}], []]),
        ("clock.limit_s=5", "clock.limit_s", [5]),
    ],
)  # fmt: skip
def test_values_are_read_as_toml_between_their_commas(text: str, key: str, values: list[object]) -> None:
    assert axis(text) == Axis(key, values)


@pytest.mark.parametrize(
    "text", ["gains.k_rho_min", "gains.k_rho_min=", "team.size=1,,2", "=1,2", "team.size=1,"]
)
def test_an_axis_without_key_or_values_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--over"):
        axis(text)


def test_every_combination_is_a_cell_the_last_key_fastest(scenario: Path) -> None:
    axes = [Axis("gains.k_rho_min", [1, 2]), Axis("faults[0].duration_s", [5, 7, 9])]
    made = cells(scenario, [HOLD], axes, 1)
    assert [tuple(cell.values.values()) for cell in made] == [
        (1.0, 5.0), (1.0, 7.0), (1.0, 9.0), (2.0, 5.0), (2.0, 7.0), (2.0, 9.0),
    ]  # fmt: skip
    last = made[-1].bundle.scenario
    assert (last.gains.k_rho_min, last.faults[0].duration_s, last.faults[0].robots) == (2, 9, (1, 2))
    assert made[0].with_seed(8).scenario.seed == 8


def test_without_a_key_there_is_the_scenario_itself(scenario: Path) -> None:
    assert [cell.values for cell in cells(scenario, [], [], 1)] == [{}]


def test_lists_and_tables_are_told_as_text(scenario: Path) -> None:
    made = cells(scenario, [], [axis("team.ids=[1,2],[4,5]")], 1)
    assert [cell.values for cell in made] == [{"team.ids": "[1, 2]"}, {"team.ids": "[4, 5]"}]


def test_a_profile_fills_in_what_a_cell_leaves_out(scenario: Path) -> None:
    plain, thesis = cells(scenario, [], [axis("profile=team,thesis")], 1)
    assert (plain.bundle.scenario.team.lost_after, thesis.bundle.scenario.team.lost_after) == (2, 1)


@pytest.mark.parametrize(
    ("over", "says"),
    [
        (["bogus=1"], "bogus: unknown key"),
        (["gains.k_rho_max=4,0.5"], r"--over gains\.k_rho_max=0\.5: .*k_rho_max: 0\.5 < k_rho_min"),
        (["gains.k_rho_min=1,2", "gains.k_rho_max=3,1.5"], "gains.k_rho_min=2 gains.k_rho_max=1.5"),
        (["gains.policy=constant,best"], "'best' is unknown"),
        (["team.size=3,0"], "out of range"),
        (["gains.k_rho_min=1,1.0"], "stands twice"),
        (["faults[0].duration_s=5"], "there is no key 0"),
        (["seed=1,2"], "every cell has the same seeds"),
        (["team.size=3", "team.size=4"], "is set by --over team.size as well"),
        (["team={size=3}", "team.spacing=4"], "is set by --over team as well"),
        (
            ["start.x=8,20", "start.y=26"],
            r"with start\.x=20\.0 start\.y=26\.0: .*nearest free point",
        ),
    ],
)
def test_what_is_no_scenario_is_refused_before_anything_runs(
    scenario: Path, over: list[str], says: str
) -> None:
    with pytest.raises(InputError, match=says) as refusal:
        cells(scenario, [], [axis(text) for text in over], 1)
    assert "\n" not in str(refusal.value)


def test_a_python_call_without_values_is_refused(scenario: Path) -> None:
    with pytest.raises(InputError, match="has no value"):
        cells(scenario, [], [Axis("team.size", [])], 1)
