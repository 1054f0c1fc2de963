"""Where a policy matters: which places, which way, and where the frontier is drawn."""

from onehop.study.phase.frontier import edges, effects
from tests.onehop.study.rows import row

COLUMNS, LINES = (0.1, 0.5), (5.0, 20.0)
PLACES = [(k, hold_s) for k in COLUMNS for hold_s in LINES]


def rows(measure: str, change: dict[tuple[float, float], float]) -> list[dict[str, object]]:
    """Eight seeds at each place; what changes there, and as much noise as 1."""
    return [
        row(
            {"k_rho_min": k, "hold_s": hold_s, "policy": policy}, seed,
            **{measure: 10.0 + seed % 2 * number + change[k, hold_s] * number},
        )
        for k, hold_s in PLACES
        for number, policy in enumerate(("a", "b"))
        for seed in range(8)
    ]  # fmt: skip


CHANGE = {(0.1, 5.0): -3.0, (0.1, 20.0): 3.0, (0.5, 5.0): -0.5, (0.5, 20.0): -2.0}


def test_less_is_better_of_lost_robots_and_worse_of_throughput() -> None:
    lost = effects(rows("lost", CHANGE), PLACES, "lost", ("a", "b"))
    assert [(one.better, one.worse) for one in lost.values()] == [
        (True, False), (False, True), (False, False), (True, False),
    ]  # fmt: skip
    throughput = effects(rows("throughput_bps", CHANGE), PLACES, "throughput_bps", ("a", "b"))
    assert [(one.better, one.worse) for one in throughput.values()] == [
        (False, True), (True, False), (False, False), (False, True),
    ]  # fmt: skip


def test_no_missions_matter_nowhere() -> None:
    found = effects([], PLACES, "lost", ("a", "b"))
    assert not any(one.matters for one in found.values())
    assert edges(COLUMNS, LINES, found) == []


def test_the_frontier_runs_around_the_places_that_matter() -> None:
    """All but (0.5, 5), the lower right square: the outer border, and the two sides of that square."""
    found = effects(rows("lost", CHANGE), PLACES, "lost", ("a", "b"))
    drawn = edges(COLUMNS, LINES, found)
    assert len(drawn) == 8
    assert ((0.5, -0.5), (0.5, 0.5)) in drawn
    assert ((0.5, 0.5), (1.5, 0.5)) in drawn
    assert ((1.5, -0.5), (1.5, 0.5)) not in drawn
