"""From what a simulator says to the figures of the tables, and their ratio with its 95 % interval."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist, fmean, variance
from typing import Any

from .cases import Run

CONFIDENCE = 0.95


def percentile(values: Sequence[float], share: float) -> float | None:
    """The smallest value that at least this share of them does not exceed; None of nothing."""
    if not values:
        return None
    return sorted(values)[max(0, math.ceil(share * len(values)) - 1)]


def _delays(delays_ms: Sequence[float]) -> dict[str, float | None]:
    return {f"p{round(100 * share)}_ms": percentile(delays_ms, share) for share in (0.5, 0.95, 0.99)}


def measures(run: Run, said: dict[str, Any]) -> dict[str, float | None]:
    """The figures of one run.

    Flows: Mb/s of MSDUs received, every hop of each counted, and from end to end; delays from service
    at the source to arrival. Messages: share delivered and delays from the hand-over, of those that
    were offered after the last station had left; first_ms: of the very first, discovery included;
    repair_ms: from the leaving to the first arrival of what was offered after it.
    """
    if not run.protocol:
        megabits = 8e-6 * run.msdu_bytes / run.seconds
        arrived = [delay for flow in said["delays_ms"] for delay in flow]
        return {
            "mbps": megabits * sum(said["received"]),
            "end_to_end_mbps": megabits * len(arrived),
            **_delays(arrived),
        }
    left_s = max((at_s for _, at_s in run.leaves), default=0.0)
    arrivals = list(zip((at_s for at_s, *_ in run.messages), said["arrivals_s"], strict=True))
    first_sent, first_came = arrivals[0]
    offered = [(at_s, came) for at_s, came in arrivals if at_s >= left_s]
    came = [(at_s, there) for at_s, there in offered if there is not None]
    figures: dict[str, float | None] = {
        "delivered": len(came) / len(offered),
        **_delays([1e3 * (there - at_s) for at_s, there in came]),
        "first_ms": None if first_came is None else 1e3 * (first_came - first_sent),
        "routing_bytes": said["routing_bytes"],
        "source_route_bytes": said["source_route_bytes"],
    }
    if run.leaves:
        figures["repair_ms"] = 1e3 * (min(there for _, there in came) - left_s) if came else None
    return figures


def student_t(freedom: float, share: float = 0.5 + CONFIDENCE / 2.0) -> float:
    """Quantile of Student's t distribution, by bisection of its integral (Simpson's rule)."""

    def below(t: float) -> float:
        steps = 2000
        scale = math.exp(math.lgamma((freedom + 1.0) / 2.0) - math.lgamma(freedom / 2.0))
        scale /= math.sqrt(freedom * math.pi)
        total = 0.0
        for k in range(steps + 1):
            x = t * k / steps
            weight = 1.0 if k in (0, steps) else (4.0 if k % 2 else 2.0)
            total += weight * (1.0 + x * x / freedom) ** (-(freedom + 1.0) / 2.0)
        return 0.5 + scale * total * t / steps / 3.0

    low, high = 0.0, 20.0 * NormalDist().inv_cdf(share)
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if below(middle) < share else (low, middle)
    return low


@dataclass(frozen=True)
class Ratio:
    """Ratio of two means and its 95 % interval."""

    value: float
    low: float
    high: float

    def within(self, tolerance: float) -> bool:
        """Whether the whole interval lies inside 1 - tolerance .. 1 + tolerance."""
        return 1.0 - tolerance <= self.low and self.high <= 1.0 + tolerance


def paired_ratio(pairs: Sequence[tuple[float, float]]) -> Ratio | None:
    """Geometric mean of ours by theirs over (ours, theirs) of the same topology; None as for `ratio`."""
    if len(pairs) < 2 or min(min(pair) for pair in pairs) <= 0.0:
        return None
    logs = [math.log(ours / theirs) for ours, theirs in pairs]
    value = math.exp(fmean(logs))
    width = math.exp(student_t(len(logs) - 1) * math.sqrt(variance(logs) / len(logs)))
    return Ratio(value, value / width, value * width)


def _relative_variance_of_mean(values: Sequence[float]) -> float:
    mean = fmean(values)
    return variance(values) / len(values) / (mean * mean)


def ratio(ours: Sequence[float], theirs: Sequence[float]) -> Ratio | None:
    """Ratio of the means of two independent samples, by the delta method on its logarithm.

    Degrees of freedom as Welch and Satterthwaite. None where a mean is 0 or a sample has fewer than two.
    """
    if min(len(ours), len(theirs)) < 2 or fmean(ours) <= 0.0 or fmean(theirs) <= 0.0:
        return None
    value = fmean(ours) / fmean(theirs)
    parts = [(_relative_variance_of_mean(side), len(side) - 1) for side in (ours, theirs)]
    total = sum(part for part, _ in parts)
    if total == 0.0:
        return Ratio(value, value, value)
    freedom = total * total / sum(part * part / n for part, n in parts)
    width = math.exp(student_t(freedom) * math.sqrt(total))
    return Ratio(value, value / width, value * width)
