"""Means and bootstrap intervals."""

import math

import numpy as np
import pytest

from onehop.contracts.randomness import generator
from onehop.study import statistics
from onehop.study.statistics import estimate


def test_the_same_values_have_the_same_interval() -> None:
    values = [0.0, 1.0, 1.0, 4.0, 2.5, 0.5]
    assert estimate(values) == estimate(list(values))
    found = estimate(values)
    assert found.low is not None
    assert found.high is not None
    assert found.mean == 1.5
    assert 0.0 <= found.low < 1.5 < found.high <= 4.0


def test_too_few_values_have_no_interval() -> None:
    assert estimate([]) == (None, None, None)
    assert estimate([None, 3.0]) == (3.0, None, None)


def test_values_that_do_not_differ_have_an_interval_without_width() -> None:
    assert estimate([2.0] * 50) == (2.0, 2.0, 2.0)


def test_the_interval_is_that_of_the_normal_distribution_where_that_is_known() -> None:
    sample = generator(1, "test/statistics").standard_normal(400)
    found = estimate(sample.tolist())
    assert found.low is not None
    assert found.high is not None
    half = 1.96 * sample.std(ddof=1) / math.sqrt(400)
    assert found.high - found.low == pytest.approx(2 * half, rel=0.08)


def test_the_interval_holds_the_mean_about_as_often_as_it_says() -> None:
    rng = generator(2, "test/statistics")
    hits = 0
    for _ in range(300):
        found = estimate(rng.exponential(1.0, 60).tolist())
        assert found.low is not None
        assert found.high is not None
        hits += found.low <= 1.0 <= found.high
    assert 0.88 <= hits / 300 <= 0.99


def test_a_sample_drawn_piece_by_piece_has_all_its_resamples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(statistics, "_AT_ONCE", 70)
    means = statistics._resampled_means(np.arange(10.0))
    assert len(means) == statistics.RESAMPLES
    assert means.mean() == pytest.approx(4.5, abs=0.1)
