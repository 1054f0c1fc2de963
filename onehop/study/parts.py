"""What studies have in common: campaigns as their parts, and what a cell of missions says."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from onehop.campaign.lines import Row
from onehop.campaign.listener import Listener
from onehop.study.comparison import LOST_ANY, Where, difference, mean
from onehop.study.statistics import Estimate

TOLD = {
    "lost_mean": "lost",
    "lost_any": LOST_ANY,
    "throughput_mean_bps": "throughput_bps",
    "below_threshold_s": "below_threshold_s",
    "error_m": "error_m",
    "ber_mean": "ber",
    "overhead_bytes": "routing_bytes",
    "delay_ms": "delay_ms",
    "connected_share": "connected_share",
    "drive_j": "drive_j",
    "radio_j": "radio_j",
}
"""What `--json` says of a cell, and the measure of which it is the mean."""


class Announce(Protocol):
    """Is told that a part of a study begins, and how much is wanted; gives who listens to it."""

    def __call__(self, part: str, total: int) -> Listener: ...


def cell(values: Where, rows: Sequence[Row]) -> dict[str, Any]:
    """A cell as `--json` has it: its values, how many seeds, means and intervals."""
    return {**values, "seeds": len(rows), **_told(lambda measure: mean(rows, measure))}


def changed(
    values: Mapping[str, Any], rows: Sequence[Row], before: Where, after: Where, strata: Sequence[Where]
) -> dict[str, Any]:
    """What changes from some missions to others, seed by seed, as `--json` has it."""
    seeds = difference(rows, "lost", before, after, strata).seeds
    told = _told(lambda measure: difference(rows, measure, before, after, strata).estimate)
    return {**values, "seeds": seeds, **told}


def _told(estimate: "Any") -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, measure in TOLD.items():
        one: Estimate = estimate(measure)
        found[name] = one.mean
        found[f"{name.removesuffix('_mean')}_ci95"] = [one.low, one.high]
    return found
