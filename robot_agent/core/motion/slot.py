"""Where a follower belongs, and whether it has come to rest there (thesis 3.3, 3.5)."""

import math

from onehop.contracts.geometry import Pose, to_map
from onehop.contracts.sections import TeamSection
from robot_agent.core.motion.trail import behind
from robot_agent.core.team.formation import Formation, formation
from robot_agent.core.team.leader_view import LeaderView
from robot_agent.core.team.part import Joining
from robot_agent.core.team.state import TeamState

IN_POSITION = 0.3
"""A robot is in its slot within this distance [m]."""

SETTLED_AFTER = 5.0
"""Time without coming nearer to its slot after which a robot has come as near as it can [s]."""

NEARER = 0.05
"""Coming nearer by less than this is not coming nearer [m]."""


class SlotFinder:
    """Shape and slot of one robot; kept until roster, order or the leader's last pose changes."""

    def __init__(self, team: TeamSection) -> None:
        self._team = team
        self._shape_key: tuple[tuple[int, ...], bool] | None = None
        self._shape = formation((1,))
        self._slot_key: tuple[Pose, tuple[int, ...], bool, bool] | None = None
        self._slot = Pose(0.0, 0.0, 0.0)
        self._others_key: tuple[Pose, tuple[int, ...], bool] | None = None
        self._others: tuple[tuple[float, float], ...] = ()

    def shape(self, state: TeamState) -> Formation:
        """The formation of the roster in force, a column in a narrow passage."""
        key = state.roster.members, state.narrow
        if key != self._shape_key:
            spacing = self._team.narrow_spacing if state.narrow else self._team.spacing
            self._shape_key, self._shape = key, formation(*key, spacing)
        return self._shape

    def slot(self, state: TeamState, view: LeaderView, leader: Pose) -> Pose:
        """The slot of this robot in the map frame, from the leader's last pose."""
        key = leader, state.roster.members, state.narrow, isinstance(state.part, Joining)
        if key != self._slot_key:
            self._slot_key, self._slot = key, self._placed(state, view, leader)
        return self._slot

    def others(self, state: TeamState, leader: Pose) -> tuple[tuple[float, float], ...]:
        """The leader, and where the other followers belong by its last pose, map frame [m]."""
        key = leader, state.roster.members, state.narrow
        if key != self._others_key:
            slots = [one for one in self.shape(state).slots if one.robot != state.robot]
            places = [to_map(leader, slot.x, slot.y) for slot in slots]
            self._others_key, self._others = key, ((leader.x, leader.y), *places)
        return self._others

    def distance(self, state: TeamState) -> float:
        """How far from the leader the slot of this robot lies [m]."""
        shape = self.shape(state)
        if isinstance(state.part, Joining) or shape.leader == state.robot:
            return self._team.spacing
        slot = shape.slot(state.robot)
        return math.hypot(slot.x, slot.y)

    def _placed(self, state: TeamState, view: LeaderView, leader: Pose) -> Pose:
        """Who has no slot in the formation (it joins, or led until now) keeps a spacing behind."""
        shape = self.shape(state)
        if isinstance(state.part, Joining) or shape.leader == state.robot:
            x, y = to_map(leader, -self._team.spacing, 0.0)
        else:
            slot = shape.slot(state.robot)
            if state.narrow and len(view.trail) > 1:
                return behind(leader, view.trail, -slot.x)
            x, y = to_map(leader, slot.x, slot.y)
        return Pose(x, y, leader.heading)


class Settling:
    """Whether a robot is in its slot, or as near to it as it can get."""

    def __init__(self, period: float) -> None:
        """period: of a tick [s]."""
        self._ticks = round(SETTLED_AFTER / period)
        self._slot: Pose | None = None
        self._best = math.inf
        self._idle = 0
        self.error = 0.0

    def watch(self, pose: Pose, slot: Pose, moving: bool) -> None:
        """Take one tick. moving: the team is on its way, and so is every slot."""
        self.error = math.hypot(slot.x - pose.x, slot.y - pose.y)
        if slot != self._slot:
            self._slot, self._best = slot, math.inf
        if moving or self.error < self._best - NEARER:
            self._best, self._idle = self.error, 0
        else:
            self._idle += 1

    @property
    def in_slot(self) -> bool:
        """In its slot (thesis 3.3.3)."""
        return self.error <= IN_POSITION

    @property
    def settled(self) -> bool:
        """No nearer to its slot for long."""
        return self._idle > self._ticks
