"""What the driver of a real base and the world tell each other (docs/hardware.md).

Pose, scan and twist that the base measures take the place of what the world would compute for its robot,
and what the world would move that robot by goes to the base.
"""

import math

import numpy as np

from onehop.contracts.arrays import Ranges
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.sections import RobotSection
from onehop.contracts.values import Wire

LARGEST = 1e7
"""Largest metre, metre a second or radian a second that a base may measure: as map coordinates go."""

_HEADING_SLACK = 1e-6
"""What a heading of single precision may lie beyond pi [rad]."""


class Measured(Wire, frozen=True):
    """What a base measures now (key measured).

    number: of this measurement, from 1 in each process of the driver. pose: of the middle of the robot,
    in the map frame. scan: (laser_beams of its body,) float32 [m], first beam to the right, last to the
    left; +inf where nothing is in range.
    """

    number: int
    pose: Pose
    twist: Twist
    scan: Ranges


class Taken(Wire, frozen=True):
    """A measurement that the world has taken in: from this tick on the robot is there (key base/<i>)."""

    tick: int
    time_ns: int
    measured: Measured


class Drive(Wire, frozen=True):
    """World to a base, once a tick: the twist by which the world would have moved a simulated robot."""

    tick: int
    twist: Twist


class BaseBriefing(Wire, frozen=True):
    """All that the driver of a base is told before it starts.

    period_ns: length of a tick. silence_s: after so long without a measurement the robot leaves [s].
    body: radius, motors and laser that the mission counts on.
    """

    robot: int
    period_ns: int
    silence_s: float
    body: RobotSection


def wrong_measurement(measured: Measured, beams: int) -> str | None:
    """What no base can have measured, in a few plain words; None if it can. beams: of its laser."""
    if measured.number < 1:
        return f"number is {measured.number}, they count from 1"
    for name, value, most in (
        ("pose.x", measured.pose.x, LARGEST),
        ("pose.y", measured.pose.y, LARGEST),
        ("pose.heading", measured.pose.heading, math.pi + _HEADING_SLACK),
        ("twist.v", measured.twist.v, LARGEST),
        ("twist.w", measured.twist.w, LARGEST),
    ):
        if not -most <= value <= most:
            return f"{name} is {value!r}, not a number from {-most:.7g} to {most:.7g}"
    if len(measured.scan) != beams:
        return f"its scan has {len(measured.scan)} ranges, the robot's laser {beams}"
    if not np.all(measured.scan >= 0.0):
        return "its scan has a range that is negative or no number"
    return None
