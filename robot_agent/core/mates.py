"""Which beams of a leader's laser hit its own followers.

A planner that takes team mates for walls finds itself locked in by them. A follower is a run of
neighbouring beams that stands free (the range jumps at both ends), is not wider than a robot, and lies
where the follower's last report lets it be by now. Whatever is not all of that stays an obstacle.
"""

import math
from collections.abc import Sequence

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose, to_map
from onehop.contracts.messages import Ranges
from onehop.contracts.sections import RobotSection
from robot_agent.core.scan import Fan

JUMP = 0.3
"""Change of range between neighbouring beams that separates two things [m]."""


class Lookout:
    """Finds followers in scans."""

    def __init__(self, body: RobotSection, fan: Fan) -> None:
        self._radius = body.radius
        self._width = 2.0 * body.radius + 0.05
        self._range = fan.range
        self._angles = fan.angles

    def beams(
        self, pose: Pose, scan: Ranges, places: Sequence[tuple[float, float]], reach: float
    ) -> frozenset[int]:
        """Beams that hit a robot within `reach` of one of the places [m], map frame."""
        sight = self._range + reach
        c, s = elementary.cos(pose.heading), elementary.sin(pose.heading)
        places = [
            (x, y)
            for x, y in places
            if math.hypot(x - pose.x, y - pose.y) < sight
            and (x - pose.x) * c + (y - pose.y) * s > -reach
        ]
        if not places:
            return frozenset()
        ranges = np.minimum(scan, self._range + 2.0 * JUMP)
        edges = np.flatnonzero(np.abs(np.diff(ranges)) > JUMP) + 1
        found: list[int] = []
        starts = [0, *edges.tolist()]
        for first, end in zip(starts, [*starts[1:], len(scan)], strict=True):
            distance = float(ranges[(first + end - 1) // 2])
            if distance > self._range:
                continue
            spread = float(self._angles[end - 1] - self._angles[first])
            if 2.0 * distance * elementary.sin(min(spread, math.pi) / 2.0) > self._width:
                continue
            middle = 0.5 * float(self._angles[end - 1] + self._angles[first])
            centre = distance + self._radius
            x, y = to_map(pose, centre * elementary.cos(middle), centre * elementary.sin(middle))
            if any(math.hypot(x - px, y - py) <= reach for px, py in places):
                found.extend(range(first, end))
        return frozenset(found)
