"""Which missions the phase diagram is made of, and what is no grid."""

from pathlib import Path

import pytest

from onehop.contracts.errors import InputError
from onehop.study.phase.grid import Grid
from onehop.study.phase.heat_maps import heat_maps
from tests.onehop.study.rows import row

SCENARIO = Path(__file__).parents[4] / "scenarios" / "thesis" / "map1.toml"


def test_every_place_has_every_policy() -> None:
    cells = Grid(SCENARIO, (), (0.1, 1.0), (5.0, 20.0)).cells(1)
    assert [tuple(cell.values.values()) for cell in cells] == [
        (k, hold_s, policy)
        for k in (0.1, 1.0)
        for hold_s in (5.0, 20.0)
        for policy in ("constant", "throughput")
    ]
    for cell in cells:
        scenario = cell.bundle.scenario
        assert scenario.gains.k_rho_min == cell.values["k_rho_min"]
        assert scenario.gains.policy == cell.values["policy"]
        assert scenario.faults[0].duration_s == cell.values["hold_s"]


def test_the_bounds_are_a_perfect_link_everywhere_and_none_where_no_gain_counts() -> None:
    cells = Grid(SCENARIO, (), (0.1, 1.0), (5.0, 20.0)).bounds(1)
    assert [(*cell.values.values(), cell.bundle.scenario.radio.link) for cell in cells] == [
        (0.1, 5.0, "perfect", "perfect"), (0.1, 20.0, "perfect", "perfect"),
        (1.0, 5.0, "perfect", "perfect"), (1.0, 20.0, "perfect", "perfect"),
        (0.1, 5.0, "none", "none"), (0.1, 20.0, "none", "none"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"k_rho_min": (0.1, 0.1)}, "--k-rho-min 0.1,0.1"),
        ({"hold_s": (5.0, 5.0)}, "--hold 5.0,5.0"),
        ({"policies": ("constant",)}, "nothing to compare"),
    ],
)
def test_what_is_no_grid_is_one_line(changed: dict[str, tuple[object, ...]], says: str) -> None:
    with pytest.raises(InputError, match=says):
        Grid(SCENARIO, (), **changed)  # type: ignore[arg-type]


def test_a_place_without_missions_is_an_empty_square() -> None:
    """A study that was stopped is drawn as far as it came."""
    values = {"k_rho_min": 0.1, "hold_s": 5.0}
    rows = [row({**values, "policy": p}, seed) for p in ("a", "b") for seed in (1, 2)]
    figure = heat_maps(rows, (0.1, 1.0), (5.0, 20.0), ("a", "b"))
    assert len(figure.axes) == 12
    assert [text.get_text() for text in figure.axes[0].texts] == ["0", "", "", ""]
    assert heat_maps([], (0.1,), (5.0,), ("a", "b")).axes
