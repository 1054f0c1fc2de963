"""How a follower drives: tracking its slot in the open, along borders when something is in the way.

In the open the thesis's controller (tracking.py) drives. When the straight way to the slot is blocked
for a while the robot follows the border, and where it sees points of the leader's trail it heads for the
newest of those: the leader came through there, so a way exists. It resumes the slot when the straight
way is clear again (thesis 3.3.4: back in direct range).

Differs: the thesis only names border following; the trail makes it end behind corners where the slot
lies inside a wall for a long time.
Differs: a slot behind the robot is turned to on the spot first, not driven to backwards (thesis eq. 3.9,
3.10), because the laser does not look back; gains.reverse = true gives the thesis's way.
"""

import math
from collections.abc import Sequence

from onehop.contracts import elementary
from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, wrap_angle
from onehop.contracts.sections import GainsSection, RobotSection
from robot_agent.core.motion.lane import DrawAside
from robot_agent.core.motion.pursuit import Pursuit
from robot_agent.core.motion.steering import LOOKAHEAD, Steering
from robot_agent.core.motion.tracking import (
    PolarError,
    polar_error,
    polar_twist,
    turn_towards,
    within_limits,
)

IN_POSITION = 0.3
"""A robot is in its slot within this distance [m]."""

RESTING = 0.08
"""Below this distance only the heading is put right [m]."""

FACING = 1.2
"""A target at a greater bearing is turned to on the spot [rad]."""

BLOCKED_TICKS, CLEAR_TICKS = 10, 4
"""Ticks in a row after which an obstacle counts as in the way, and as passed: no flutter of modes."""

WATCH_TICKS = 10
"""Ticks from one look for the leader's trail to the next while the way is clear."""

REACTION = 0.4
"""A robot drives at most as fast as lets it stop within this time before what it sees [s]."""

STUCK_TICKS = 20
"""Decisions, one in two ticks, without getting anywhere after which a robot backs out of a jam."""

GETTING_ANYWHERE = 0.004
"""A robot that moved less between two decisions is getting nowhere [m]: 4 cm/s, or it only turns."""


class Follower:
    """Drives one robot to its slot. One instance for the life of a robot."""

    def __init__(
        self, body: RobotSection, gains: GainsSection, fan: Beams, dodge: Sequence[float]
    ) -> None:
        """dodge: random shares in [0, 1) that break symmetric jams, used in turn."""
        self._body = body
        self._gains = gains
        self._steering = Steering(body, fan)
        self._pursuit = Pursuit(self._steering)
        self._aside = DrawAside(body, gains, self._steering)
        self._dodge = dodge
        self._dodges = 0
        self._blocked = 0
        self._clear_for = 0
        self._idle = 0
        self._stood_at = (0.0, 0.0)
        self._side = 0
        self._escape = 0
        self._escape_side = 1
        self._age = 0
        self._held: tuple[float, float] | None = None
        self.border = False

    def halt(self) -> None:
        """Forget the obstacle in the way: the robot has another part now."""
        self.border, self._blocked, self._idle, self._side, self._escape = False, 0, 0, 0, 0

    def draw_aside(self, pose: Pose, scan: Ranges, lane: Sequence[tuple[float, float]]) -> Twist:
        """Twist for this tick while the leader wants a lane kept clear."""
        self.halt()
        return self._aside.step(pose, scan, lane)

    def step(
        self,
        pose: Pose,
        scan: Ranges,
        nearest: float,
        target: Pose,
        trail: Sequence[tuple[float, float]],
        standoff: float,
        leader_moves: bool,
        k_rho: float,
    ) -> Twist:
        """Twist for this tick. nearest: least range; trail: leader's way, oldest first [m].

        standoff: distance to keep from the leader while the slot cannot be reached [m],
        while leader_moves; a leader that stands is not waited for.
        """
        error = polar_error(pose, target)
        rho = error.rho
        bearing = wrap_angle(error.alpha + math.pi) if error.reverse else error.alpha
        if rho < RESTING:
            self.halt()
            turn = wrap_angle(target.heading - pose.heading)
            return turn_towards(turn, self._gains, self._body) if abs(turn) > 0.05 else STANDSTILL
        self._age += 1
        if self._age % WATCH_TICKS == 0:
            self._steering.look(scan)
            self._pursuit.watch(pose, trail)
        if not self.border and nearest > min(LOOKAHEAD, rho + 0.5):
            return self._track(error, bearing, k_rho, LOOKAHEAD)
        if self._held is not None:
            course, speed = self._held
            self._held = None
            return self._steer(wrap_angle(course - pose.heading), speed)
        steering = self._steering
        steering.look(scan)
        if abs(bearing) > FACING:
            if not self.border:
                return self._track(error, bearing, k_rho, LOOKAHEAD)
        elif (free := steering.free_distance(bearing)) >= min(rho, LOOKAHEAD) and (
            not self.border or steering.sees(bearing, rho)
        ):
            self._clear()
            if not self.border:
                return self._track(error, bearing, k_rho, free)
        else:
            self._clear_for = 0
            self._blocked += 1
            self.border = self.border or self._blocked >= BLOCKED_TICKS
        return self._detour(pose, rho, bearing, trail, standoff, leader_moves, k_rho)

    def _clear(self) -> None:
        self._blocked = 0
        self._clear_for += 1
        if self._clear_for >= CLEAR_TICKS:
            self.border, self._side = False, 0

    def _track(self, error: PolarError, bearing: float, k_rho: float, free: float) -> Twist:
        """The way to the slot is clear: thesis eq. 3.11, 3.12."""
        self._idle = 0
        if error.reverse and self._gains.reverse:
            return within_limits(
                polar_twist(error, self._gains, k_rho, self._body.max_speed), self._body
            )
        if abs(bearing) > FACING:
            return turn_towards(bearing, self._gains, self._body)
        speed = min(self._body.max_speed, max(0.0, free) / REACTION)
        return within_limits(polar_twist(error, self._gains, k_rho, speed), self._body)

    def _detour(
        self,
        pose: Pose,
        rho: float,
        bearing: float,
        trail: Sequence[tuple[float, float]],
        standoff: float,
        leader_moves: bool,
        k_rho: float,
    ) -> Twist:
        """Something is in the way: around it, or along its border."""
        distance = pace = rho
        side = 0
        aim = self._pursuit.aim(pose, trail) if self.border else None
        if aim is None:
            side = self._side if self.border else 0
        elif aim.last and aim.distance <= standoff:
            if leader_moves:
                return turn_towards(bearing, self._gains, self._body)
            side = self._side
        else:
            distance, bearing = aim.distance, aim.bearing
            pace = distance - standoff if aim.last else rho
            side = 0 if aim.known else self._side
        if self._escape:
            return self._escaped()
        if abs(bearing) > FACING:
            return turn_towards(bearing, self._gains, self._body)
        choice = self._steering.choose(bearing, distance, side)
        if choice is None:
            self._stuck()
            return Twist(0.0, self._escape_side * 0.6 * self._body.max_turn_rate)
        direction, free = choice
        if self.border and self._side == 0:
            self._side = 1 if direction >= bearing else -1
        speed = min(k_rho * pace, self._body.max_speed, max(0.0, free) / REACTION)
        here = (pose.x, pose.y)
        if math.dist(here, self._stood_at) < GETTING_ANYWHERE:
            self._stuck()
        else:
            self._idle = max(0, self._idle - 2)
        self._stood_at = here
        self._held = pose.heading + direction, speed
        return self._steer(direction, speed)

    def _steer(self, direction: float, speed: float) -> Twist:
        """Drive in a direction, slowly while it is still turned to."""
        facing = max(0.0, elementary.cos(direction))
        return Twist(speed * facing * facing, turn_towards(direction, self._gains, self._body).w)

    def _stuck(self) -> None:
        self._idle += 1
        if self._idle >= STUCK_TICKS:
            share = self._dodge[self._dodges % len(self._dodge)]
            self._dodges += 1
            self._escape = 10 + int(40 * share)
            self._escape_side = 1 if share < 0.5 else -1
            self._idle = 0

    def _escaped(self) -> Twist:
        """Leave a jam: towards where there is most room, for a random while."""
        self._escape -= 1
        choice = self._steering.choose(self._escape_side * 1.2, LOOKAHEAD / 3.0, 0)
        if choice is None:
            return Twist(0.0, self._escape_side * 0.6 * self._body.max_turn_rate)
        direction, free = choice
        return self._steer(direction, min(0.6, max(0.0, free) / REACTION))
