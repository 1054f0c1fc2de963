"""Several wire messages as one: inboxes on the air, a percept, whole ticks for the recorder."""

from typing import TypeAlias, TypeVar

import msgspec

from onehop.contracts.errors import DecodeError
from onehop.drive.codec import REFUSALS
from onehop.drive.journal import WireMessage

T = TypeVar("T")

Record: TypeAlias = tuple[int, list[WireMessage]]
"""A tick and messages of it."""

_RECORD: msgspec.msgpack.Decoder[Record] = msgspec.msgpack.Decoder(Record)
_RECORDS: msgspec.msgpack.Decoder[list[Record]] = msgspec.msgpack.Decoder(list[Record])


def pack_record(tick: int, messages: list[WireMessage]) -> bytes:
    """A tick's messages as one payload; the messages themselves stay byte for byte what they were."""
    return msgspec.msgpack.encode((tick, messages))


def unpack_record(data: bytes) -> Record:
    """The inverse of pack_record. Raises DecodeError."""
    return _unpack(_RECORD, data)


def pack_records(records: list[Record]) -> bytes:
    """Several ticks as one payload."""
    return msgspec.msgpack.encode(records)


def unpack_records(data: bytes) -> list[Record]:
    """The inverse of pack_records. Raises DecodeError."""
    return _unpack(_RECORDS, data)


def _unpack(decoder: msgspec.msgpack.Decoder[T], data: bytes) -> T:
    try:
        return decoder.decode(data)
    except REFUSALS as error:
        raise DecodeError(f"record: {error}") from None
