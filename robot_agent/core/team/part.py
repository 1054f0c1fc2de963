"""The part that a robot plays in its team: one of four, each with the state that it alone has.

Which modes (modes.py) a part can show is stated here too; a mode without its part cannot be.
"""

from dataclasses import dataclass, field
from typing import TypeAlias

from onehop.contracts.geometry import Pose
from onehop.contracts.team import Mode
from robot_agent.core.team.follower_ledger import CommandSchedule, FollowerLedger
from robot_agent.core.team.leader_view import LeaderView, Points
from robot_agent.core.team.team_messages import Command


@dataclass(frozen=True, slots=True)
class Answered:
    """How a follower's last answer came: SNR of its last hop [dB], over how many hops.

    told: the pose that it answers to.
    """

    snr_db: float
    hops: int
    told: Pose


@dataclass(slots=True)
class Leading:
    """Acts as leader of the roster in force.

    told: the pose that followers were last told to form up on. lane: ends of the piece of the way that
    they are to keep clear [m], or none. answered: how the last answer of each follower came.
    """

    ledger: FollowerLedger
    schedule: CommandSchedule
    told: Pose
    lane: Points = ()
    answered: dict[int, Answered] = field(default_factory=dict)


@dataclass(slots=True)
class Following:
    """Obeys the leader of the roster in force, which it hears."""

    leader: LeaderView


@dataclass(slots=True)
class Handover:
    """A command that tells everyone of another leader; due_ns: when it is to be said (again)."""

    command: Command
    due_ns: int | None


@dataclass(slots=True)
class Waiting:
    """Waits to hear the leader of the roster in force, which it elected or handed the team to.

    patience_ns: silence after which that one is given up too. handover: what it says meanwhile.
    """

    leader: LeaderView
    patience_ns: int
    handover: Handover | None = None


@dataclass(slots=True)
class Joining:
    """Is on no leader's roster, and asks one to take it in. host: whom; 0 for nobody yet."""

    leader: LeaderView
    host: int


Part: TypeAlias = Leading | Following | Waiting | Joining

_LED = frozenset({Mode.SETUP, Mode.FOLLOWING, Mode.NARROW, Mode.BORDER, Mode.GIVING_WAY, Mode.STOPPED})

MODES: dict[type[Part], frozenset[Mode]] = {
    Leading: frozenset({Mode.SETUP, Mode.LEADING, Mode.ALONE, Mode.STOPPED}),
    Following: _LED,
    Waiting: _LED | {Mode.LOST_LEADER},
    Joining: frozenset({Mode.JOINING}),
}
"""Modes that a robot can be in while it plays a part."""
