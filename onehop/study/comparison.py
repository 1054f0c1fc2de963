"""What changes from one kind of mission to another, seed by seed, in one cell or over several."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from onehop.campaign.lines import Row
from onehop.study.statistics import Estimate, estimate

Where = Mapping[str, Any]
"""Values that missions have in common, by key."""

LOST_ANY = "lost_any"
"""A measure that is computed: whether a mission lost a robot."""


class Difference(NamedTuple):
    """Mean of the differences and its interval. seeds: over how many it was taken."""

    estimate: Estimate
    seeds: int


def measured(row: Row, measure: str) -> float | None:
    """A measure of a mission; None if there was nothing to measure."""
    if measure == LOST_ANY:
        return float(row["lost"] > 0)
    value = row[measure]
    return None if value is None else float(value)


def chosen(rows: Iterable[Row], where: Where) -> list[Row]:
    """The missions with these values."""
    return [row for row in rows if all(row["values"][key] == value for key, value in where.items())]


def mean(rows: Iterable[Row], measure: str) -> Estimate:
    """Mean of a measure and its interval."""
    return estimate([measured(row, measure) for row in rows])


def difference(
    rows: Sequence[Row], measure: str, before: Where, after: Where, strata: Sequence[Where] = ({},)
) -> Difference:
    """By how much a measure is greater in missions `after` than `before`.

    strata: cells in each of which both are compared. Of a seed the differences in all of them are
    averaged first: missions of one seed have the same start, and count as one.
    """
    of_seed: dict[int, list[float]] = {}
    for stratum in strata:
        base = {row["seed"]: row for row in chosen(rows, {**stratum, **before})}
        for row in chosen(rows, {**stratum, **after}):
            if row["seed"] not in base:
                continue
            one, other = measured(base[row["seed"]], measure), measured(row, measure)
            if one is not None and other is not None:
                of_seed.setdefault(row["seed"], []).append(other - one)
    values = [float(np.mean(of_seed[seed])) for seed in sorted(of_seed)]
    return Difference(estimate(values), len(values))


def strata(rows: Iterable[Row], *keys: str) -> list[Where]:
    """The combinations of values of some keys that the missions have, in their order."""
    return list(
        {
            tuple(row["values"][key] for key in keys): {key: row["values"][key] for key in keys}
            for row in rows
        }.values()
    )
