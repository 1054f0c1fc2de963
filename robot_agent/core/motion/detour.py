"""A follower's way around what lies between it and its slot: past it, or along its border.

When the straight way to the slot is blocked for a while the robot follows the border, and where it sees
points of the leader's trail it heads for the newest of those: the leader came through there, so a way
exists. It resumes the slot when the straight way is clear again (thesis 3.3.4: back in direct range).
Border following is that of DistBug (Kamon and Rivlin 1997): turn to one side, keep the obstacle on the
other, and leave it when the way to the target is free.

Differs: the thesis only names border following; the trail makes it end behind corners where the slot
lies inside a wall for a long time.
"""

import math
from collections.abc import Sequence

from onehop.contracts.arrays import Ranges
from onehop.contracts.geometry import Pose, Twist, wrap_angle
from onehop.contracts.sections import RobotSection
from onehop.contracts.values import Value
from robot_agent.core.motion.free_directions import LOOKAHEAD
from robot_agent.core.motion.jam import FollowerJam
from robot_agent.core.motion.steering import TURN_IN_PLACE, Steering, stoppable
from robot_agent.core.motion.timing import in_ticks
from robot_agent.core.motion.trail import Point
from robot_agent.core.motion.trail_pursuit import TrailPursuit

HOLD = 0.1
"""A course around an obstacle is held for this time, then decided anew [s]: half the work, and nothing
moves farther than 0.3 m meanwhile. One that is turned to on the spot is held until the robot faces it:
what it sees and heads for changes while it turns, and it would turn to and fro."""

FACED = 0.3
"""A direction less than this aside is faced [rad]: the robot drives in it at nine tenths of its
speed."""

BLOCKED_AFTER, CLEAR_AFTER = 1.0, 0.4
"""Time after which an obstacle counts as in the way, and as passed [s]: no flutter of modes."""

WATCH_EVERY = 0.5
"""Time from one look for the leader's trail to the next while the way is clear [s]."""


class SlotTask(Value, frozen=True):
    """Where a follower shall be, and what its leader told of the way there. Map frame, SI units.

    slot: pose to take. trail: the leader's way, oldest first. standoff: distance to keep from the leader
    while the slot cannot be reached and the leader moves; a leader that stands is not waited for.
    k_rho: gain of the speed [1/s]. lane: two ends of what is to be kept clear; empty: nothing.
    """

    slot: Pose
    trail: Sequence[Point]
    standoff: float
    leader_moves: bool
    k_rho: float
    lane: Sequence[Point] = ()


class Course(Value, frozen=True):
    """What is headed for, as the robot sees it.

    bearing [rad], distance [m]: of the point. left: way that remains [m]. side: on which obstacles are
    passed, see FreeDirections.choose.
    """

    bearing: float
    distance: float
    left: float
    side: int


class Detour:
    """One robot's way around obstacles. border: whether it follows one."""

    def __init__(
        self, body: RobotSection, steering: Steering, period: float, draws: Sequence[float]
    ) -> None:
        """period: of a tick [s]. draws: random shares in [0, 1) for getting out of jams."""
        self._max_speed = body.max_speed
        self._most_turned = body.max_turn_rate * period  # rad a tick
        self._steering = steering
        self._pursuit = TrailPursuit(steering.free, period)
        self._jam = FollowerJam(body, steering, period, draws)
        self._hold = in_ticks(HOLD, period)
        self._blocked_after = in_ticks(BLOCKED_AFTER, period)
        self._clear_after = in_ticks(CLEAR_AFTER, period)
        self._watch_every = in_ticks(WATCH_EVERY, period)
        self._age = self._looked_at = self._since_look = 0  # ticks
        self._blocked_for = self._clear_for = 0
        self._side = 0
        self._held: tuple[float, float] | None = None
        self._held_for = 0
        self.border = False

    def reset(self) -> None:
        """Forget the obstacle in the way."""
        self.border, self._blocked_for, self._side, self._held = False, 0, 0, None
        self._jam.reset()

    def watch_trail(self, pose: Pose, scan: Ranges, trail: Sequence[Point]) -> None:
        """Once a tick: remember where the leader's trail is in sight, now and then."""
        self._age += 1
        if self._age % self._watch_every == 0:
            self._steering.free.look(scan)
            self._pursuit.watch(pose, trail)

    def tracks(self) -> None:
        """The robot tracks its slot at this tick."""
        self._looked_at, self._held = self._age, None
        self._jam.clear()

    def held(self, pose: Pose) -> Twist | None:
        """The course that was decided before, while it is held."""
        if self._held is None:
            return None
        heading, speed = self._held
        self._held_for -= 1
        if self._held_for <= 0:
            self._held = None
        return self._steering.drive(wrap_angle(heading - pose.heading), speed)

    def free_way(self, scan: Ranges, distance: float, bearing: float) -> float | None:
        """How far the straight way to the slot is clear [m]; None while something is to be gone around.

        distance, bearing: of the slot [m, rad]. A slot abeam or behind is turned to first.
        """
        free_directions = self._steering.free
        free_directions.look(scan)
        self._since_look, self._looked_at = self._age - self._looked_at, self._age
        if abs(bearing) > TURN_IN_PLACE:
            return None if self.border else LOOKAHEAD
        free = free_directions.free_distance(bearing)
        seen = not self.border or free_directions.sees(bearing, distance)
        if free >= min(distance, LOOKAHEAD) and seen:
            self._blocked_for = 0
            self._clear_for += self._since_look
            if self._clear_for >= self._clear_after:
                self.border, self._side = False, 0
            return None if self.border else free
        self._clear_for = 0
        self._blocked_for += self._since_look
        self.border = self.border or self._blocked_for >= self._blocked_after
        return None

    def step(self, pose: Pose, distance: float, bearing: float, task: SlotTask) -> Twist:
        """Around the obstacle, or along its border. distance, bearing: of the slot [m, rad]."""
        course = self._course(pose, distance, bearing, task)
        if course is None:
            self._jam.clear()
            return self._steering.turn(bearing)
        if self._jam.escaping:
            return self._jam.escape()
        self._jam.moved((pose.x, pose.y), self._age)
        if abs(course.bearing) > TURN_IN_PLACE:
            return self._hold_course(pose, course.bearing, 0.0)
        choice = self._steering.free.choose(course.bearing, course.distance, course.side)
        if choice is None:
            return self._jam.turned()
        direction, free = choice
        if self.border and self._side == 0:
            self._side = 1 if direction >= course.bearing else -1
        speed = stoppable(min(task.k_rho * course.left, self._max_speed), free)
        return self._hold_course(pose, direction, speed)

    def _hold_course(self, pose: Pose, direction: float, speed: float) -> Twist:
        """Take a direction [rad] for a while: at this speed [m/s], or until the robot faces it."""
        hold = self._hold
        if abs(direction) > TURN_IN_PLACE:
            hold = max(hold, math.ceil((abs(direction) - FACED) / self._most_turned))
        if hold > 1:
            self._held, self._held_for = (pose.heading + direction, speed), hold - 1
        return self._steering.drive(direction, speed)

    def _course(self, pose: Pose, distance: float, bearing: float, task: SlotTask) -> Course | None:
        """The slot, or a point of the leader's trail; None to wait for the leader to move on."""
        point = self._pursuit.point(pose, task.trail, self._since_look) if self.border else None
        if point is None:
            return Course(bearing, distance, distance, self._side)
        if point.newest and point.distance <= task.standoff:
            return None if task.leader_moves else Course(bearing, distance, distance, self._side)
        left = point.distance - task.standoff if point.newest else distance
        return Course(point.bearing, point.distance, left, 0 if point.known else self._side)
