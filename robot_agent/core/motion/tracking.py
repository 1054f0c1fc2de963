"""Tracking controller of a follower: polar error to its slot, twist, and the gain k_rho (thesis 3.5).

v = k_rho*rho and w = k_alpha*alpha + k_beta*beta drive a unicycle to a pose. The thesis varies k_rho
with the throughput of the link to the leader; the policy that does so is replaceable.

Differs: beta is taken relative to the slot's heading, because (3.7) is written for a target that looks
along the x axis. Differs: when w would pass the body's limit, v and w are reduced together, because
the arc is then still the one that the controller meant; the thesis has no limits.
"""

import math
from dataclasses import replace

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose, Twist, wrap_angle
from onehop.contracts.sections import GainsSection, RobotSection
from onehop.contracts.values import Value

HALF_TURN = math.pi / 2.0


class PolarError(Value, frozen=True):
    """Where the target is: distance rho [m], bearing alpha, and heading still to turn beta [rad].

    reverse: the target is behind, alpha in (3.9), so that the robot would have to back up.
    """

    rho: float
    alpha: float
    beta: float
    reverse: bool


def sampled(gains: GainsSection, period: float) -> GainsSection:
    """The same gains, k_alpha lowered to what a controller with this period [s] can close in one tick.

    Differs: the thesis's law is continuous; sampled too slowly, k_alpha = 8 swings for ever.
    """
    return replace(gains, k_alpha=min(gains.k_alpha, 1.0 / period))


def polar_error(pose: Pose, target: Pose) -> PolarError:
    """Error of a pose to a target in polar form (thesis eq. 3.5 to 3.10).

    For a target behind (3.9), alpha and beta are those of a robot that looks the other way, which is
    what v = -v in (3.10) amounts to: both forms then use the same law (3.11), (3.12).
    """
    dx, dy = target.x - pose.x, target.y - pose.y
    alpha = wrap_angle(elementary.atan2(dy, dx) - pose.heading)
    reverse = not -HALF_TURN < alpha <= HALF_TURN
    if reverse:
        alpha = wrap_angle(alpha + math.pi)
    beta = wrap_angle(target.heading - pose.heading - alpha)
    return PolarError(math.hypot(dx, dy), alpha, beta, reverse)


def polar_twist(error: PolarError, gains: GainsSection, k_rho: float, max_speed: float) -> Twist:
    """Twist that closes a polar error (thesis eq. 3.11, 3.12), v limited to max_speed [m/s]."""
    v = min(k_rho * error.rho, max_speed)
    w = gains.k_alpha * error.alpha + gains.k_beta * error.beta
    return Twist(-v if error.reverse else v, w)


def within_limits(twist: Twist, body: RobotSection) -> Twist:
    """The same arc at a speed that the body can turn at."""
    if abs(twist.w) <= body.max_turn_rate:
        return twist
    share = body.max_turn_rate / abs(twist.w)
    return Twist(twist.v * share, math.copysign(body.max_turn_rate, twist.w))
