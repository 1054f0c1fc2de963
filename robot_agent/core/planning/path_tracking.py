"""Driving along a way at constant speed: pure pursuit, and a shield against what appears late.

Pure pursuit (Coulter 1992) aims at a point `lookahead` further along the way; the curvature that leads
there is 2 sin(alpha) / lookahead. The speed is the leader's constant speed; it drops only where the
turn rate could not follow, or where the next step would come closer to an obstacle than is allowed.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose, Twist, to_local, wrap_angle
from onehop.contracts.sections import RobotSection

FULL_SPEED_BELOW = 0.6
"""Bearing of the aim up to which the leader keeps its speed [rad]."""

TURN_IN_PLACE_ABOVE = 1.3
"""Bearing of the aim from which it only turns [rad]."""

Point = tuple[float, float]

SHORTEST = 8.0
"""The aim comes closer, down to this part of the lookahead, while the way to it is not clear."""

ALIGNED = 0.02
"""Bearing of the aim from which turning does not help [rad]."""


class PathTracker:
    """Follows one way after the other. period: of a tick [s]. clearance: to keep from obstacles [m].

    A step that would not keep it is not taken. The robot turns to its aim instead, and to the same aim
    until it can go on: another look from another heading may suggest another one, and back again.
    shielded: ticks in a row in which it faced the aim and still could not go on.
    """

    def __init__(self, body: RobotSection, fan: Beams, period: float, clearance: float) -> None:
        self.body = body
        self.fan = fan
        self.period = period
        self.clearance = clearance
        self.lookahead = max(0.4 * body.leader_speed, body.leader_speed / body.max_turn_rate)
        self.way: list[Point] = []
        self.leg = 0
        self.shielded = 0
        self.turning = 0
        self._held: Point | None = None
        self._caution = clearance + max(self.lookahead, 2.0 * body.leader_speed * period)

    def follow(self, way: FloatArray) -> None:
        """Take a new way, (n, 2) [m], map frame, from where the robot is."""
        self.way = [(float(x), float(y)) for x, y in way]
        self.leg = 0
        self.turning = 0
        self._held = None

    def drive(self, pose: Pose, scan: Ranges) -> Twist:
        """The twist for this tick on the way; standstill at its end."""
        if len(self.way) < 2:
            return Twist(0.0, 0.0)
        near = self._near(scan)
        aim = self._held or self._clear_aim(pose, near)
        x, y = to_local(pose, *aim)
        bearing = elementary.atan2(y, x)
        twist = self.towards(bearing, math.hypot(x, y))
        if self._keeps(near, twist):
            self.shielded, self._held = 0, None
            return twist
        self._held = aim
        if abs(bearing) < ALIGNED:
            self.shielded += 1
            return Twist(0.0, 0.0)
        return self._turn(bearing)

    def towards(self, bearing: float, distance: float) -> Twist:
        """Twist that leads to a point nearby, as the robot sees it [rad, m], by pure pursuit."""
        if distance < 1e-6:
            return Twist(0.0, 0.0)
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

    def _near(self, scan: Ranges) -> FloatArray:
        """Hits that matter to the next piece of the way, (n, 2) [m], as the robot sees them."""
        seen = np.flatnonzero(scan <= self._caution)
        return np.asarray(self.fan.directions[seen] * scan[seen, None].astype(np.float64))

    def _clear_aim(self, pose: Pose, near: FloatArray) -> Point:
        """The furthest aim to which the straight way is clear.

        A straight cut across a corner of the way may come closer to an obstacle than the way does; the
        nearer the aim, the less is cut.
        """
        lookahead = self.lookahead
        while True:
            aim = self._aim(pose, lookahead)
            if lookahead <= self.lookahead / SHORTEST or self._clear(near, *to_local(pose, *aim)):
                return aim
            lookahead *= 0.5

    def _clear(self, near: FloatArray, x: float, y: float) -> bool:
        """Does the straight way to a point keep the clearance, or what the robot has of it?"""
        if not len(near):
            return True
        length2 = max(x * x + y * y, 1e-12)
        share = np.clip((near[:, 0] * x + near[:, 1] * y) / length2, 0.0, 1.0)
        dx, dy = near[:, 0] - share * x, near[:, 1] - share * y
        return bool((dx * dx + dy * dy).min() >= self._least2(near))

    def _keeps(self, near: FloatArray, twist: Twist) -> bool:
        """Does the next step keep the clearance, or what the robot has of it?"""
        if not len(near) or twist.v <= 0.0:
            return True
        step, turn = twist.v * self.period, 0.5 * twist.w * self.period
        dx = near[:, 0] - step * elementary.cos(turn)
        dy = near[:, 1] - step * elementary.sin(turn)
        return bool((dx * dx + dy * dy).min() >= self._least2(near))

    def _least2(self, near: FloatArray) -> float:
        """Least squared distance to keep [m2]: the clearance, or what there is of it."""
        have2 = float((near[:, 0] * near[:, 0] + near[:, 1] * near[:, 1]).min())
        return min(self.clearance * self.clearance, have2 - 1e-9)

    def _aim(self, pose: Pose, lookahead: float) -> Point:
        """The point of the way that lies `lookahead` beyond the robot's foot point on it."""
        x, y = pose.x, pose.y
        while True:
            (ax, ay), (bx, by) = self.way[self.leg], self.way[self.leg + 1]
            dx, dy = bx - ax, by - ay
            length = math.hypot(dx, dy)
            along = 0.0 if length < 1e-9 else ((x - ax) * dx + (y - ay) * dy) / length
            if along < length - 0.02 or self.leg == len(self.way) - 2:
                break
            self.leg += 1
        ahead = max(along, 0.0) + lookahead
        for (ax, ay), (bx, by) in zip(self.way[self.leg :], self.way[self.leg + 1 :], strict=False):
            length = math.dist((ax, ay), (bx, by))
            if ahead <= length:
                return ax + (bx - ax) * ahead / length, ay + (by - ay) * ahead / length
            ahead -= length
        return self.way[-1]
