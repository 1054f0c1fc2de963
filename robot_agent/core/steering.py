"""Where a follower may drive: free directions in its scan, and the border of what is in its way.

Steering is the Vector Field Histogram in the masked form of VFH+ (Ulrich and Borenstein 1998) without
its grid: a candidate direction is free when a disc of the robot's size and a clearance can be pushed
along it for far enough, and the free one nearest to the wanted bearing is taken, with a preference for
the one taken before. Border following is that of DistBug (Kamon and Rivlin 1997): turn to one side, keep
the obstacle on the other, and leave it when the way to the target is free.

Other robots are obstacles like any other (thesis 3.1). Only the current scan is used.
"""

import math

import numpy as np
import numpy.typing as npt

from onehop.contracts.messages import Ranges
from onehop.contracts.scenario import RobotSection
from robot_agent.core.scan import Fan

LOOKAHEAD = 3.0
"""Hits farther away do not steer [m]."""

CLEARANCES = (0.25, 0.08)
"""Wanted distance between hull and obstacle, and the least that is accepted in a tight place [m]."""

STEP = math.radians(5.0)
"""Spacing of the candidate directions [rad]."""

NEEDED = 1.2
"""A direction is free when it is for this far [m], or up to the target if that is nearer."""

INERTIA = 0.25
"""Cost of leaving the direction taken before, relative to that of leaving the bearing."""

FloatArray = npt.NDArray[np.float64]


class Steering:
    """Free directions of one scan. `look` first, then ask."""

    def __init__(self, body: RobotSection, fan: Fan) -> None:
        self._radii = tuple(body.radius + clearance for clearance in CLEARANCES)
        self._angles = fan.angles
        half = math.radians(min(body.laser_fov_deg, 180.0)) / 2.0
        self.candidates: FloatArray = np.arange(-half, half + 1e-9, STEP)
        difference = fan.angles[None, :] - self.candidates[:, None]
        self._along: FloatArray = np.cos(difference)
        self._across: FloatArray = np.abs(np.sin(difference))
        self._directions = fan.directions
        self._near: npt.NDArray[np.intp] = np.zeros(0, np.intp)
        self._ranges: FloatArray = np.zeros(0)
        self._points: FloatArray = np.zeros((0, 2))
        self._chosen = 0.0

    def look(self, scan: Ranges) -> None:
        """Take the scan of this tick."""
        self._near = np.flatnonzero(scan < LOOKAHEAD)
        self._ranges = scan[self._near].astype(np.float64)
        self._points = self._directions[self._near] * self._ranges[:, None]

    def free_distance(self, bearing: float, tight: bool = False) -> float:
        """How far the robot could drive along a bearing [m], at most LOOKAHEAD."""
        if not self._near.size:
            return LOOKAHEAD
        along = self._points @ (math.cos(bearing), math.sin(bearing))
        radius = self._radii[tight]
        beside = self._ranges * self._ranges - along * along
        inside = (along > 0.0) & (beside < radius * radius)
        if not inside.any():
            return LOOKAHEAD
        return float((along[inside] - np.sqrt(radius * radius - beside[inside])).min())

    def choose(self, bearing: float, distance: float, side: int) -> tuple[float, float] | None:
        """Direction to drive in and how far it is free [rad, m]; None when every direction is blocked.

        bearing, distance: of the target. side: 0 to take the free direction nearest to the bearing; +1
        to keep an obstacle on the right and pass it on the left, -1 the other way round.
        """
        need = min(NEEDED, distance)
        for radius in self._radii:
            free = self._free(radius)
            ok = free >= need
            if not ok.any():
                continue
            if side == 0:
                cost = np.abs(self.candidates - bearing) + INERTIA * np.abs(
                    self.candidates - self._chosen
                )
                best = int(np.where(ok, cost, np.inf).argmin())
            else:
                order = np.flatnonzero(ok)
                best = int(order[0] if side > 0 else order[-1])
            self._chosen = float(self.candidates[best])
            return self._chosen, float(free[best])
        return None

    def _free(self, radius: float) -> FloatArray:
        """(n_candidates,) how far each candidate is free for a disc of this radius [m]."""
        if not self._near.size:
            return np.full(self.candidates.shape, LOOKAHEAD)
        along = self._along[:, self._near] * self._ranges
        across = self._across[:, self._near] * self._ranges
        inside = (along > 0.0) & (across < radius)
        bow = np.sqrt(np.maximum(0.0, radius * radius - across * across))
        free: FloatArray = np.where(inside, along - bow, LOOKAHEAD).min(axis=1)
        return free
