"""The messages of a log as the values that they are."""

from typing import TypeAlias, TypeVar

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.hardware import Taken
from onehop.contracts.messages import Action, Inbox, Observation, RadioRecord, Truth
from onehop.contracts.realtime import Lateness
from onehop.wire.codec import decode
from onehop.wire.selection import Selected

TickMessage: TypeAlias = Truth | RadioRecord | Inbox | Observation | Action | Lateness | Taken

M = TypeVar("M", bound=TickMessage)

_KINDS: dict[str, type[TickMessage]] = {
    topics.TRUTH: Truth,
    topics.RADIO_RECORD: RadioRecord,
    "rx": Inbox,
    "obs": Observation,
    "out": Action,
    topics.LATE: Lateness,
    "base": Taken,
}

_MAY_BE_LATE = Inbox, Action
"""What in real time may belong to an earlier tick than the one in which it lies: its robot was late."""


def decoded(message: Selected, in_lock_step: bool = False) -> TickMessage:
    """The value of a message. Raises DecodeError if it is not one of its key and tick.

    in_lock_step: nobody can be late.
    """
    tick, key, data = message
    try:
        value = decode(_KINDS[key.partition("/")[0]], data)
    except DecodeError as error:
        raise DecodeError(f"tick {tick}, {topics.wire(key)}: {error}") from None
    may_be_late = isinstance(value, _MAY_BE_LATE) and not in_lock_step
    if value.tick != tick and not (may_be_late and 0 <= value.tick < tick):
        raise DecodeError(f"tick {tick}, {topics.wire(key)}: it is of tick {value.tick}")
    return value


def value_of(kind: type[M], message: Selected, in_lock_step: bool = False) -> M:
    """The value of a message of a key that stands for this kind. Raises DecodeError."""
    value = decoded(message, in_lock_step)
    assert isinstance(value, kind)
    return value
