"""Directions of a laser's beams, for robot, world and viewer.

Beam 0 points to the right edge of the field of view, the last one to the left edge, counter-clockwise.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray
from onehop.contracts.sections import RobotSection


class Beams:
    """The beams of one laser.

    range: how far it looks [m]. angles: (n_beams,) float64 [rad], relative to the heading; spacing:
    between neighbours [rad]. directions: (n_beams, 2) unit vectors in the robot's frame.
    """

    def __init__(self, body: RobotSection) -> None:
        half = math.radians(body.laser_fov_deg) / 2.0
        self.range = body.laser_range
        self.half_view = half
        self.angles: FloatArray = np.linspace(-half, half, body.laser_beams)
        self.spacing = float(self.angles[1] - self.angles[0])
        self.directions: FloatArray = np.column_stack(
            (elementary.cosines(self.angles), elementary.sines(self.angles))
        )

    def spanned(self, angle: float) -> int:
        """How many spacings make up an angle [rad], to the nearest whole one and at least 1."""
        return max(1, round(angle / self.spacing))

    def near(self, marked: BoolArray, angle: float) -> BoolArray:
        """Which beams have a marked one within an angle [rad] to either side, (n_beams,)."""
        reach, n = self.spanned(angle), len(marked)
        padded = np.zeros(n + 2 * reach + 1, dtype=np.intp)
        padded[reach + 1 : reach + 1 + n] = marked
        count = padded.cumsum()
        return np.asarray(count[2 * reach + 1 :] > count[:n])
