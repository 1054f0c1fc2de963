"""Directions of a laser's beams, for robot, world and viewer.

Beam 0 points to the right edge of the field of view, the last one to the left edge, counter-clockwise.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
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
