"""The messages of a log as the values that they are."""

from typing import TypeAlias, TypeVar

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Action, Inbox, Observation, RadioRecord, Truth
from onehop.wire.codec import decode
from onehop.wire.selection import Selected

TickMessage: TypeAlias = Truth | RadioRecord | Inbox | Observation | Action

M = TypeVar("M", bound=TickMessage)

_KINDS: dict[str, type[TickMessage]] = {
    topics.TRUTH: Truth,
    topics.RADIO_RECORD: RadioRecord,
    "rx": Inbox,
    "obs": Observation,
    "out": Action,
}


def decoded(message: Selected) -> TickMessage:
    """The value of a message. Raises DecodeError if it is not one of its key and tick."""
    tick, key, data = message
    try:
        value = decode(_KINDS[key.partition("/")[0]], data)
    except DecodeError as error:
        raise DecodeError(f"tick {tick}, {topics.wire(key)}: {error}") from None
    if value.tick != tick:
        raise DecodeError(f"tick {tick}, {topics.wire(key)}: it is of tick {value.tick}")
    return value


def value_of(kind: type[M], message: Selected) -> M:
    """The value of a message of a key that stands for this kind. Raises DecodeError."""
    value = decoded(message)
    assert isinstance(value, kind)
    return value
