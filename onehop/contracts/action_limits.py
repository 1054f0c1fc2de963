"""What a robot may say in a tick: whoever says more is fenced, by name and with the reason.

A robot's process is anybody's program. What it says reaches the world's motors, the air, every log and
every page made of one, so its limits stand here once, and `ActionLimits.breach` holds a robot within one
process to them as well. Honest robots stay far below; where others could make one say more, it says
only as much as fits (robot_agent/core/team/outbox.py). docs/limits.md has them as a table.
"""

import re
from collections.abc import Iterable, Iterator
from itertools import pairwise

from onehop.contracts.messages import BROADCAST, Action, Note, NoteValue, Transmission
from onehop.contracts.ranges import Range
from onehop.contracts.serial_numbers import LIMIT
from onehop.contracts.team import Status

MSDU_BYTES = 2304
"""Longest message that a frame carries [B] (IEEE 802.11-1999, 6.2.1.1.2)."""

LARGEST = 1e9
"""Largest metre, metre a second, radian a second, bit a second, 1/s that a robot may speak of. A hundred
times what maps, bodies and rates can be (contracts/sections.py), and safe to square and to add."""

NOBODY = 0
"""What a robot may give as its leader beside robots of its team."""

MESSAGES_PER_ROBOT = 4
"""Messages a tick for each robot of the team: a leader's command to everyone, a hand-over to everyone,
a beacon and a call to all of them."""

ANSWERS = 64
"""Messages a tick beyond these, for acknowledgements: as many as the queue of a NIC holds by default."""

NOTES = 32
"""Notes a tick. The most eventful ticks of an honest robot have about eight."""

NOTE_VALUES = 8
"""Values of a note; ours have up to three."""

NOTE_TEXT = 100
"""Characters of a text in a note; ours are words and short phrases."""

VALUES = 32
"""Values a tick that a program shows beside its notes."""

_WORD = re.compile(r"[a-z][a-z0-9_]{0,31}")
"""Kinds of notes, names of their values and of a program's own: snake_case."""

_WHOLE = Range(-(2**63), 2**63 - 1)
"""Whole numbers of a note: tables hold them in 64 bits."""

_TRANSMISSION_BYTES = 80
"""What a transmission takes on the wire beyond its payload, at most [B]."""

_VALUE_BYTES = 50
"""What a value takes on the wire with its name, at most [B]."""

_STATUS_BYTES = 512
"""The same for an action that has no members, messages or notes."""


class ActionLimits:
    """The limits of one team. robots: its ids.

    messages: how many a robot may hand to its NIC in a tick; a broadcast counts once for each other
    robot, since each of them has a verdict on it. action_bytes: no action within the limits is longer.
    """

    def __init__(self, robots: Iterable[int]) -> None:
        self._robots = frozenset(robots)
        self._leaders = self._robots | {NOBODY}
        self._sound_members: tuple[int, ...] = ()
        count = len(self._robots)
        self._others = max(1, count - 1)
        self.messages = ANSWERS + MESSAGES_PER_ROBOT * count
        value_bytes = _TRANSMISSION_BYTES + max(4 * NOTE_TEXT, 9 * count)
        self.action_bytes = (
            self.messages * (MSDU_BYTES + _TRANSMISSION_BYTES)
            + NOTES * (NOTE_VALUES + 1) * value_bytes
            + VALUES * _VALUE_BYTES
            + 9 * count
            + _STATUS_BYTES
        )

    def fitting(self, outbox: list[Transmission]) -> list[Transmission]:
        """As many of these messages, from the first, as may be sent in one tick."""
        left = self.messages
        for number, transmission in enumerate(outbox):
            left -= self._weight(transmission)
            if left < 0:
                return outbox[:number]
        return outbox

    def breach(self, action: Action, tick: int, incarnation: int) -> str | None:
        """Which limit an action does not keep, in a few plain words; None if it keeps them all.

        tick, incarnation: what the robot was asked for, and what it is.
        """
        if action.tick != tick or action.incarnation != incarnation:
            said = f"tick {action.tick} as incarnation {action.incarnation}"
            return f"answered for {said} when asked for tick {tick} as incarnation {incarnation}"
        status, wrong = action.status, None
        if not _are_sound_numbers(action):
            return _wrong_number(action)
        if status is not None and (
            status.members != self._sound_members or status.leader not in self._leaders
        ):
            wrong = self._wrong_roster(status)
        if wrong is None and action.outbox:
            wrong = self._wrong_outbox(action.outbox)
        if wrong is None and action.notes:
            wrong = self._wrong_notes(action.notes)
        if wrong is None and action.values:
            wrong = _wrong_values(action.values)
        return wrong

    def _weight(self, transmission: Transmission) -> int:
        return self._others if transmission.destination == BROADCAST else 1

    def _wrong_roster(self, status: Status) -> str | None:
        members = status.members
        if status.leader not in self._leaders:
            return f"status.leader is {status.leader}, no robot of the team"
        if not members or not self._robots.issuperset(members):
            return "status.members are not robots of the team"
        if any(a >= b for a, b in pairwise(members)):
            return "status.members are not in rising order"
        self._sound_members = members
        return None

    def _wrong_outbox(self, outbox: tuple[Transmission, ...]) -> str | None:
        for one in outbox:
            if not 0 <= one.msdu_bytes <= MSDU_BYTES:
                return f"a message of {one.msdu_bytes} bytes on the air; a frame carries {MSDU_BYTES}"
            if len(one.payload) > one.msdu_bytes:
                return f"a payload of {len(one.payload)} bytes in {one.msdu_bytes} bytes on the air"
            if not 0 <= one.lifetime_ns <= _WHOLE.most:
                return f"a message that lives for {one.lifetime_ns} ns"
            if not BROADCAST <= one.destination <= _WHOLE.most:
                return f"a message to robot {one.destination}"
        weight = sum(map(self._weight, outbox))
        if weight > self.messages:
            return f"{weight} messages in a tick; {self.messages} may be sent"
        return None

    def _wrong_notes(self, notes: tuple[Note, ...]) -> str | None:
        if len(notes) > NOTES:
            return f"{len(notes)} notes in a tick; {NOTES} may be taken"
        for note in notes:
            if not _WORD.fullmatch(note.kind):
                return "a note whose kind is no word"
            if len(note.data) > NOTE_VALUES or not all(map(_WORD.fullmatch, note.data)):
                return f"a note {note.kind} with more than {NOTE_VALUES} values, or one without a name"
            for name, value in note.data.items():
                if not self._is_sound(value):
                    return f"a note {note.kind} whose {name} is no value that a note may have"
        return None

    def _is_sound(self, value: NoteValue) -> bool:
        """A number (or infinity: the width of no passage), short plain text, or a tuple of numbers."""
        if isinstance(value, str):
            return len(value) <= NOTE_TEXT and value.isprintable()
        if isinstance(value, float):
            return value == value  # NaN is not
        whole = value if isinstance(value, tuple) else (value,)
        few = len(whole) <= len(self._robots)
        return few and all(_WHOLE.least <= number <= _WHOLE.most for number in whole)


def _wrong_values(values: dict[str, float]) -> str | None:
    if len(values) > VALUES:
        return f"{len(values)} values in a tick; {VALUES} may be taken"
    for name, value in values.items():
        if not _WORD.fullmatch(name):
            return "a value whose name is no word"
        if not -LARGEST <= value <= LARGEST:
            return f"values.{name} is {value!r}, not a number from {-LARGEST:g} to {LARGEST:g}"
    return None


def _are_sound_numbers(action: Action) -> bool:
    """Whether every number of motion and status is in its range; NaN and infinity are in none.

    What `_ranges` says, in one expression: it is evaluated for every robot at every tick.
    """
    most, status, twist = LARGEST, action.status, action.twist
    return (
        -most <= twist.v <= most
        and -most <= twist.w <= most
        and 0.0 <= action.speed <= most
        and 0.0 <= action.remaining_distance <= most
        and (status is None or _is_sound_status(status))
    )


def _is_sound_status(status: Status) -> bool:
    most = LARGEST
    return (
        0 <= status.epoch < LIMIT
        and -1.0 <= status.throughput_bps <= most
        and 0.0 <= status.threshold_bps <= most
        and 0.0 <= status.k_rho <= most
        and 0.0 <= status.error <= most
        and -most <= status.target_x <= most
        and -most <= status.target_y <= most
    )


def _ranges(action: Action) -> Iterator[tuple[str, float, Range]]:
    """The same numbers with their names and ranges."""
    status, signed, positive = action.status, Range(-LARGEST, LARGEST), Range(0.0, LARGEST)
    yield "twist.v", action.twist.v, signed
    yield "twist.w", action.twist.w, signed
    yield "speed", action.speed, positive
    yield "remaining_distance", action.remaining_distance, positive
    if status is None:
        return
    yield "status.epoch", status.epoch, Range(0, LIMIT - 1)
    yield "status.throughput_bps", status.throughput_bps, Range(-1.0, LARGEST)
    yield "status.threshold_bps", status.threshold_bps, positive
    yield "status.k_rho", status.k_rho, positive
    yield "status.error", status.error, positive
    yield "status.target_x", status.target_x, signed
    yield "status.target_y", status.target_y, signed


def _wrong_number(action: Action) -> str:
    """The first number that is out of its range; there is one."""
    return next(
        f"{name} is {value!r}, not a number from {least:g} to {most:g}"
        for name, value, (least, most) in _ranges(action)
        if not least <= value <= most
    )
