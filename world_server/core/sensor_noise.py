"""What a robot's sensors add to the truth: noise on its pose and on the ranges of its laser.

One stream for each robot, so that what one of them sees does not depend on who else is there; as many
draws for each observation, whatever it shows. Without noise nothing is drawn.
"""

import math

import numpy as np

from onehop.contracts.arrays import FloatArray
from onehop.contracts.geometry import Pose, wrap_angle
from onehop.contracts.randomness import generator, normals
from onehop.contracts.sections import NOISE_SIGMAS, RobotSection
from world_server.core.laser import Scans


class SensorNoise:
    """The noise of one robot's sensors, in all of its incarnations."""

    def __init__(self, seed: int, robot: int, body: RobotSection) -> None:
        self._stream = generator(seed, f"world/sensors/{robot}")
        self._place = body.pose_noise
        self._heading = math.radians(body.heading_noise_deg)
        self._range = body.laser_noise
        self._farthest = body.laser_range

    def pose(self, true: Pose) -> Pose:
        """Where the robot takes itself to be."""
        if not self._place and not self._heading:
            return true
        x, y, turn = self._draws(3).tolist()
        heading = wrap_angle(true.heading + self._heading * turn)
        return Pose(true.x + self._place * x, true.y + self._place * y, heading)

    def blur(self, scan: Scans) -> None:
        """Add noise to a scan, in place: a range that was finite stays from 0 to the laser's range."""
        if self._range:
            noisy = scan + self._range * self._draws(len(scan))
            hit = np.isfinite(scan)
            scan[hit] = noisy[hit].clip(0.0, self._farthest)

    def _draws(self, count: int) -> FloatArray:
        return normals(self._stream, count).clip(-NOISE_SIGMAS, NOISE_SIGMAS)


def sensor_noise(seed: int, robot: int, body: RobotSection) -> SensorNoise | None:
    """The noise of a robot; None where there is none."""
    if not (body.pose_noise or body.heading_noise_deg or body.laser_noise):
        return None
    return SensorNoise(seed, robot, body)
