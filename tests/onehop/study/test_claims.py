"""A claim is confirmed or refuted by where the interval lies, and never by the mean alone."""

import json

import pytest

from onehop.study.claims import LEAST_SEEDS, Claim, Expects, Verdict, judge
from onehop.study.statistics import Estimate

ABOVE, BELOW, ACROSS = Estimate(2.0, 1.0, 3.0), Estimate(-2.0, -3.0, -1.0), Estimate(0.5, -0.5, 1.5)
ZERO, ALONE, NOTHING = Estimate(0.0, 0.0, 0.0), Estimate(-9.0, None, None), Estimate(None, None, None)


@pytest.mark.parametrize(
    ("expects", "found", "verdict"),
    [
        (Expects.LESS, BELOW, Verdict.CONFIRMED),
        (Expects.LESS, ABOVE, Verdict.REFUTED),
        (Expects.LESS, ACROSS, Verdict.UNDECIDED),
        (Expects.LESS, ZERO, Verdict.UNDECIDED),
        (Expects.MORE, ABOVE, Verdict.CONFIRMED),
        (Expects.MORE, BELOW, Verdict.REFUTED),
        (Expects.MORE, ACROSS, Verdict.UNDECIDED),
        (Expects.SAME, Estimate(0.1, -0.4, 0.5), Verdict.CONFIRMED),
        (Expects.SAME, Estimate(0.3, 0.2, 0.4), Verdict.CONFIRMED),
        (Expects.SAME, ABOVE, Verdict.REFUTED),
        (Expects.SAME, BELOW, Verdict.REFUTED),
        (Expects.SAME, Estimate(0.3, -0.1, 0.7), Verdict.UNDECIDED),
        (Expects.NONE, ZERO, Verdict.CONFIRMED),
        (Expects.NONE, Estimate(0.3, 0.1, 0.6), Verdict.REFUTED),
        (Expects.NONE, Estimate(0.1, 0.0, 0.3), Verdict.UNDECIDED),
    ],
)
def test_the_whole_interval_decides(expects: Expects, found: Estimate, verdict: Verdict) -> None:
    claim = Claim("it is so", "4.2", "lost", expects, margin=0.5)
    assert judge(claim, found, 9).verdict is verdict


@pytest.mark.parametrize("expects", list(Expects))
def test_one_seed_decides_nothing_and_none_is_no_data(expects: Expects) -> None:
    claim = Claim("it is so", "4.2", "lost", expects)
    assert judge(claim, ALONE, 1).verdict is Verdict.UNDECIDED
    assert judge(claim, NOTHING, 0).verdict is Verdict.NO_DATA


def test_too_few_seeds_decide_nothing() -> None:
    claim = Claim("it is so", "4.2", "lost", Expects.LESS)
    assert judge(claim, BELOW, LEAST_SEEDS - 1).verdict is Verdict.UNDECIDED
    assert judge(claim, BELOW, LEAST_SEEDS).verdict is Verdict.CONFIRMED


def test_a_judgement_is_json() -> None:
    claim = Claim("it is so", "4.2", "lost", Expects.LESS)
    told = judge(claim, BELOW, 9).as_json()
    assert json.loads(json.dumps(told)) == told
    assert (told["verdict"], told["mean"], told["ci95"]) == ("confirmed", -2.0, [-3.0, -1.0])
