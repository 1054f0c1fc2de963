"""Where a policy begins to matter: places at which the paired interval of a measure excludes 0."""

from collections.abc import Sequence
from typing import NamedTuple

from onehop.campaign.lines import Row
from onehop.study.comparison import difference
from onehop.study.statistics import Estimate

Place = tuple[float, float]
"""k_rho_min [1/s] and length of the delay [s]."""

BETTER_IF_LESS = {"lost": True, "throughput_bps": False, "below_threshold_s": True, "error_m": True}
"""The measures of the diagram, and which way is better."""


class Effect(NamedTuple):
    """What a policy changes at a place. better: the interval excludes 0 on the good side; worse: on the
    other one.
    """

    estimate: Estimate
    better: bool
    worse: bool

    @property
    def matters(self) -> bool:
        """Whether the interval excludes 0."""
        return self.better or self.worse


def effects(
    rows: Sequence[Row], places: Sequence[Place], measure: str, policies: tuple[str, str]
) -> dict[Place, Effect]:
    """What changes from the first to the second policy at each place, seed by seed."""
    before, after = policies
    found = {}
    for k, hold_s in places:
        where = [{"k_rho_min": k, "hold_s": hold_s}]
        one = difference(rows, measure, {"policy": before}, {"policy": after}, where).estimate
        less = one.high is not None and one.high < 0.0
        more = one.low is not None and one.low > 0.0
        if_less = BETTER_IF_LESS[measure]
        found[k, hold_s] = Effect(one, less if if_less else more, more if if_less else less)
    return found


def edges(
    columns: Sequence[float], lines: Sequence[float], effect: dict[Place, Effect]
) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """The frontier on a grid of unit squares: between squares that matter and others, and the border.

    columns: k_rho_min from left to right. lines: lengths of the delay from below. A square's middle has
    whole coordinates.
    """

    def matters(column: int, line: int) -> bool:
        inside = 0 <= column < len(columns) and 0 <= line < len(lines)
        return inside and effect[columns[column], lines[line]].matters

    wide, high = len(columns), len(lines)
    upright = [
        ((column - 0.5, line - 0.5), (column - 0.5, line + 0.5))
        for column in range(wide + 1)
        for line in range(high)
        if matters(column - 1, line) != matters(column, line)
    ]
    level = [
        ((column - 0.5, line - 0.5), (column + 0.5, line - 0.5))
        for line in range(high + 1)
        for column in range(wide)
        if matters(column, line - 1) != matters(column, line)
    ]
    return upright + level
