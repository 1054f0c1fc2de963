"""The gain policy `lambda2`: each follower moves to where the team's network is better connected.

The second smallest eigenvalue of the Laplacian of a graph, lambda-2, is 0 when it falls apart and grows
with its connectedness (M. Fiedler, 1973). Weights are rates of the links by the channel of J. Fink,
"Communication for teams of networked robots", PhD thesis, University of Pennsylvania, 2011: of a power
P = L0 - 10 n log10(d) the rate 1 - erfc(sqrt(P / N0)). With its eigenvector v the gradient over the
place of robot i is the sum over j of dw_ij/dx_i (v_i - v_j)^2.

A robot knows its own place, and of the others what its leader's last word says: where that one was, and
so where the others belong. It follows uphill of log lambda-2 from its slot, with k_rho_min.

Differs: pure ascent draws the whole team into one point, so the step is bounded and taken from the slot.
The gradient is renewed with each word of the leader, not continuously, because nothing else is news.
"""

import math

from onehop.contracts import elementary
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose
from robot_agent.core.motion.aim import Aim, Point, Situation

REFERENCE_DBM = -53.0
EXPONENT = 2.52
NOISE_DBM = -70.0
"""Received power at 1 m, path loss exponent, and noise floor of Fink 2011."""

NEAREST = 0.5
"""Robots nearer than this count as this far apart [m]."""

ASCENT = 25.0
"""Way towards better connectedness for a relative rise of lambda-2 of 1 a metre [m^2]."""

LONGEST_STEP = 0.5
"""A robot leaves its slot by at most this share of the spacing of the formation."""

ITERATIONS = 64
"""Of the power method: enough for the direction in which a robot of a team of six is to go."""

_AT_1_M = elementary.power_of_ten((REFERENCE_DBM - NOISE_DBM) / 20.0)

Weights = list[list[float]]


def rate(distance: float) -> tuple[float, float]:
    """Rate of a link, as a share of the best, and its change with distance [1/m]."""
    apart = max(distance, NEAREST)
    root = _AT_1_M * elementary.power_of_ten(-EXPONENT / 2.0 * elementary.log10(apart))
    slope = -2.0 / math.sqrt(math.pi) * elementary.exp(-root * root) * EXPONENT / 2.0 * root / apart
    return elementary.erf(root), slope


def second_eigenpair(weights: Weights) -> tuple[float, list[float]]:
    """Lambda-2 of the Laplacian of a symmetric matrix of weights (n, n), n >= 2, and its unit vector.

    By the power method on c I - L, without the constant vector, whose eigenvalue of L is 0; c is twice
    the largest degree, which no eigenvalue exceeds (Gershgorin).
    """
    count = len(weights)
    degrees = [math.fsum(row) for row in weights]
    shift = 2.0 * max(degrees)
    vector = _centred_unit([float(i * i) for i in range(count)])
    for _ in range(ITERATIONS):
        vector = _centred_unit(
            [
                (shift - degrees[i]) * vector[i]
                + sum([weight * other for weight, other in zip(weights[i], vector, strict=True)])
                for i in range(count)
            ]
        )
    value = 0.0
    for i, row in enumerate(weights):
        for j in range(i):
            value += row[j] * (vector[i] - vector[j]) * (vector[i] - vector[j])
    return value, vector


def _centred_unit(vector: list[float]) -> list[float]:
    """Without its mean, and of length 1; what is constant stays as a first unit vector without mean."""
    mean = math.fsum(vector) / len(vector)
    centred = [value - mean for value in vector]
    length = math.sqrt(math.fsum([value * value for value in centred]))
    if length == 0.0:
        return _centred_unit([1.0] + [0.0] * (len(vector) - 1))
    return [value / length for value in centred]


def ascent(here: Point, others: tuple[Point, ...]) -> Point:
    """Gradient of log lambda-2 over the place of a robot among others [1/m]; none where it is alone."""
    places = (here, *others)
    count = len(places)
    weights = [[0.0] * count for _ in places]
    slopes = [0.0] * count
    for i in range(count):
        for j in range(i):
            weights[i][j], slope = rate(math.dist(places[i], places[j]))
            weights[j][i] = weights[i][j]
            if j == 0:
                slopes[i] = slope
    value, vector = second_eigenpair(weights)
    if value <= 0.0:
        return 0.0, 0.0
    x = y = 0.0
    for j in range(1, count):
        apart = math.dist(here, places[j])
        if apart > NEAREST:
            weight = slopes[j] * (vector[0] - vector[j]) * (vector[0] - vector[j]) / (value * apart)
            x += weight * (here[0] - places[j][0])
            y += weight * (here[1] - places[j][1])
    return x, y


class Lambda2Gain:
    """k_rho_min towards a slot that is moved uphill of lambda-2."""

    def __init__(self, briefing: Briefing) -> None:
        self._k_rho = briefing.gains.k_rho_min
        self._longest = LONGEST_STEP * briefing.team.spacing
        self._told_ns = -1
        self._step: Point = (0.0, 0.0)

    def heard(self, throughput_bps: float, threshold_bps: float) -> float:  # noqa: ARG002 (the interface)
        """Throughput is not what it goes by."""
        return self._k_rho

    def aim(self, situation: Situation) -> Aim:
        """The slot, and from there uphill; the very slot while the team gathers, and at the end."""
        slot = situation.slot
        if not situation.driving:
            return Aim(slot, self._k_rho)
        if situation.told_ns != self._told_ns:
            self._told_ns = situation.told_ns
            here = situation.pose.x, situation.pose.y
            self._step = self._bounded(ascent(here, situation.others))
        return Aim(Pose(slot.x + self._step[0], slot.y + self._step[1], slot.heading), self._k_rho)

    def _bounded(self, gradient: Point) -> Point:
        x, y = ASCENT * gradient[0], ASCENT * gradient[1]
        length = math.hypot(x, y)
        share = min(1.0, self._longest / length) if length > 0.0 else 0.0
        return share * x, share * y
