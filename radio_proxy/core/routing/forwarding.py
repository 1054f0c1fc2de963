"""Who passes a ROUTE REQUEST on: the probability that makes DSR and AODV into MRSR and MRDV.

p_r = min(1, (1/v)^gamma), v the forwarder's own speed, gamma growing with its own remaining distance
(thesis 3.7.2; its second eq. 3.23). Origin and target of a request are exempt, and so is a request
whose flag says that a discovery has failed before.
"""

from onehop.contracts import elementary

BROADCAST_JITTER_NS = 10_000_000
"""Longest wait before a request is passed on, lest neighbours collide (RFC 4728, section 9) [ns]."""


def gamma(remaining_distance: float, gamma_distance: float) -> float:
    """Weight of the distance to go: remaining_distance / gamma_distance, both in metres.

    Differs: the thesis leaves the form open ("usually very large"). Linear, because it is the simplest
    that grows; with 10 m to the unit, p_r falls below 1/1000 for v = 2 m/s and 100 m to go.
    """
    return max(0.0, remaining_distance) / gamma_distance


def forwarding_probability(speed: float, weight: float) -> float:
    """p_r of a robot at `speed` [m/s] with gamma = `weight`; at rest it is 1."""
    if speed <= 1.0:
        return 1.0
    return elementary.exp(-weight * elementary.log1p(speed - 1.0))
