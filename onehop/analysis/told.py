"""What happened in a tick, in a line each, for whoever looks at a log in another tool."""

from collections.abc import Iterator, Mapping
from enum import Enum
from typing import NamedTuple

from onehop.contracts import topics
from onehop.contracts.fault_section import fault_in_words
from onehop.contracts.messages import Action, Note, Truth
from onehop.contracts.printable import printable
from onehop.contracts.topics import robot_name

MOST_NOTES = 100
"""Notes of one robot and tick that are shown: a team has a few."""


class Gravity(Enum):
    """How grave an event is."""

    DEBUG = "debug"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


_OF_NOTES = {
    "lost_leader": Gravity.WARNING,
    "lost_follower": Gravity.WARNING,
    "no_way": Gravity.ERROR,
    "target": Gravity.DEBUG,
    "mode": Gravity.DEBUG,
}
"""Of a kind of note; anything else is information."""


class Told(NamedTuple):
    """who: name of a process, the world or a robot."""

    who: str
    text: str
    gravity: Gravity


def events(truth: Truth, actions: Mapping[int, Action]) -> Iterator[Told]:
    """Faults that begin, robots that leave, and what robots note. actions: by robot."""
    for fault in truth.faults:
        text = printable(f"fault: {fault_in_words(fault)}")
        yield Told(topics.WORLD, text, Gravity.WARNING)
    for one in truth.departures:
        yield Told(robot_name(one.robot), printable(f"gone, {one.why}"), Gravity.WARNING)
    for robot, action in sorted(actions.items()):
        for note in action.notes[:MOST_NOTES]:
            yield Told(robot_name(robot), _text(note), _OF_NOTES.get(note.kind, Gravity.INFO))


def _text(note: Note) -> str:
    details = ", ".join(
        f"{key} {value:.2f}" if isinstance(value, float) else f"{key} {value}"
        for key, value in note.data.items()
    )
    return printable(f"{note.kind.replace('_', ' ')}{': ' if details else ''}{details}")
