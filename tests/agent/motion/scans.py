"""A robot, its beams, and scans of simple things: what the tests of motion look at."""

import math

import numpy as np

from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose, Twist, wrap_angle
from onehop.contracts.sections import GainsSection, RobotSection

BODY, GAINS = RobotSection(), GainsSection()
BEAMS = Beams(BODY)
PERIOD = 0.05
OPEN = np.full(181, np.inf, np.float32)
HERE = Pose(0.0, 0.0, 0.0)


def block(first: int, last: int, distance: float) -> Ranges:
    """A scan with one thing between two bearings [deg]."""
    scan = OPEN.copy()
    scan[90 + first : 91 + last] = distance
    return scan


def walls(distance: float) -> Ranges:
    """A scan of something all around."""
    return np.full(181, distance, np.float32)


def moved(pose: Pose, twist: Twist, period: float = PERIOD) -> Pose:
    """Where a twist leads in one tick."""
    middle = pose.heading + 0.5 * twist.w * period
    return Pose(
        pose.x + twist.v * period * math.cos(middle),
        pose.y + twist.v * period * math.sin(middle),
        wrap_angle(pose.heading + twist.w * period),
    )
