"""Which beams of a leader's laser hit its own followers, and what the scan would be without them.

A planner that takes followers for walls finds itself locked in by them, and one that leaves their beams
out takes what they hide for a way on. So they are removed from the scan: a wall on both sides of a
follower goes on behind it. A follower is a disc of a robot's size in the scan, where the follower's last
report lets it be by now; or it is whatever is seen right where a follower reported itself. Whatever is
none of that stays an obstacle.

The disc is found by a matched filter: with the hull of a robot before every beam in turn, the ranges
around it are known, and the scan must agree with them. So a robot is found beside a wall and half behind
another robot as well, where it does not stand free.
"""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose
from onehop.contracts.sections import RobotSection
from robot_agent.core.motion.frames import frame_of
from robot_agent.core.motion.trail import Point

HULL_ERROR = 0.05
"""How far a range may be from that of a disc [m]: its middle need not lie on a beam."""

INNER = 0.85
"""Share of the radius within which ranges are compared: at the rim a disc falls off too fast."""

LEAST_SEEN = 0.6
"""Share of the hull that must be seen; something nearer may hide the rest."""

OPEN_SIDE = 0.25
"""Change of range at one of the rims at least [m]: a flat wall far away looks like a flat hull."""

LEAST_HITS = 3
"""Hits that tell a disc from a post, whatever the angle between them: two fit any disc."""

AT_HAND = 0.1
"""A hit this near to the hull of a reported robot is that robot [m]."""

SAME_WALL = 1.5
"""Ratio of the ranges on both sides of a follower up to which they are taken for one wall."""

BeamNumbers = npt.NDArray[np.intp]
"""Beams of a scan by their number, ascending."""

NO_BEAMS: BeamNumbers = np.empty(0, dtype=np.intp)


def without_followers(scan: Ranges, followers: BeamNumbers) -> Ranges:
    """The scan with its followers removed: their beams show what those beside them do.

    followers: (k,) beams that hit one. A wall on both sides goes on straight (in polar form it is
    linear in 1/range over a small angle); of two things the farther one does, because it is the one that
    the follower stands in front of.
    """
    if not len(followers):
        return scan
    beside = np.ones(len(scan), dtype=np.bool_)
    beside[followers] = False
    shown = np.flatnonzero(beside)
    clean = scan.copy()
    if not len(shown):
        clean[:] = np.inf
        return clean
    nearness = 1.0 / scan[shown]
    between = np.interp(followers, shown, nearness)
    place = np.searchsorted(shown, followers)
    left, right = nearness[np.maximum(place - 1, 0)], nearness[np.minimum(place, len(shown) - 1)]
    least = np.minimum(left, right)
    one_wall = np.maximum(left, right) <= SAME_WALL * least
    with np.errstate(divide="ignore"):
        clean[followers] = 1.0 / np.where(one_wall, between, least)
    return clean


class FollowerDetector:
    """Finds followers in scans."""

    def __init__(self, body: RobotSection, beams: Beams) -> None:
        self._radius = body.radius
        self._range = beams.range
        self._directions = beams.directions
        self._quarter = math.floor(0.5 * math.pi / beams.spacing)
        steps = np.arange(-self._quarter - 1, self._quarter + 2) * np.float64(beams.spacing)
        self._sines: FloatArray = elementary.sines(steps)
        self._cosines: FloatArray = elementary.cosines(steps)

    def beams(self, pose: Pose, scan: Ranges, places: Sequence[Point], reach: float) -> BeamNumbers:
        """The beams that hit a robot within `reach` of one of the places [m], map frame."""
        sight = self._range + reach
        own = map(frame_of(pose), places)
        near = [(x, y) for x, y in own if x > -reach and math.hypot(x, y) < sight]
        if not near:
            return NO_BEAMS
        seen = np.flatnonzero(scan <= self._range)
        if not len(seen):
            return NO_BEAMS
        nearest = seen[self._nearest(scan)[seen]]
        centres = self._directions[nearest] * (scan[nearest, None] + self._radius)
        possible = nearest[_apart(centres, np.array(near)) <= reach]
        found = np.zeros(len(scan), dtype=np.bool_)
        found[self._discs(scan, possible)] = True
        hits = self._directions[seen] * scan[seen, None]
        found[seen[_apart(hits, np.array(near)) <= self._radius + AT_HAND]] = True
        return np.flatnonzero(found)

    def _nearest(self, scan: Ranges) -> BoolArray:
        """Which beams see no farther than their neighbours, as one on the middle of a disc does."""
        edged = np.concatenate((scan[:1], scan, scan[-1:]))
        nearest: BoolArray = (scan <= edged[:-2]) & (scan <= edged[2:])
        return nearest

    def _discs(self, scan: Ranges, middles: BeamNumbers) -> BeamNumbers:
        """Beams of all discs of a robot's size whose middle is seen by one of these beams."""
        if not len(middles):
            return middles
        radius, count = self._radius, len(scan)
        far = scan[middles].astype(np.float64)[:, None] + radius
        # from the middle of the nearest disc to the first beam beyond its rim
        rising = self._sines[self._quarter + 1 : -1]
        reach = int(np.searchsorted(rising, radius / float(far.min()), side="right"))
        steps = np.arange(-reach, reach + 1)
        angles = slice(self._quarter + 1 - reach, self._quarter + 2 + reach)
        beside, hull = np.abs(far * self._sines[angles]), far * self._cosines[angles]
        hull -= np.sqrt(np.maximum(0.0, radius * radius - beside * beside))
        place = middles[:, None] + steps
        in_view = (place >= 0) & (place < count)
        ranges = np.where(in_view, scan[np.clip(place, 0, count - 1)], np.inf)
        off = ranges - hull
        inner = (beside <= INNER * radius) & in_view
        agrees = inner & (np.abs(off) <= HULL_ERROR)
        enough = np.maximum(LEAST_SEEN * inner.sum(axis=1), LEAST_HITS)
        outside = (beside > radius) & (beside <= 2.0 * radius) & in_view
        free = (outside & (np.abs(ranges - scan[middles][:, None]) > OPEN_SIDE)).any(axis=1)
        disc = free & (agrees.sum(axis=1) >= enough) & ~(inner & (off > HULL_ERROR)).any(axis=1)
        rim = (beside <= 1.1 * radius) & in_view & (np.abs(off) <= radius)
        found: BeamNumbers = place[disc][rim[disc]]
        return found


def _apart(points: FloatArray, places: FloatArray) -> FloatArray:
    """Distance of each point to the nearest place, (n,) [m]."""
    between = points[:, None, :] - places[None, :, :]
    apart: FloatArray = np.sqrt((between * between).sum(axis=2).min(axis=1, initial=np.inf))
    return apart
