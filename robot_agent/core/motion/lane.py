"""Making room: how a leader that meets its own followers on its way gets past them.

A leader that turns round in a passage, or leaves a pocket by its mouth, finds its followers in front of
it: they are on their way to slots behind it. It then asks for a lane, the straight piece of its way that
is to be kept clear. Whoever hears that draws aside, as drivers do for an ambulance, stands still beside
the lane, and lets the leader pass; slots count again when the leader takes the order back. The leader
waits for a moment when somebody stands right before it. A lane is asked for and kept for bounded times,
so that a team that has no room to make goes on as before.

Ours; the thesis has no such order, and profile `thesis` does not use it.
"""

import math
from collections.abc import Sequence

from onehop.contracts import elementary
from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, wrap_angle
from robot_agent.core.motion.follower_detector import BeamNumbers
from robot_agent.core.motion.steering import Steering
from robot_agent.core.motion.trail import Point

LENGTH = 4.0
"""Piece of the leader's way that is to be kept clear, from where it stands [m]."""

HALF_WIDTH = 1.2
"""Distance from the lane that is out of the way [m]: more than the leader keeps from obstacles, less
than lets a robot stand between the lane and the wall of a passage of 3.5 m."""

MET_AHEAD, MET_BESIDE = 2.0, 0.8
"""A follower is in the way when it is this far ahead and this little beside the way, at most [m]."""

CLOSE = 1.2
"""The leader waits for a follower in its way that is nearer than this [m]."""

ASK_AFTER, CLEAR_AFTER = 0.4, 1.0
"""Time for which a follower is, or none is any more, in the way before the order changes [s]."""

LONGEST, PAUSE, LONGEST_WAIT = 12.0, 6.0, 3.0
"""How long a lane is asked for at most, how long not again then, how long the leader waits [s]."""

REPEAT = 1.0
"""A lane that is asked for is told anew after this time, because the leader moves [s]."""

TOP_SPEED = 1.0
"""Speed at which a robot draws aside, at most [m/s]: it has a metre to go, among others who do too."""

ON_LANE = 1e-3
"""Nearer to the middle of the lane than this there is no side to draw to [m]: the left one is taken."""


class LaneRequest:
    """The leader's side: when it asks for a lane, and which."""

    def __init__(self, beams: Beams, period: float) -> None:
        """period: of a tick [s]."""
        self._angles = beams.angles
        self._period = period
        self.begin()

    def begin(self) -> None:
        """Nothing was asked for yet."""
        self.lane: tuple[Point, ...] = ()
        self.wait = False
        self._met_for = self._clear_for = self._asked_for = self._waited_for = 0.0
        self._pause = self._silent_for = 0.0

    def watch(self, pose: Pose, scan: Ranges, followers: BeamNumbers, waypoint: Point) -> bool:
        """Take one tick; whether there is something to say at once.

        followers: (k,) beams that hit one. waypoint: where the leader is heading, map frame [m].
        """
        nearest = self._in_way(pose, scan, followers, waypoint)
        asked, wanted = bool(self.lane), self._wanted(nearest < MET_AHEAD)
        self.lane = _piece(pose, waypoint) if wanted else ()
        self._silent_for += self._period
        say = wanted is not asked or (asked and self._silent_for >= REPEAT)
        if say:
            self._silent_for = 0.0
        self.wait = wanted and nearest < CLOSE and self._waited_for < LONGEST_WAIT
        self._waited_for += self._period if self.wait else 0.0
        return say

    def held_back(self, twist: Twist) -> Twist | None:
        """Only the turn of a twist, while the leader waits for a follower to draw aside; else None."""
        return Twist(0.0, twist.w) if self.wait else None

    def _wanted(self, met: bool) -> bool:
        """Whether a lane is to be asked for now. met: a follower is in the way."""
        self._met_for = self._met_for + self._period if met else 0.0
        self._clear_for = 0.0 if met else self._clear_for + self._period
        self._pause = max(0.0, self._pause - self._period)
        if not self.lane:
            self._asked_for = self._waited_for = 0.0
            return self._met_for >= ASK_AFTER and self._pause == 0.0
        self._asked_for += self._period
        if self._clear_for < CLEAR_AFTER and self._asked_for < LONGEST:
            return True
        self._pause = PAUSE if met else 0.0
        return False

    def _in_way(self, pose: Pose, scan: Ranges, followers: BeamNumbers, waypoint: Point) -> float:
        """How far ahead on the straight way to the waypoint the next follower is [m]; inf for none."""
        if not len(followers):
            return math.inf
        bearing = elementary.atan2(waypoint[1] - pose.y, waypoint[0] - pose.x) - pose.heading
        off = self._angles[followers] - wrap_angle(bearing)
        ahead = scan[followers] * elementary.cosines(off)
        beside = scan[followers] * abs(elementary.sines(off))
        return float(ahead.min(where=(ahead > 0.0) & (beside < MET_BESIDE), initial=math.inf))


def draw_aside(steering: Steering, pose: Pose, scan: Ranges, lane: Sequence[Point]) -> Twist:
    """The follower's side: out of the lane, and then still. lane: its two ends, map frame [m]."""
    x, y = _nearest(lane, (pose.x, pose.y))
    distance = math.dist((x, y), (pose.x, pose.y))
    if distance >= HALF_WIDTH:
        return STANDSTILL
    if distance < ON_LANE:
        (ax, ay), (bx, by) = lane
        away = elementary.atan2(by - ay, bx - ax) + 0.5 * math.pi
    else:
        away = elementary.atan2(pose.y - y, pose.x - x)
    return steering.around(scan, wrap_angle(away - pose.heading), TOP_SPEED)


def _piece(pose: Pose, waypoint: Point) -> tuple[Point, Point]:
    """The first LENGTH metres of the straight way to the waypoint."""
    dx, dy = waypoint[0] - pose.x, waypoint[1] - pose.y
    share = min(1.0, LENGTH / max(math.hypot(dx, dy), 1e-6))
    return (pose.x, pose.y), (pose.x + share * dx, pose.y + share * dy)


def _nearest(lane: Sequence[Point], point: Point) -> Point:
    """The point of the lane that is nearest to a point."""
    (ax, ay), (bx, by) = lane
    dx, dy = bx - ax, by - ay
    length = dx * dx + dy * dy
    along = 0.0 if length == 0.0 else ((point[0] - ax) * dx + (point[1] - ay) * dy) / length
    along = min(1.0, max(0.0, along))
    return ax + along * dx, ay + along * dy
