"""What a cell of missions says, and what changes to another, as `--json` has it."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from onehop.campaign.lines import Row
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


def _told(estimate: Callable[[str], Estimate]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, measure in TOLD.items():
        one = estimate(measure)
        found[name] = one.mean
        found[f"{name.removesuffix('_mean')}_ci95"] = [one.low, one.high]
    return found
