"""Several wire messages of one tick as one: inboxes on the air, a percept, a tick for the recorder."""

import msgpack

from onehop.contracts.errors import DecodeError
from onehop.drive.journal import WireMessage


def pack_record(tick: int, messages: list[WireMessage]) -> bytes:
    """A tick's messages as one payload; the messages themselves stay byte for byte what they were."""
    packed: bytes = msgpack.packb((tick, messages))
    return packed


def unpack_record(data: bytes) -> tuple[int, list[WireMessage]]:
    """The inverse of pack_record. Raises DecodeError."""
    try:
        tick, messages = msgpack.unpackb(data)
        return int(tick), [(str(key), bytes(value)) for key, value in messages]
    except (ValueError, TypeError, msgpack.UnpackException) as error:
        raise DecodeError(f"record: {error}") from None
