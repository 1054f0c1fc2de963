"""Geometry of one laser scan: beam directions and hit points in the robot's frame.

Beam 0 points to the right edge of the field of view, the last one to the left edge. +inf = no return.
"""

import math

import numpy as np
import numpy.typing as npt

from onehop.contracts import elementary
from onehop.contracts.messages import Ranges
from onehop.contracts.sections import RobotSection

FloatArray = npt.NDArray[np.float64]


class Fan:
    """The beams of one laser, made once for each robot.

    angles: (n_beams,) float64 [rad], relative to the heading. directions: (n_beams, 2) unit vectors.
    """

    def __init__(self, body: RobotSection) -> None:
        half = math.radians(body.laser_fov_deg) / 2.0
        self.range = body.laser_range
        self.angles: FloatArray = np.linspace(-half, half, body.laser_beams)
        self.directions: FloatArray = np.column_stack(
            (elementary.cosines(self.angles), elementary.sines(self.angles))
        )

    def hits(self, scan: Ranges) -> FloatArray:
        """Points where beams hit something, (n_hits, 2) float64 [m], robot frame, right to left."""
        seen = np.isfinite(scan)
        return self.directions[seen] * scan[seen, None].astype(np.float64)
