"""One tick of a log as values: what the world said of it, the radio, and every robot.

A message that cannot be read or cannot be, or lies there twice, is a flaw; of two the first counts.
"""

from dataclasses import dataclass, field

from onehop.checking.findings import Exhibit
from onehop.checking.sanity import impossible
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.hardware import Measured, Taken
from onehop.contracts.messages import (
    Action,
    DeliveryStatus,
    Inbox,
    Observation,
    Presence,
    RadioRecord,
    Truth,
)
from onehop.contracts.printable import ids_in_words
from onehop.wire.log_reader import LoggedTick
from onehop.wire.logged import TickMessage, decoded
from onehop.wire.selection import Selected

ARRIVES = frozenset((DeliveryStatus.DELIVERED, DeliveryStatus.CORRUPTED))
"""Statuses of what comes to its receiver, as it was sent or not; all others are losses."""


@dataclass(slots=True)
class Snapshot:
    """A tick. follows: the tick before it was in the log, too.

    measured: what real bases have measured anew, by robot. present: robots that take part, by id.
    stopped: those whose processes are stopped. flaws: what is wrong with its messages, each with its
    channel.
    """

    tick: int
    follows: bool
    truth: Truth | None = None
    record: RadioRecord | None = None
    inboxes: dict[int, Inbox] = field(default_factory=dict)
    observations: dict[int, Observation] = field(default_factory=dict)
    actions: dict[int, Action] = field(default_factory=dict)
    measured: dict[int, Measured] = field(default_factory=dict)
    present: dict[int, Presence] = field(default_factory=dict)
    stopped: tuple[int, ...] = ()
    flaws: list[tuple[str, str]] = field(default_factory=list)

    def take(self, key: str, value: TickMessage) -> None:
        """One message of this tick."""
        robot = int(key.partition("/")[2] or 0)
        if isinstance(value, Action):
            self.actions[robot] = value
        elif isinstance(value, Observation):
            self.observations[robot] = value
        elif isinstance(value, Inbox):
            self.inboxes[robot] = value
        elif isinstance(value, Taken):
            self.measured[robot] = value.measured
        elif isinstance(value, RadioRecord):
            self.record = value
        elif isinstance(value, Truth):
            self.truth = value
            self.present = {one.robot: one for one in value.present}
            self.stopped = value.stopped

    def running(self) -> list[Presence]:
        """Robots that have an observation, an inbox and an action at this tick."""
        return [one for robot, one in self.present.items() if robot not in self.stopped]

    def exhibit(self, key: str, says: str) -> Exhibit:
        """A message of this tick as evidence."""
        return Exhibit(self.tick, topics.wire(key), says)

    def status_of(self, robot: int) -> Exhibit:
        """What a robot says of its team, as evidence."""
        action = self.actions.get(robot)
        if action is None:
            return self.exhibit(topics.out(robot), "no message")
        status = action.status
        if status is None:
            return self.exhibit(topics.out(robot), "nothing of a team")
        return self.exhibit(
            topics.out(robot),
            f"{status.mode.value}, epoch {status.epoch}, leader {status.leader} of "
            f"{ids_in_words(status.members)}, {status.shape.value}",
        )

    def is_whole(self) -> bool:
        """Whether all is there that world, radio and robots owe each other in a tick."""
        owed = {presence.robot for presence in self.running()}
        said = self.observations.keys() & self.inboxes.keys() & self.actions.keys()
        return self.truth is not None and self.record is not None and owed <= said


def snapshot(
    logged: LoggedTick, follows: bool, team: frozenset[int], in_lock_step: bool = True
) -> Snapshot:
    """A tick with its messages decoded. team: ids of all robots. in_lock_step: none can be late."""
    made = Snapshot(logged.tick, follows)
    seen: set[str] = set()
    for key, data in logged.messages:
        if key in seen:
            made.flaws.append((key, "lies there twice"))
            continue
        seen.add(key)
        try:
            value = decoded(Selected(logged.tick, key, data), in_lock_step)
        except DecodeError as error:
            made.flaws.append((key, f"cannot be read: {error}"))
            continue
        why = impossible(value, team)
        if why is None:
            made.take(key, value)
        else:
            made.flaws.append((key, why))
    return made
