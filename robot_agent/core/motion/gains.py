"""How k_rho follows the throughput of the link to the leader (thesis 3.5). Replaceable policies.

A policy hears one throughput for each Next that came, and 0 for each that did not, and the threshold of
the slot that the robot has by then. Policies that steer besides are in files of their own (aim.py).
"""

from collections.abc import Callable
from typing import Protocol

from onehop.contracts.briefings import Briefing
from onehop.contracts.plugin_names import GAIN_POLICIES
from robot_agent.core.motion.lambda2 import Lambda2Gain
from robot_agent.core.motion.predictive import PredictiveGain

FILTER_SHARE = 0.5
"""Weight of the newest measurement in the smooth policy's filter: two Next periods of memory."""

LOOKAHEAD = 1.0
"""Next periods over which the smooth policy extrapolates a falling throughput."""

BAND = 1.5
"""The smooth policy begins to hurry below this multiple of the threshold."""


class GainPolicy(Protocol):
    """Chooses k_rho [1/s] from measured throughputs and a threshold [bit/s]."""

    def heard(self, throughput_bps: float, threshold_bps: float) -> float:
        """k_rho after one more Next, or after one that is missing (0 bit/s)."""
        ...


class ConstantGain:
    """Always k_rho_min: the thesis's comparison."""

    def __init__(self, briefing: Briefing) -> None:
        self._k_rho = briefing.gains.k_rho_min

    def heard(self, throughput_bps: float, threshold_bps: float) -> float:  # noqa: ARG002 (the interface)
        return self._k_rho


class ThroughputGain:
    """k_rho_max while the last throughput is below the threshold, else k_rho_min (thesis 3.5)."""

    def __init__(self, briefing: Briefing) -> None:
        self._gains = briefing.gains

    def heard(self, throughput_bps: float, threshold_bps: float) -> float:
        low = throughput_bps < threshold_bps
        return self._gains.k_rho_max if low else self._gains.k_rho_min


class SmoothGain:
    """k_rho in proportion to the deficit of a filtered throughput, extrapolated while it falls.

    Differs: two-valued in the thesis. One fade then makes the robot jump at full gain for a whole
    period, and the gain rises only after the link is already bad. Here a single fade is halved by the
    filter, and a steady fall is seen before the threshold.
    """

    def __init__(self, briefing: Briefing) -> None:
        self._gains = briefing.gains
        self._filtered = -1.0

    def heard(self, throughput_bps: float, threshold_bps: float) -> float:
        before = self._filtered if self._filtered >= 0 else throughput_bps
        self._filtered = before + FILTER_SHARE * (throughput_bps - before)
        expected = self._filtered + LOOKAHEAD * min(0.0, self._filtered - before)
        calm = BAND * threshold_bps
        urgency = min(1.0, max(0.0, (calm - expected) / (calm - threshold_bps)))
        return self._gains.k_rho_min + urgency * (self._gains.k_rho_max - self._gains.k_rho_min)


PolicyMaker = Callable[[Briefing], GainPolicy]

BUILT_IN: dict[str, PolicyMaker] = {
    "throughput": ThroughputGain,
    "constant": ConstantGain,
    "smooth": SmoothGain,
    "predictive": PredictiveGain,
    "lambda2": Lambda2Gain,
}


def make_policy(briefing: Briefing) -> GainPolicy:
    """The policy that a scenario names: built in, or handed in."""
    make: PolicyMaker = briefing.plugin(GAIN_POLICIES) or BUILT_IN[briefing.gains.policy]
    return make(briefing)
