"""What a gain policy may know and say beyond the throughput, if it is one that steers (gains.py).

A follower's policy aims: it says towards which slot, and with which k_rho, its robot drives in a tick. A
leader's sets the pace. A policy that does neither only answers `heard` (thesis 3.5).
"""

from collections.abc import Mapping
from typing import NamedTuple, Protocol, runtime_checkable

from onehop.contracts.geometry import Pose
from onehop.contracts.values import Value

Point = tuple[float, float]


class Situation(Value, frozen=True):
    """What a follower knows at a tick. Map frame, SI units.

    pose: its own. leader, told_ns: where its leader was by its last word, and when that came. slot: its
    own, by that word. others: the leader and where the other followers belong, by the same word.
    driving: the team is on its way.
    """

    now_ns: int
    pose: Pose
    leader: Pose
    told_ns: int
    slot: Pose
    others: tuple[Point, ...]
    driving: bool


class Aim(NamedTuple):
    """Where a follower drives to, and with which k_rho [1/s]."""

    slot: Pose
    k_rho: float


class Report(Value, frozen=True):
    """What a leader knows of a follower by its last answer.

    place: where it said that it was [m]. told: where the leader was when it asked [m]. snr_db, hops: of
    the answer, of its last hop and over so many.
    """

    place: Point
    told: Point
    snr_db: float
    hops: int


@runtime_checkable
class AimingPolicy(Protocol):
    """A policy that says where a follower drives to."""

    def aim(self, situation: Situation) -> Aim:
        """Called once a tick while the robot follows, after `heard` of the same tick."""
        ...


@runtime_checkable
class PacingPolicy(Protocol):
    """A policy that slows its leader down."""

    def pace(self, here: Point, reports: Mapping[int, Report]) -> float:
        """Share of its speed that the leader drives with in this tick, in [0, 1]; once a tick."""
        ...
