"""Several wire messages of one tick as one: inboxes on the air, a percept, a tick for the recorder."""

import msgspec

from onehop.contracts.errors import DecodeError
from onehop.drive.codec import REFUSALS
from onehop.drive.journal import WireMessage

_DECODER = msgspec.msgpack.Decoder(tuple[int, list[WireMessage]])


def pack_record(tick: int, messages: list[WireMessage]) -> bytes:
    """A tick's messages as one payload; the messages themselves stay byte for byte what they were."""
    return msgspec.msgpack.encode((tick, messages))


def unpack_record(data: bytes) -> tuple[int, list[WireMessage]]:
    """The inverse of pack_record. Raises DecodeError."""
    try:
        return _DECODER.decode(data)
    except REFUSALS as error:
        raise DecodeError(f"record: {error}") from None
