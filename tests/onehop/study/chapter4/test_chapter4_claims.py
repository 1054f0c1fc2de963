"""The claims of chapter 4 follow the missions: from made-up tables, both ways."""

from collections.abc import Callable
from itertools import product
from typing import Any

import pytest

from onehop.study.chapter4.claims import ideal_claim, policy_claims, routing_claims
from onehop.study.chapter4.missions import CONSTANT, MAPS, POLICIES, ROUTINGS, VARIABLE
from onehop.study.claims import Judgement, Verdict
from tests.onehop.study.rows import row

SEEDS = range(1, 9)


def table(measures: Callable[[str, str, str, int], dict[str, float]]) -> list[dict[str, Any]]:
    """Every cell of 4.2 with eight seeds. measures: by map, routing, policy and seed."""
    return [
        row({"map": m, "routing": r, "policy": p}, seed, **measures(m, r, p, seed))
        for seed, m, r, p in product(SEEDS, MAPS, ROUTINGS, POLICIES)
    ]


def verdict_of(found: list[Judgement], words: str) -> Verdict:
    (one,) = [judgement for judgement in found if words in judgement.claim.says]
    return one.verdict


def as_claimed(m: str, r: str, p: str, seed: int) -> dict[str, float]:
    """What the thesis says happens, with some noise by seed."""
    variable, mrsr = p == VARIABLE, r == "mrsr"
    lost = {"map1": (1, 1), "map2": (3, 2), "map3": (3, 4)}[m][not mrsr]
    return {
        "lost": 0 if variable else lost + seed % 2,
        "throughput_bps": 5e5 + 1e5 * variable + 1e4 * mrsr + seed,
        "below_threshold_s": 50.0 - 20.0 * variable + seed,
        "ber": 0.2 - 0.1 * variable + 0.001 * seed,
        "routing_bytes": 900 - 100 * mrsr + seed,
        "delay_ms": 20.0 + 2.0 * mrsr + 0.1 * seed,
    }


def opposite(m: str, r: str, p: str, seed: int) -> dict[str, float]:
    """The same with policies and routings changed over."""
    return as_claimed(m, {"mrsr": "mrdv", "mrdv": "mrsr"}[r], _other(p), seed)


def _other(policy: str) -> str:
    return CONSTANT if policy == VARIABLE else VARIABLE


def test_a_table_as_the_thesis_has_it_confirms_every_claim() -> None:
    rows = table(as_claimed)
    found = [*policy_claims(rows), *routing_claims(rows)]
    assert {one.verdict for one in found} == {Verdict.CONFIRMED}
    assert len(found) == 21
    assert all(one.seeds == len(SEEDS) for one in found)


def test_the_opposite_table_refutes_them() -> None:
    rows = table(opposite)
    found = list(policy_claims(rows))
    assert {one.verdict for one in found} == {Verdict.REFUTED}
    routing = {one.claim.says: one.verdict for one in routing_claims(rows)}
    assert routing.pop("On map1 both routings lose the same.") is Verdict.CONFIRMED
    losing = [says for says in routing if "constant" in says]
    assert len(losing) == 2
    assert all(routing.pop(says) is Verdict.UNDECIDED for says in losing)  # nobody is lost there
    assert set(routing.values()) == {Verdict.REFUTED}


def test_no_difference_is_undecided_and_the_same_is_confirmed() -> None:
    rows = table(lambda _, __, policy, seed: {"lost": (seed + len(policy)) % 3})
    found = [*policy_claims(rows), *routing_claims(rows)]
    assert verdict_of(found, "On map1 both routings lose the same") is Verdict.CONFIRMED
    assert verdict_of(found, "MRSR has a slightly lower overhead") is Verdict.UNDECIDED
    assert verdict_of(found, "On map1 with MRSR the variable k_rho loses nobody") is Verdict.REFUTED


def test_some_cells_alone_are_judged_as_they_come() -> None:
    """Stopped early: only map1 has missions, and nothing is said of the others."""
    rows = [one for one in table(as_claimed) if one["values"]["map"] == "map1"]
    found = list(policy_claims(rows))
    assert not any("map2" in one.claim.says for one in found)
    assert verdict_of(list(routing_claims(rows)), "On map2") is Verdict.NO_DATA
    assert next(policy_claims([])).verdict is Verdict.NO_DATA


@pytest.mark.parametrize(
    ("lost", "verdict"), [(0, Verdict.CONFIRMED), (1, Verdict.REFUTED)], ids=["none", "some"]
)
def test_ideal_conditions_lose_nobody_or_they_do(lost: int, verdict: Verdict) -> None:
    rows = [row({"map": "map1"}, seed, lost=lost) for seed in SEEDS]
    assert ideal_claim(rows).verdict is verdict
