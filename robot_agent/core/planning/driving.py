"""Driving along a way at constant speed: pure pursuit, and a shield against what appears late.

Pure pursuit (Coulter 1992) aims at a point `lookahead` further along the way; the curvature that leads
there is 2 sin(alpha) / lookahead. The speed is the leader's constant speed; it drops only where the
turn rate could not follow, or where the next step would come closer to an obstacle than is allowed.
"""

import itertools
import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose, Twist, wrap_angle
from onehop.contracts.messages import Ranges
from onehop.contracts.sections import RobotSection
from robot_agent.core.scan import Fan, FloatArray

FULL_SPEED_BELOW = 0.6
"""Bearing of the aim up to which the leader keeps its speed [rad]."""

TURN_IN_PLACE_ABOVE = 1.3
"""Bearing of the aim from which it only turns [rad]."""


SLIDE = math.pi / 2 + 0.12
"""Bearing that a too near obstacle gets while the robot slides past it [rad]."""


TURNS_AWAY = 0.3
"""Turn rate from which a way leads past what is ahead [rad/s]: then turning suffices. Sliding along the
nearest obstacle instead, a robot could swing to and fro between two for ever."""


class Driver:
    """Follows one way after the other. period: of a tick [s]. clearance: to keep from obstacles [m]."""

    def __init__(self, body: RobotSection, fan: Fan, period: float, clearance: float) -> None:
        self.body = body
        self.fan = fan
        self.period = period
        self.clearance = clearance
        self.lookahead = max(0.4 * body.leader_speed, body.leader_speed / body.max_turn_rate)
        self.way: list[tuple[float, float]] = []
        self.leg = 0
        self.shielded = 0
        self.turning = 0
        step = body.leader_speed * period
        aside, ahead = body.radius + 0.05, 3.0 * body.radius + 2.0 * step
        self._stop_ranges = _corridor(fan.angles, aside, ahead)
        self._caution = max(clearance + 2.0 * step, math.hypot(aside, ahead))

    def follow(self, way: FloatArray) -> None:
        """Take a new way, (n, 2) [m], map frame, from where the robot is."""
        self.way = [(float(x), float(y)) for x, y in way]
        self.leg = 0
        self.turning = 0

    def left(self, pose: Pose) -> float:
        """Length of the way still to drive [m]."""
        if len(self.way) < 2:
            return 0.0
        points = [(pose.x, pose.y), *self.way[self.leg + 1 :]]
        return sum(math.dist(a, b) for a, b in itertools.pairwise(points))

    def drive(self, pose: Pose, scan: Ranges) -> Twist:
        """The twist for this tick on the way; standstill at its end."""
        if len(self.way) < 2:
            return Twist(0.0, 0.0)
        x, y = self._aim(pose)
        return self.shield(scan, self.towards(pose, x, y))

    def towards(self, pose: Pose, x: float, y: float) -> Twist:
        """Twist that leads to a point nearby, by pure pursuit."""
        dx, dy = x - pose.x, y - pose.y
        distance = math.hypot(dx, dy)
        if distance < 1e-6:
            return Twist(0.0, 0.0)
        bearing = wrap_angle(elementary.atan2(dy, dx) - pose.heading)
        size = abs(bearing)
        if size > TURN_IN_PLACE_ABOVE or (self.turning and size > FULL_SPEED_BELOW):
            return self._turn(bearing)
        self.turning = 0
        speed = min(self.body.leader_speed, distance / self.period)
        if size > FULL_SPEED_BELOW:
            speed *= (TURN_IN_PLACE_ABOVE - size) / (TURN_IN_PLACE_ABOVE - FULL_SPEED_BELOW)
        w = speed * 2.0 * elementary.sin(bearing) / max(distance, 0.1)
        limit = self.body.max_turn_rate
        if abs(w) > limit:
            speed *= limit / abs(w)
            w = math.copysign(limit, w)
        return Twist(speed, w)

    def turn_to(self, pose: Pose, heading: float) -> Twist:
        """Turn in place to a heading."""
        return self._turn(wrap_angle(heading - pose.heading))

    def _turn(self, bearing: float) -> Twist:
        """Turn in place; the side is kept until the turn is done, or two could alternate forever."""
        if not self.turning:
            self.turning = 1 if bearing >= 0 else -1
        if bearing * self.turning < 0 and abs(bearing) < math.pi / 2:
            self.turning = -self.turning
        rate = min(self.body.max_turn_rate, abs(bearing) / self.period)
        return Twist(0.0, rate * self.turning)

    def shield(self, scan: Ranges, twist: Twist) -> Twist:
        """The same twist, unless it would hit something or enter an inflated obstacle."""
        nearest = float(scan.min())
        if twist.v <= 0.0:
            return twist
        if nearest > self._caution:
            self.shielded = 0
            return twist
        seen = np.flatnonzero(scan <= self._caution)
        points = self.fan.directions[seen] * scan[seen, None]
        step, turn = twist.v * self.period, 0.5 * twist.w * self.period
        next_room = elementary.lengths(
            points[:, 0] - step * elementary.cos(turn), points[:, 1] - step * elementary.sin(turn)
        )
        ahead = bool((scan < self._stop_ranges).any())
        if not ahead and next_room.min() >= min(self.clearance, nearest):
            self.shielded = 0
            return twist
        self.shielded += 1
        if ahead and abs(twist.w) > TURNS_AWAY:
            return Twist(0.0, twist.w)
        return self._slide(float(self.fan.angles[int(np.argmin(scan))]), twist, ahead)

    def _slide(self, obstacle: float, twist: Twist, ahead: bool) -> Twist:
        """Drive along what is too near, a little away from it: its bearing and a right angle more."""
        side = math.copysign(1.0, twist.w - math.copysign(1e-9, obstacle))
        bearing = min((obstacle + SLIDE, obstacle - SLIDE), key=lambda b: (abs(b - 0.2 * side), b))
        if abs(bearing) > 0.1 or ahead:
            rate = min(self.body.max_turn_rate, abs(bearing) / self.period)
            return Twist(0.0, math.copysign(rate, bearing))
        return Twist(0.5 * twist.v, bearing / self.period)

    def _aim(self, pose: Pose) -> tuple[float, float]:
        """The point of the way that lies a lookahead beyond the robot's foot point on it."""
        x, y = pose.x, pose.y
        while True:
            (ax, ay), (bx, by) = self.way[self.leg], self.way[self.leg + 1]
            dx, dy = bx - ax, by - ay
            length = math.hypot(dx, dy)
            along = 0.0 if length < 1e-9 else ((x - ax) * dx + (y - ay) * dy) / length
            if along < length - 0.02 or self.leg == len(self.way) - 2:
                break
            self.leg += 1
        ahead = max(along, 0.0) + self.lookahead
        for (ax, ay), (bx, by) in zip(self.way[self.leg :], self.way[self.leg + 1 :], strict=False):
            length = math.dist((ax, ay), (bx, by))
            if ahead <= length:
                return ax + (bx - ax) * ahead / length, ay + (by - ay) * ahead / length
            ahead -= length
        return self.way[-1]


def _corridor(angles: FloatArray, half_width: float, depth: float) -> FloatArray:
    """Range at which each beam leaves a rectangle straight ahead, (n_beams,) [m]; 0 outside of +-90."""
    with np.errstate(divide="ignore"):
        ahead = np.where(
            elementary.cosines(angles) > 0.05, depth / np.maximum(elementary.cosines(angles), 0.05), 0.0
        )
        aside = half_width / np.maximum(np.abs(elementary.sines(angles)), 1e-9)
    return np.asarray(np.minimum(ahead, aside))
