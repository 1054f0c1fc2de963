"""What a robot knows of the ground behind it: what its laser showed a moment ago.

The laser looks 180 degrees ahead, and a slot that is to be backed up to (thesis eq. 3.9, 3.10) lies in
exactly the other half. A robot that backs up all the same never sees where it goes, and goes on so: its
slot stays behind it, and walls are met unseen. So it backs up only over ground that it saw free a moment
ago, all the way to its slot, and turns to the slot otherwise. What it saw beside that may be a robot
that has come nearer since; what came from out of its view is not seen, so a moment is short.
"""

import math
from collections import deque

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose, to_local
from onehop.contracts.sections import RobotSection
from robot_agent.core.motion.timing import in_ticks

MOMENT = 1.0
"""How long ago it may have been seen [s]: in 48 missions on the study maps, 1 s led to no contact and
2 s to two."""

EVERY = 0.2
"""Time between the scans that are kept [s]: 0.6 m of way at 3 m/s."""

CLEARANCE = 0.25
"""Distance between hull and obstacle on the way back [m], as ahead (free_directions.py)."""

STEP = 0.25
"""Distance between the places of the way back that are looked at [m], about a robot's radius."""

FARTHEST = 2.5
"""A slot farther behind than this is turned to [m]: nearer it was in view while the robot passed it."""


class RearView:
    """The scans of the last moment. `see` at every tick, then ask."""

    def __init__(self, body: RobotSection, beams: Beams, period: float) -> None:
        """period: of a tick [s]."""
        self._beams = beams
        self._radius = body.radius + CLEARANCE
        self._every = in_ticks(EVERY, period)
        self._nearer = body.leader_speed * period  # m that another robot comes nearer in a tick
        self._kept: deque[tuple[int, Pose, Ranges]] = deque(maxlen=max(1, round(MOMENT / EVERY)))
        self._tick = 0

    def see(self, pose: Pose, scan: Ranges) -> None:
        """Take the scan of this tick."""
        if self._tick % self._every == 0:
            self._kept.append((self._tick, pose, scan))
        self._tick += 1

    def free(self, pose: Pose, x: float, y: float) -> bool:
        """Whether the straight way back to a point [m], map frame, was seen free a moment ago."""
        distance = math.hypot(x - pose.x, y - pose.y)
        if distance > FARTHEST:
            return False
        count = max(1, math.ceil(distance / STEP))
        share = np.arange(1, count + 1) / count
        unseen = np.column_stack((pose.x + share * (x - pose.x), pose.y + share * (y - pose.y)))
        for tick, seen_from, scan in reversed(self._kept):
            apart = self._radius + (self._tick - tick) * self._nearer
            unseen = unseen[[not self._shown(seen_from, scan, place, apart) for place in unseen]]
            if not len(unseen):
                return True
        return False

    def _shown(self, seen_from: Pose, scan: Ranges, place: FloatArray, apart: float) -> bool:
        """Whether a scan showed a disc free: all beams through it went past it.

        apart: what it hit was this far from the middle of the disc, at least [m].
        """
        ahead, left = to_local(seen_from, float(place[0]), float(place[1]))
        distance = math.hypot(ahead, left)
        if distance <= self._radius:
            return False
        half = elementary.atan2(
            self._radius, math.sqrt(distance * distance - self._radius * self._radius)
        )
        bearing = elementary.atan2(left, ahead)
        if abs(bearing) + half > self._beams.half_view:
            return False
        first, spacing = float(self._beams.angles[0]), self._beams.spacing
        low = math.floor((bearing - half - first) / spacing)
        high = math.ceil((bearing + half - first) / spacing)
        if scan[max(low, 0) : high + 1].min() < distance + self._radius:
            return False
        seen = scan <= self._beams.range
        dx, dy = (self._beams.directions[seen] * scan[seen, None] - (ahead, left)).T
        return bool((dx * dx + dy * dy).min(initial=math.inf) >= apart * apart)
