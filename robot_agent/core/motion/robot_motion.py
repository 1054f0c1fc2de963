"""All that moves one robot, and the one list of what may change a twist on its way to the wheels.

A leader (`RobotMotion.lead`):

L1. While the team gathers it only turns to the goal, and at the end of its way it stands (leader.py): L3
    to L5 have no part in that.
L2. Way-finding (planning/) gives the twist. Its path tracking has a shield of its own: a step that would
    come too near to an obstacle is not taken, because only the planner knows another way. Followers are
    removed from what it sees, so what knows of them comes after it. Of these the first that has a say
    decides:
L3. Lane (lane.py): while a follower stands right before a leader that has asked for room, only the turn
    remains. Before L4, so that waiting for room does not count as a jam.
L4. Jam (jam.py): a leader that gets nowhere among its followers steers around them. Before L5, because
    who slows down in a jam stays in it.
L5. Stragglers (leader.py): the same arc, slower, if the scenario or the gain policy says so.

A follower (`RobotMotion.follow`), where the first that applies decides:

F1. Without a leader, and at the end of the mission, it stands.
F2. Lane (lane.py): told to make room it draws aside, whatever its slot.
F3. Slot (follower.py): tracking in the open (tracking.py), otherwise around what is in the way, along
    the leader's trail, or out of a jam (detour.py, trail_pursuit.py, jam.py).

Then both:

B1. Safety (safety.py) has the last word: nobody drives into what its laser sees. It only takes speed
    away. Nothing may come after it that turns the robot otherwise or adds speed.
B2. The body: every stage before keeps to what it can turn and drive, because only the stage knows
    whether to slow down or to bend the arc for it. The motors cut off the rest (world_server, World).
"""

import numpy as np

from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from robot_agent.core.motion.detour import SlotTask
from robot_agent.core.motion.follower import FollowerMotion
from robot_agent.core.motion.leader import LeaderDecision, LeaderMotion, PathfinderMaker, TeamView
from robot_agent.core.motion.safety import SafetyFilter
from robot_agent.core.motion.tracking import sampled
from robot_agent.core.motion.trail import Trail

DRAWS = 64
"""Random numbers for a follower's jams, used in turn. They only break ties between robots, so that it
does not matter when they come round again."""


class RobotMotion:
    """Moves one robot, whichever part it plays: `lead` or `follow`, once a tick."""

    def __init__(
        self, briefing: Briefing, make_pathfinder: PathfinderMaker, rng: np.random.Generator
    ) -> None:
        body, period = briefing.body, briefing.period_ns / 1e9
        beams = Beams(body)
        gains = sampled(briefing.gains, period)
        draws = tuple(float(share) for share in rng.random(DRAWS))
        self._follower = FollowerMotion(body, gains, beams, period, draws)
        self._leader = LeaderMotion(briefing, gains, beams, make_pathfinder, rng)
        self._safety = SafetyFilter(body, beams, period)
        self._followers_back_up = gains.reverse

    def begin_part(self) -> None:
        """The robot leads or follows from now on, and did the other before."""
        self._leader.begin()
        self._follower.reset()

    @property
    def trail(self) -> Trail:
        """The way that this robot came while it led."""
        return self._leader.trail

    @property
    def border(self) -> bool:
        """Whether this robot, as a follower, goes along the border of an obstacle."""
        return self._follower.detour.border

    def lead(
        self, pose: Pose, scan: Ranges, nearest: float, team: TeamView
    ) -> tuple[Twist, LeaderDecision]:
        """A leader's twist for this tick, and what it wants of its team. nearest: least range [m]."""
        leader = self._leader
        decision = leader.decide(pose, scan, team)
        twist = decision.planned
        if decision.waypoint is not None:
            twist = (
                leader.lane.held_back(twist)
                or leader.jam.around(pose, scan, nearest, decision.waypoint)
                or leader.slowed_for_stragglers(twist, team, decision.column)
                or twist
            )
        return self._safety.filtered(twist, scan, nearest), decision

    def follow(self, pose: Pose, scan: Ranges, nearest: float, task: SlotTask | None) -> Twist:
        """A follower's twist for this tick. task: None to stand. nearest: least range [m]."""
        if task is None:
            twist = STANDSTILL
        elif task.lane:
            twist = self._follower.draw_aside(pose, scan, task.lane)
        else:
            twist = self._follower.to_slot(pose, scan, nearest, task)
        return self._safety.filtered(twist, scan, nearest, self._followers_back_up)
