"""Driving along a way at constant speed: pure pursuit, and a shield against what appears late.

Pure pursuit (Coulter 1992) aims at a point `lookahead` further along the way; the curvature that leads
there is 2 sin(alpha) / lookahead. The speed is the leader's constant speed; it drops only where the
turn rate could not follow. The shield refuses a step that would come closer to an obstacle than is
allowed: the robot turns to its aim instead, and to the same aim until it can go on, because another look
from another heading may suggest another one, and back again. Where it faces its aim and still may not go
on, it is blocked.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, to_local, wrap_angle
from onehop.contracts.sections import RobotSection
from robot_agent.core.planning.view import NO_POINTS

Point = tuple[float, float]

LOOKAHEAD_S = 0.4
"""Lookahead as driving time [s]; never less than the radius of the tightest turn at full speed."""

SHORTEST_LOOKAHEAD = 1.0 / 8.0
"""The aim comes closer, down to this part of the lookahead, while the way to it is not clear."""

FULL_SPEED_BELOW = 0.6
"""Bearing of the aim up to which the leader keeps its speed [rad]."""

TURN_IN_PLACE_ABOVE = 1.3
"""Bearing of the aim from which it only turns [rad]."""

ALIGNED = 0.02
"""A bearing below this is faced, and turning further does not help [rad]: 8 mm aside at 0.4 m."""

NEAREST_AIM = 0.1
"""The curvature is that to an aim at least this far away [m]; nearer ones would make the robot swing."""

TURNED_BACK = 0.5
"""A way whose aim is this near to the robot, in lookaheads, has turned back by more than 120 degrees."""

LEG_DONE = 0.02
"""Rest of a leg of the way at which the next one begins [m]."""

CAUTION_STEPS = 2.0
"""Steps at full speed beyond the clearance within which hits are looked at; the next step is one."""


class PathTracker:
    """Does what it was told last: follows a way, or turns in place to a heading.

    period_ns: of a tick. clearance: to keep from obstacles [m]. turns_back: ways may turn back sharply;
    those that a planner draws anew every few metres do not. way: (n, 2) followed now [m], map frame;
    empty while it turns. heading: turned to now [rad], or None. waypoint: end of the last way [m].
    blocked_ns: for how long it faced its aim and could not go on.
    """

    def __init__(
        self,
        body: RobotSection,
        beams: Beams,
        period_ns: int,
        clearance: float,
        pose: Pose,
        turns_back: bool = False,
    ) -> None:
        self.body = body
        self.beams = beams
        self.period_ns = period_ns
        self.period = period_ns * 1e-9
        self.clearance = clearance
        self._turns_back = turns_back
        self.lookahead = max(LOOKAHEAD_S * body.leader_speed, body.leader_speed / body.max_turn_rate)
        self.way: FloatArray = NO_POINTS
        self.heading: float | None = None
        self.waypoint: Point = (pose.x, pose.y)
        self.blocked_ns = 0
        self._points: list[Point] = []
        self._leg = 0
        self._side = 0
        self._held: Point | None = None
        step = CAUTION_STEPS * body.leader_speed * self.period
        self._caution = clearance + max(self.lookahead, step)

    def follow(self, way: FloatArray) -> None:
        """Take a new way, (n, 2) [m], map frame, from where the robot is."""
        self.way = way
        self.heading = None
        self._points = [(float(x), float(y)) for x, y in way]
        self.waypoint = self._points[-1]
        self.blocked_ns = self._leg = self._side = 0
        self._held = None

    def face(self, heading: float) -> None:
        """Turn in place to a heading [rad]; a robot that turns already keeps its side."""
        if self.heading is None:
            self._side = 0
        self.heading = wrap_angle(heading)
        self.way = NO_POINTS
        self.blocked_ns = 0

    def stop(self) -> None:
        """Stand still until the next way or heading."""
        self.heading = None
        self.way = NO_POINTS

    def faces(self, pose: Pose, tolerance: float) -> bool:
        """Does it turn to a heading, and is it there within a tolerance [rad]?"""
        return self.heading is not None and abs(wrap_angle(self.heading - pose.heading)) < tolerance

    def ended(self, pose: Pose, tolerance: float) -> bool:
        """Does it follow a way, and is it at its end within a tolerance [m]?"""
        return len(self.way) > 0 and math.dist((pose.x, pose.y), self.waypoint) < tolerance

    def ahead(self, pose: Pose) -> FloatArray:
        """The rest of the way that it follows, from where the robot is, (n, 2) [m]."""
        return np.array(((pose.x, pose.y), *self._points[self._leg + 1 :]))

    def drive(self, pose: Pose, scan: Ranges) -> Twist:
        """The twist for this tick; standstill at the end of a way."""
        if self.heading is not None:
            return self._turn(wrap_angle(self.heading - pose.heading))
        if len(self.way) < 2:
            return STANDSTILL
        near = self._near_hits(scan)
        aim = self._held or self._clear_aim(pose, near)
        x, y = to_local(pose, *aim)
        bearing = elementary.atan2(y, x)
        twist = self._pursue(bearing, math.hypot(x, y))
        if self._keeps(near, twist):
            self.blocked_ns, self._held = 0, None
            return twist
        self._held = aim
        if abs(bearing) < ALIGNED:
            self.blocked_ns += self.period_ns
            return STANDSTILL
        return self._turn(bearing)

    def _pursue(self, bearing: float, distance: float) -> Twist:
        """Twist that leads to a point nearby, as the robot sees it [rad, m], by pure pursuit."""
        if distance < 1e-6:
            return STANDSTILL
        size = abs(bearing)
        if size > TURN_IN_PLACE_ABOVE or (self._side and size > FULL_SPEED_BELOW):
            return self._turn(bearing)
        self._side = 0
        speed = min(self.body.leader_speed, distance / self.period)
        if size > FULL_SPEED_BELOW:
            speed *= (TURN_IN_PLACE_ABOVE - size) / (TURN_IN_PLACE_ABOVE - FULL_SPEED_BELOW)
        w = speed * 2.0 * elementary.sin(bearing) / max(distance, NEAREST_AIM)
        limit = self.body.max_turn_rate
        if abs(w) > limit:
            speed *= limit / abs(w)
            w = math.copysign(limit, w)
        return Twist(speed, w)

    def _turn(self, bearing: float) -> Twist:
        """Turn in place; the side is kept until the turn is done, or two could alternate forever."""
        if not self._side:
            self._side = 1 if bearing >= 0 else -1
        if bearing * self._side < 0 and abs(bearing) < math.pi / 2:
            self._side = -self._side
        rate = min(self.body.max_turn_rate, abs(bearing) / self.period)
        return Twist(0.0, rate * self._side)

    def _near_hits(self, scan: Ranges) -> FloatArray:
        """Hits that matter to the next piece of the way, (n, 2) [m], as the robot sees them."""
        seen = np.flatnonzero(scan <= self._caution)
        return np.asarray(self.beams.directions[seen] * scan[seen, None].astype(np.float64))

    def _clear_aim(self, pose: Pose, near: FloatArray) -> Point:
        """The furthest aim to which the straight way is clear.

        A straight cut across a corner of the way may come closer to an obstacle than the way does; the
        nearer the aim, the less is cut.
        """
        lookahead = self.lookahead
        shortest = SHORTEST_LOOKAHEAD * lookahead
        while True:
            aim = self._aim(pose, lookahead)
            if lookahead <= shortest or self._clear(near, *to_local(pose, *aim)):
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
        """The point of the way that lies `lookahead` beyond the robot's foot point on it.

        Where the way turns back, that point may lie where the robot is: the turn is behind it, and the
        next leg begins.
        """
        aim = self._beyond_foot(pose, lookahead)
        if not self._turns_back:
            return aim
        while aim != self._points[-1] and math.dist(aim, (pose.x, pose.y)) < TURNED_BACK * lookahead:
            self._leg += 1
            aim = self._beyond_foot(pose, lookahead)
        return aim

    def _beyond_foot(self, pose: Pose, lookahead: float) -> Point:
        """The point `lookahead` beyond the foot point; a leg that is done gives way to the next."""
        x, y = pose.x, pose.y
        while True:
            (ax, ay), (bx, by) = self._points[self._leg], self._points[self._leg + 1]
            dx, dy = bx - ax, by - ay
            length = math.hypot(dx, dy)
            along = 0.0 if length < 1e-9 else ((x - ax) * dx + (y - ay) * dy) / length
            if along < length - LEG_DONE or self._leg == len(self._points) - 2:
                break
            self._leg += 1
        ahead = max(along, 0.0) + lookahead
        legs = zip(self._points[self._leg :], self._points[self._leg + 1 :], strict=False)
        for (ax, ay), (bx, by) in legs:
            length = math.dist((ax, ay), (bx, by))
            if ahead <= length:
                return ax + (bx - ax) * ahead / length, ay + (by - ay) * ahead / length
            ahead -= length
        return self._points[-1]
