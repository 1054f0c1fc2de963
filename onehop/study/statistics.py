"""Means with bootstrap intervals: the same numbers for the same values, wherever they are computed."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from onehop.contracts.arrays import FloatArray
from onehop.contracts.randomness import generator

RESAMPLES = 2000
CONFIDENCE = 0.95

_SEED = 0
_AT_ONCE = 1 << 20
"""Values drawn at once: what bounds the memory of many seeds."""


class Estimate(NamedTuple):
    """A mean and its 95 % interval; None where there are too few values."""

    mean: float | None
    low: float | None
    high: float | None


def estimate(values: Sequence[float | None]) -> Estimate:
    """Mean and percentile bootstrap interval of what was measured; None is what was not."""
    sample = np.array([value for value in values if value is not None], dtype=np.float64)
    if len(sample) == 0:
        return Estimate(None, None, None)
    mean = float(sample.mean())
    if len(sample) == 1:
        return Estimate(mean, None, None)
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(_resampled_means(sample), (tail, 1.0 - tail))
    return Estimate(mean, float(low), float(high))


def _resampled_means(sample: FloatArray) -> FloatArray:
    """Means of as many values, drawn with replacement, RESAMPLES times.

    Which are drawn depends on their number alone: measures of the same missions are resampled alike.
    """
    count = len(sample)
    rng = generator(_SEED, f"study/bootstrap/{count}")
    rows = max(1, _AT_ONCE // count)
    sizes = [min(rows, RESAMPLES - done) for done in range(0, RESAMPLES, rows)]
    return np.concatenate([sample[rng.integers(count, size=(n, count))].mean(axis=1) for n in sizes])
