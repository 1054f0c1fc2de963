"""Differences seed by seed, in one cell and over several."""

from onehop.study.comparison import LOST_ANY, chosen, difference, mean, strata
from tests.onehop.study.rows import row

A, B = {"policy": "a"}, {"policy": "b"}

ROWS = [
    row({"map": "m", "policy": "a"}, 1, lost=2, delay_ms=20.0),
    row({"map": "m", "policy": "a"}, 2, lost=6, delay_ms=None),
    row({"map": "m", "policy": "b"}, 1, lost=1, delay_ms=25.0),
    row({"map": "m", "policy": "b"}, 2, lost=5, delay_ms=30.0),
    row({"map": "m", "policy": "b"}, 3, lost=0, delay_ms=1.0),
    row({"map": "n", "policy": "a"}, 1, lost=3, delay_ms=10.0),
    row({"map": "n", "policy": "b"}, 1, lost=0, delay_ms=10.0),
]


def test_a_difference_is_taken_within_a_seed() -> None:
    """Seeds differ by four robots, policies by one in each: no spread. Seed 3 has no partner."""
    found = difference(ROWS, "lost", A, B, [{"map": "m"}])
    assert (found.estimate, found.seeds) == ((-1.0, -1.0, -1.0), 2)


def test_what_was_not_measured_has_no_difference() -> None:
    found = difference(ROWS, "delay_ms", A, B, [{"map": "m"}])
    assert (found.estimate, found.seeds) == ((5.0, None, None), 1)


def test_cells_of_one_seed_count_as_one() -> None:
    """Seed 1: -1 on m, -3 on n, so -2; seed 2: -1 on m alone."""
    found = difference(ROWS, "lost", A, B, strata(ROWS, "map"))
    assert (found.estimate.mean, found.seeds) == (-1.5, 2)


def test_nothing_to_compare_is_no_estimate() -> None:
    found = difference(ROWS, "lost", A, {"policy": "c"}, [{}])
    assert (found.estimate, found.seeds) == ((None, None, None), 0)


def test_cells_are_chosen_by_their_values() -> None:
    assert [one["seed"] for one in chosen(ROWS, {"map": "m", **A})] == [1, 2]
    assert strata(ROWS, "map", "policy")[2] == {"map": "n", "policy": "a"}
    assert mean(chosen(ROWS, B), LOST_ANY).mean == 0.5
