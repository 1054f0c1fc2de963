"""How a follower drives: tracking its slot in the open, or around what is in the way (detour.py).

Differs: a slot behind the robot is turned to on the spot first, not driven to backwards (thesis eq. 3.9,
3.10), because the laser does not look back. With gains.reverse = true it is driven to backwards where
the robot saw a moment ago that the way is free (rear_view.py).
"""

import math
from collections.abc import Sequence

from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, wrap_angle
from onehop.contracts.sections import GainsSection, RobotSection
from robot_agent.core.motion.detour import Detour, SlotTask
from robot_agent.core.motion.free_directions import LOOKAHEAD
from robot_agent.core.motion.lane import draw_aside
from robot_agent.core.motion.rear_view import RearView
from robot_agent.core.motion.steering import TURN_IN_PLACE, Steering, stoppable
from robot_agent.core.motion.tracking import PolarError, polar_error, polar_twist, within_limits

RESTING = 0.08
"""Below this distance only the heading is put right [m]."""

HEADING_TOLERANCE = 0.05
"""Up to this difference to the slot's heading a resting robot stands still [rad]."""

BEYOND_SLOT = 0.5
"""Obstacles this far beyond the slot are not in the way to it [m]: hull and clearance of the robot."""


class FollowerMotion:
    """Drives one robot to its slot. One instance for the life of a robot."""

    def __init__(
        self,
        body: RobotSection,
        gains: GainsSection,
        beams: Beams,
        period: float,
        draws: Sequence[float],
    ) -> None:
        """period: of a tick [s]. draws: random shares in [0, 1) for getting out of jams."""
        self._body = body
        self._gains = gains
        self._steering = Steering(body, gains, beams)
        self._rear = RearView(body, beams, period)
        self.detour = Detour(body, self._steering, period, draws)

    def reset(self) -> None:
        """Forget the obstacle in the way: the robot has another part now."""
        self.detour.reset()

    def draw_aside(self, pose: Pose, scan: Ranges, lane: Sequence[tuple[float, float]]) -> Twist:
        """Twist for this tick while the leader wants a lane kept clear."""
        self.reset()
        return draw_aside(self._steering, pose, scan, lane)

    def to_slot(self, pose: Pose, scan: Ranges, nearest: float, task: SlotTask) -> Twist:
        """Twist for this tick towards the slot. nearest: least range in scan [m]."""
        if self._gains.reverse:
            self._rear.see(pose, scan)
        error = polar_error(pose, task.slot)
        distance = error.rho
        bearing = wrap_angle(error.alpha + math.pi) if error.reverse else error.alpha
        if distance < RESTING:
            self.reset()
            turn = wrap_angle(task.slot.heading - pose.heading)
            return self._steering.turn(turn) if abs(turn) > HEADING_TOLERANCE else STANDSTILL
        detour = self.detour
        detour.watch_trail(pose, scan, task.trail)
        if not detour.border and nearest > min(LOOKAHEAD, distance + BEYOND_SLOT):
            return self._track(pose, error, bearing, task, LOOKAHEAD)
        held = detour.held(pose)
        if held is not None:
            return held
        free = detour.free_way(scan, distance, bearing)
        if free is not None:
            return self._track(pose, error, bearing, task, free)
        return detour.step(pose, distance, bearing, task)

    def _track(
        self, pose: Pose, error: PolarError, bearing: float, task: SlotTask, free: float
    ) -> Twist:
        """The way to the slot is clear for `free` metres: thesis eq. 3.11, 3.12."""
        self.detour.tracks()
        body, gains, k_rho = self._body, self._gains, task.k_rho
        backs_up = error.reverse and gains.reverse
        if backs_up and self._rear.free(pose, task.slot.x, task.slot.y):
            return within_limits(polar_twist(error, gains, k_rho, body.max_speed), body)
        if abs(bearing) > TURN_IN_PLACE:
            return self._steering.turn(bearing)
        speed = stoppable(body.max_speed, free)
        return within_limits(polar_twist(error, gains, k_rho, speed), body)
