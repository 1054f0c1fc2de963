"""How the robots of these examples drive: into the free direction nearest to the wanted one, safely."""

import numpy as np
from numpy.typing import NDArray

from onehop.robot import Beams, Briefing, Twist, cos

LOOKAHEAD = 1.5
"""How far a direction has to be free [m]."""

MARGIN = 0.15
"""Clearance that is always kept beside the own hull [m]."""

APPROACH = 2.0
"""Speed towards something, per metre that is left [1/s]: two that do so never touch."""


class Pilot:
    """Sees with the laser alone; it keeps no map."""

    def __init__(self, briefing: Briefing) -> None:
        body = briefing.body
        beams = Beams(body)
        self.angles = beams.angles
        self._reach = body.radius + MARGIN
        self._range = body.laser_range
        self._ahead, left = beams.directions[:, 0], beams.directions[:, 1]
        candidates = np.arange(0, len(self.angles), 4)
        self.candidates = self.angles[candidates]
        c, s = self._ahead[candidates, None], left[candidates, None]
        self._along = c * self._ahead + s * left
        self._beside = np.abs(c * left - s * self._ahead)
        self._side = 0

    def drive(self, scan: NDArray[np.float32], turn: float, speed: float) -> Twist:
        """Towards a direction relative to the heading [rad], around what is in the way.

        Once it passes something on one side it keeps to that side until its direction is free.
        """
        seen = np.minimum(scan.astype(float), self._range)
        sure = abs(turn) <= self.angles[-1]
        if not sure and not self._side:
            return Twist(0.0, 2.0 if turn > 0.0 else -2.0)
        off = self.candidates - max(self.angles[0], min(self.angles[-1], turn))
        open_for = self.free_distances(seen)
        shut = open_for < min(LOOKAHEAD, float(open_for.max()))
        straight = int(abs(off).argmin())
        if sure and not shut[straight]:
            self._side = 0
        elif not self._side:
            self._side = 1 if off[np.where(shut, np.inf, abs(off)).argmin()] > 0.0 else -1
        cost = (
            abs(off) if not self._side else np.where(self._side * off < 0.0, 10.0 + abs(off), abs(off))
        )
        chosen = float(self.candidates[np.where(shut, np.inf, cost).argmin()])
        return Twist(min(speed * max(0.0, cos(chosen)), self._safe_speed(seen)), 2.0 * chosen)

    def free_distances(self, seen: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far the hull could go in each candidate direction [m]."""
        in_the_way = (self._along > 0.0) & (seen * self._beside < self._reach + 0.05)
        ahead = np.where(in_the_way & (seen < self._range), seen * self._along, self._range)
        return np.asarray(ahead.min(axis=1) - self._reach)

    def _safe_speed(self, seen: NDArray[np.float64]) -> float:
        """So slow that no beam's obstacle comes nearer than the margin."""
        towards = self._ahead > 1e-6
        room = np.maximum(0.0, seen[towards] - self._reach)
        return float((APPROACH * room / self._ahead[towards]).min())
