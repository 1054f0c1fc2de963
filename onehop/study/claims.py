"""A claim, and what missions say about it: confirmed or refuted by a 95 % interval, or undecided."""

from dataclasses import dataclass
from enum import StrEnum

from onehop.study.statistics import Estimate

LEAST_SEEDS = 5
"""With fewer nothing is decided: that four seeds agree happens by chance in one case of eight."""


class Expects(StrEnum):
    """What a claim says of a mean: of a difference, or (NONE) of a count."""

    LESS = "less"
    MORE = "more"
    SAME = "the same"
    NONE = "none"


class Verdict(StrEnum):
    """CONFIRMED: the whole interval is where the claim says. REFUTED: all of it is where it cannot be.

    UNDECIDED: neither, or too few seeds. NO_DATA: nothing was measured.
    """

    CONFIRMED = "confirmed"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    NO_DATA = "no data"


@dataclass(frozen=True, slots=True)
class Claim:
    """One sentence that can be wrong.

    says: the sentence. source: where it is claimed. measure: what its mean is taken of. scale: how many
    of the measure's units are one of `unit`. margin: less than this counts as the same, in the
    measure's unit.
    """

    says: str
    source: str
    measure: str
    expects: Expects
    unit: str = ""
    scale: float = 1.0
    margin: float = 0.0


@dataclass(frozen=True, slots=True)
class Judgement:
    """A claim and what came of it. seeds: how many the estimate is over."""

    claim: Claim
    verdict: Verdict
    estimate: Estimate
    seeds: int

    def as_json(self) -> dict[str, object]:
        """The object that `--json` has of it."""
        claim, estimate = self.claim, self.estimate
        return {
            "claim": claim.says,
            "source": claim.source,
            "measure": claim.measure,
            "expects": str(claim.expects),
            "verdict": str(self.verdict),
            "mean": estimate.mean,
            "ci95": [estimate.low, estimate.high],
            "seeds": self.seeds,
        }


def judge(claim: Claim, estimate: Estimate, seeds: int) -> Judgement:
    """What an estimate says about a claim.

    Of NONE: confirmed if it was none in every mission, refuted if the interval excludes none.
    """
    return Judgement(claim, _verdict(claim, estimate, seeds), estimate, seeds)


def _verdict(claim: Claim, estimate: Estimate, seeds: int) -> Verdict:
    mean, low, high = estimate
    if mean is None:
        return Verdict.NO_DATA
    if low is None or high is None or seeds < LEAST_SEEDS:
        return Verdict.UNDECIDED
    match claim.expects:
        case Expects.LESS:
            holds, fails = high < 0.0, low > 0.0
        case Expects.MORE:
            holds, fails = low > 0.0, high < 0.0
        case Expects.SAME:
            holds = -claim.margin <= low and high <= claim.margin
            fails = low > claim.margin or high < -claim.margin
        case Expects.NONE:
            holds, fails = high == 0.0, low > 0.0
    return Verdict.CONFIRMED if holds else Verdict.REFUTED if fails else Verdict.UNDECIDED
