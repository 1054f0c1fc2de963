"""Several wire messages as one: what the radio carried, a percept, whole ticks for the recorder."""

from typing import TypeAlias, TypeVar

import msgspec

from onehop.contracts.errors import DecodeError
from onehop.wire.codec import REFUSALS
from onehop.wire.journal import WireMessage

T = TypeVar("T")

TickMessages: TypeAlias = tuple[int, list[WireMessage]]
"""A tick and messages of it."""

_TICK: msgspec.msgpack.Decoder[TickMessages] = msgspec.msgpack.Decoder(TickMessages)
_TICKS: msgspec.msgpack.Decoder[list[TickMessages]] = msgspec.msgpack.Decoder(list[TickMessages])


def pack_tick(tick: int, messages: list[WireMessage]) -> bytes:
    """A tick's messages as one payload; the messages themselves stay byte for byte what they were."""
    return msgspec.msgpack.encode((tick, messages))


def unpack_tick(data: bytes) -> TickMessages:
    """The inverse of pack_tick. Raises DecodeError."""
    return _unpack(_TICK, data)


def pack_ticks(ticks: list[TickMessages]) -> bytes:
    """Several ticks as one payload."""
    return msgspec.msgpack.encode(ticks)


def unpack_ticks(data: bytes) -> list[TickMessages]:
    """The inverse of pack_ticks. Raises DecodeError."""
    return _unpack(_TICKS, data)


def _unpack(decoder: msgspec.msgpack.Decoder[T], data: bytes) -> T:
    try:
        return decoder.decode(data)
    except REFUSALS as error:
        raise DecodeError(f"messages of a tick: {error}") from None
