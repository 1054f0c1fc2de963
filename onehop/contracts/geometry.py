"""Plane geometry that more than one program needs: poses, twists, frames, angles.

SI units, radians, x forward, y left. Headings are wrapped to (-pi, pi].
"""

import math

from onehop.contracts import elementary
from onehop.contracts.values import Value

TAU = 2.0 * math.pi


class Pose(Value, frozen=True):
    """Position [m] and heading [rad] in the map frame."""

    x: float
    y: float
    heading: float


class Twist(Value, frozen=True):
    """Velocity of a unicycle: v [m/s] along its heading, w [rad/s] to the left (thesis eq. 3.3)."""

    v: float
    w: float


STANDSTILL = Twist(0.0, 0.0)


def wrap_angle(angle: float) -> float:
    """The same direction in (-pi, pi]."""
    wrapped = math.remainder(angle, TAU)
    return math.pi if wrapped == -math.pi else wrapped


def to_map(origin: Pose, x: float, y: float) -> tuple[float, float]:
    """A point given in the frame of `origin`, in the map frame [m]."""
    c, s = elementary.cos(origin.heading), elementary.sin(origin.heading)
    return origin.x + c * x - s * y, origin.y + s * x + c * y


def to_local(origin: Pose, x: float, y: float) -> tuple[float, float]:
    """A point given in the map frame, in the frame of `origin` [m]."""
    c, s = elementary.cos(origin.heading), elementary.sin(origin.heading)
    dx, dy = x - origin.x, y - origin.y
    return c * dx + s * dy, c * dy - s * dx
