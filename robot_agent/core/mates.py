"""Which beams of a leader's laser hit its own followers, and what the scan would be without them.

A planner that takes team mates for walls finds itself locked in by them, and one that leaves their beams
out takes what they hide for a way on. So they are painted over: a wall on both sides of a mate goes on
behind it. A follower is a run of neighbouring beams that stands free (what is beside it is farther
away), is as wide as a robot, and lies where the follower's last report lets it be by now; or it is
whatever is seen right where a follower reported itself. Whatever is none of that stays an obstacle.
"""

import math
from collections.abc import Sequence

import numpy as np

from onehop.contracts.geometry import Pose, to_local, to_map
from onehop.contracts.messages import Ranges
from onehop.contracts.sections import RobotSection
from robot_agent.core.scan import Fan

JUMP = 0.3
"""Change of range between neighbouring beams that separates two things [m]."""


AT_HAND = 0.1
"""A hit this near to the hull of a reported robot is that robot [m]."""


SAME_WALL = 1.5
"""Ratio of the ranges on both sides of a mate up to which they are taken for one wall."""


def painted(scan: Ranges, mates: frozenset[int]) -> Ranges:
    """The scan with these beams replaced by what their neighbours show.

    One wall on both sides goes on straight (in polar form it is linear in 1/range over a small angle);
    of two things the farther one does, because it is the one that the mate stands in front of.
    """
    if not mates:
        return scan
    hidden = np.zeros(len(scan), dtype=np.bool_)
    hidden[np.fromiter(mates, dtype=np.intp, count=len(mates))] = True
    beams, shown = np.flatnonzero(hidden), np.flatnonzero(~hidden)
    clean = scan.copy()
    if not len(shown):
        clean[:] = np.inf
        return clean
    nearness = 1.0 / scan[shown]
    between = np.interp(beams, shown, nearness)
    place = np.searchsorted(shown, beams)
    left, right = nearness[np.maximum(place - 1, 0)], nearness[np.minimum(place, len(shown) - 1)]
    least = np.minimum(left, right)
    one_wall = np.maximum(left, right) <= SAME_WALL * least
    with np.errstate(divide="ignore"):
        clean[beams] = 1.0 / np.where(one_wall, between, least)
    return clean


LEAST_SHARE = 0.6
"""Least part of a robot's width that a run must have [1]: a wall seen at a grazing angle falls apart
into runs of a beam or two, none of them a robot."""


class Lookout:
    """Finds followers in scans."""

    def __init__(self, body: RobotSection, fan: Fan) -> None:
        self._radius = body.radius
        self._width = 2.0 * body.radius + 0.05
        self._range = fan.range
        self._angles = fan.angles
        self._spacing = float(fan.angles[1] - fan.angles[0])
        self._directions = fan.directions

    def beams(
        self, pose: Pose, scan: Ranges, places: Sequence[tuple[float, float]], reach: float
    ) -> frozenset[int]:
        """Beams that hit a robot within `reach` of one of the places [m], map frame."""
        sight = self._range + reach
        c, s = math.cos(pose.heading), math.sin(pose.heading)
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
            if 2.0 * distance * math.sin(min(spread, math.pi) / 2.0) > self._width:
                continue
            expected = 2.0 * math.asin(self._radius / (distance + self._radius)) / self._spacing
            if end - first < LEAST_SHARE * expected or not _in_front(ranges, first, end):
                continue
            middle = 0.5 * float(self._angles[end - 1] + self._angles[first])
            centre = distance + self._radius
            x, y = to_map(pose, centre * math.cos(middle), centre * math.sin(middle))
            if any(math.hypot(x - px, y - py) <= reach for px, py in places):
                found.extend(range(first, end))
        return frozenset(found).union(self._at_hand(pose, scan, places))

    def _at_hand(self, pose: Pose, scan: Ranges, places: Sequence[tuple[float, float]]) -> list[int]:
        """Beams that hit something right at one of the places."""
        seen = np.flatnonzero(scan <= self._range)
        hits = self._directions[seen] * scan[seen, None]
        own = np.array([to_local(pose, x, y) for x, y in places])
        apart = hits[:, None, :] - own[None, :, :]
        near = (apart * apart).sum(axis=2) <= (self._radius + AT_HAND) ** 2
        found: list[int] = seen[near.any(axis=1)].tolist()
        return found


def _in_front(ranges: Ranges, first: int, end: int) -> bool:
    """Whether what is seen on both sides of a run is farther away than its ends."""
    left_free = first == 0 or ranges[first - 1] > ranges[first]
    return bool(left_free and (end == len(ranges) or ranges[end] > ranges[end - 1]))
