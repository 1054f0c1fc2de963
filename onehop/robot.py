"""Bring your own robot: all that a program of one needs, and the one thing that it has to be.

A program is a class with two methods. It is made once for each process of a robot, from its briefing,
and stepped once a tick: everything that the robot knows in, everything that it does out. It is pure: no
clock but `percept.time_ns`, no randomness but `generator(briefing.seed, ...)`, no files, no threads, no
set that is iterated. Then the same seed gives the same bytes in one process, in many, and from the log
alone (docs/own-robot.md).

    class Seeker(Program):
        def __init__(self, briefing: Briefing) -> None:
            self.goal = briefing.goal

        def step(self, percept: Percept) -> Action:
            x, y = to_local(percept.pose, self.goal.x, self.goal.y)
            return Action(Twist(0.5 if x > 0 else 0.0, atan2(y, x)))

What stands in `__all__` is stable: it changes with a major version only.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.elementary import atan2, cos, sin
from onehop.contracts.geometry import STANDSTILL, Pose, Twist, to_local, to_map, wrap_angle
from onehop.contracts.messages import BROADCAST, Note, Percept, Transmission
from onehop.contracts.messages import Reception as Message
from onehop.contracts.neighbour import Neighbour
from onehop.contracts.randomness import generator
from onehop.contracts.ranges import Range
from onehop.contracts.team import Status
from onehop.contracts.units import nanoseconds

__all__ = [
    "BROADCAST", "STANDSTILL", "Action", "Beams", "Briefing", "Message", "Neighbour", "NoParameters",
    "Note", "Percept", "Pose", "Program", "Range", "Status", "Transmission", "Twist", "atan2",
    "broadcast", "cos", "generator", "send", "sin", "to_local", "to_map", "wrap_angle",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Action:
    """What a robot does in a tick; the default is to stand still and to say nothing.

    outbox: messages for its NIC (`broadcast`, `send`). notes: events for people, in log and report.
    values: numbers by name that reports and viewers plot. remaining_distance: to its goal [m], which
    routing may go by. status: what it says of its team, if it has one with roster and leader.
    """

    twist: Twist = STANDSTILL
    outbox: Sequence[Transmission] = ()
    notes: Sequence[Note] = ()
    values: Mapping[str, float] | None = None
    remaining_distance: float = 0.0
    status: Status | None = None


def broadcast(payload: bytes, *, size: int | None = None, lifetime_s: float = 0.0) -> Transmission:
    """A message to everyone in range: one frame, not repeated. See `send`."""
    return send(BROADCAST, payload, size=size, lifetime_s=lifetime_s)


def send(
    robot: int, payload: bytes, *, size: int | None = None, lifetime_s: float = 0.0
) -> Transmission:
    """A message to one robot: acknowledged, repeated, and routed over others if the scenario says so.

    size: bytes that it takes on the air, by default those of the payload; at most 2304. lifetime_s: how
    long it is of use [s]; an older one is dropped where it waits. 0: as long as the radio's own limit.
    """
    return Transmission(robot, payload, len(payload) if size is None else size, nanoseconds(lifetime_s))


@dataclass(frozen=True, slots=True)
class NoParameters:
    """Of a program that takes none."""


class Program(ABC):
    """What drives one robot.

    Parameters: a frozen dataclass that says which parameters a scenario may give, with defaults, and
    with ranges as in `Annotated[float, Range(0.0, 2.0)]`. `briefing.parameters` is an instance of it.

    reproducible: whether it goes by its briefing and its percepts alone. One that is driven by somebody
    outside says False: it is not re-executed from a log, what it said is taken as it is; and it has no
    place in missions of one process, where nobody outside can keep up.
    """

    Parameters: ClassVar[type[Any]] = NoParameters
    reproducible: ClassVar[bool] = True

    @abstractmethod
    def __init__(self, briefing: Briefing) -> None:
        """A robot that starts, for the first time or again. It keeps what it needs of its briefing."""

    @abstractmethod
    def step(self, percept: Percept) -> Action:
        """Everything that the robot does at this tick, from everything that it can know."""
