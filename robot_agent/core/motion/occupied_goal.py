"""A goal that somebody stands on counts as reached from beside it.

Walls keep at least the inflation from a goal (the world refuses any other), so what is seen nearer to it
is something that came there: a leader that was cut off and arrived first, or a robot that was left
there. It may stay for ever.
"""

from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose, to_local
from onehop.contracts.sections import beside_goal
from onehop.contracts.units import nanoseconds

OCCUPIED_WITHIN = 0.9
"""Something this near to the goal stands on it, in inflations: no wall does."""

OCCUPIED_S = 1.0
"""Time for which it must stand there, so that who only passes by does not count [s]."""


class OccupiedGoal:
    """Watches the goal from one leader that comes near."""

    def __init__(self, briefing: Briefing, beams: Beams) -> None:
        self._goal = briefing.goal
        self._beams = beams
        self._beside = beside_goal(briefing.goal, briefing.body, briefing.planner)
        self._within = OCCUPIED_WITHIN * briefing.planner.inflation
        self._period_ns = briefing.period_ns
        self._occupied_ns = 0

    def reached(self, pose: Pose, scan: Ranges) -> bool:
        """Whether the leader stands beside a goal that is occupied; asked at every tick."""
        ahead, left = to_local(pose, self._goal.x, self._goal.y)
        near = ahead * ahead + left * left <= self._beside * self._beside
        if not near or not self._is_hit(ahead, left, scan):
            self._occupied_ns = 0
            return False
        self._occupied_ns += self._period_ns
        return self._occupied_ns >= nanoseconds(OCCUPIED_S)

    def _is_hit(self, ahead: float, left: float, scan: Ranges) -> bool:
        """Whether a beam hits something on the goal, which lies there in the robot's frame [m]."""
        seen = scan <= self._beams.range
        off_x = self._beams.directions[seen, 0] * scan[seen] - ahead
        off_y = self._beams.directions[seen, 1] * scan[seen] - left
        return bool((off_x * off_x + off_y * off_y < self._within * self._within).any())
