"""Words for the state of a team that more than one program speaks: modes, shapes, status."""

from enum import StrEnum

from onehop.contracts.values import Value


class Mode(StrEnum):
    """What a robot is doing in its team (thesis 3.3; the transitions are in robot_agent/core)."""

    SETUP = "setup"
    LEADING = "leading"
    FOLLOWING = "following"
    NARROW = "narrow"
    BORDER = "border following"
    GIVING_WAY = "giving way"
    LOST_LEADER = "lost leader"
    ALONE = "alone"
    JOINING = "joining"
    STOPPED = "stopped"


class Shape(StrEnum):
    """Formation shapes (thesis 3.3.1)."""

    SOLO = "solo"
    COLUMN = "column"
    WEDGE = "wedge"
    DIAMOND = "diamond"
    HEXAGON = "hexagon"


class LossReason(StrEnum):
    """Why a leader gives a follower up: the `reason` of its note `lost_follower`."""

    UNANSWERED = "unanswered"
    NOT_IN_POSITION = "not in position at setup"


_LOSS_IN_WORDS: dict[str, str] = {
    LossReason.UNANSWERED: ": its commands stayed unanswered",
    LossReason.NOT_IN_POSITION: ": not in position when setup ended",
}


def loss_in_words(reason: str) -> str:
    """End of a sentence that says who was given up; "" for a note that gives no reason."""
    return _LOSS_IN_WORDS.get(reason, f": {reason}" if reason else "")


class Status(Value, frozen=True):
    """What a robot says of itself in every action, for people, the referee and the checker.

    mode: what it is doing. A robot acts as leader when `leader` is its own id.
    epoch, leader, members, shape: the roster that it obeys (members sorted, leader included).
    throughput_bps: measured on the last Next [bit/s]; 0 when that Next is missing; -1 for a leader.
    threshold_bps: below it the robot hurries [bit/s].
    k_rho: gain in force [1/s] (thesis eq. 3.11).
    error: distance to its slot [m]; for a leader the distance to the goal.
    target_x, target_y: where it is heading, map frame [m].
    """

    mode: Mode
    epoch: int
    leader: int
    members: tuple[int, ...]
    shape: Shape
    throughput_bps: float
    threshold_bps: float
    k_rho: float
    error: float
    target_x: float
    target_y: float
