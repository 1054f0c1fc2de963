"""Pick messages out of a log by bus key and tick, without unpacking the rest.

A chunk whose ticks lie outside the range is not even decompressed, and a message of another key costs
one look at its head. The layout of chunk, channel and message records is that of the MCAP specification; the
framing around chunks, sound or torn, is the mcap library's.
"""

import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk
from mcap.stream_reader import StreamReader, get_chunk_data_stream
from zstandard import ZstdError

from onehop.contracts import topics
from onehop.contracts.errors import LogError
from onehop.drive.log_writer import LOG_EPOCH_NS

_WIRE = topics.wire("")
_RECORD = struct.Struct("<BQ")
"""Opcode and length [B] before every record."""

_MESSAGE = struct.Struct("<HIQQ")
"""Head of a message: channel, sequence, log time, publish time; the data follows."""


class Selected(NamedTuple):
    """One message as it crossed the wire. key: bus key, e.g. "out/3"."""

    tick: int
    key: str
    data: bytes


Wanted = Callable[[str], bool]
"""Says of a bus key whether its messages are wanted."""


def one_of(*keys: str) -> Wanted:
    """These keys; a key that ends in "/" stands for all robots, as in "out/"."""
    stems = tuple(key for key in keys if key.endswith("/"))

    def wanted(key: str) -> bool:
        return key in keys or key.startswith(stems)

    return wanted


def select(
    path: Path, wanted: Wanted, period_ns: int, first_tick: int = 0, last_tick: int | None = None
) -> Iterator[Selected]:
    """Wanted messages of first_tick..last_tick, in the order of the log; stops where the log is torn.

    Raises LogError when a chunk is damaged.
    """
    names: dict[int, str] = {}
    final = last_tick if last_tick is not None else (1 << 62) // period_ns
    begin_ns, end_ns = LOG_EPOCH_NS + first_tick * period_ns, LOG_EPOCH_NS + final * period_ns
    with path.open("rb") as stream:
        try:
            for record in StreamReader(stream, emit_chunks=True).records:
                if isinstance(record, Channel):
                    _learn(record, wanted, names)
                elif isinstance(record, Chunk):
                    if record.message_start_time > end_ns:
                        return
                    late_enough = record.message_end_time >= begin_ns
                    yield from _unpacked(record, wanted, names, first_tick, final if late_enough else -1)
        except EndOfFile:
            return
        except (ValueError, ZstdError) as error:
            raise LogError(
                str(path),
                f"damaged near byte {stream.tell()} ({error})",
                "onehop salvage saves the rest",
            ) from None


def _learn(channel: Channel, wanted: Wanted, names: dict[int, str]) -> None:
    key = channel.topic.removeprefix(_WIRE)
    if channel.topic.startswith(_WIRE) and wanted(key):
        names[channel.id] = key


def _unpacked(
    chunk: Chunk, wanted: Wanted, names: dict[int, str], first_tick: int, last_tick: int
) -> Iterator[Selected]:
    stream, length = get_chunk_data_stream(chunk, validate_crc=True)
    data = stream.read(length)
    at = 0
    while at < length:
        opcode, size = _RECORD.unpack_from(data, at)
        body = at + _RECORD.size
        at = body + size
        if opcode == Opcode.MESSAGE:
            channel, tick, _, _ = _MESSAGE.unpack_from(data, body)
            if channel in names and first_tick <= tick <= last_tick:
                yield Selected(tick, names[channel], data[body + _MESSAGE.size : at])
        elif opcode == Opcode.CHANNEL:
            _learn(_channel(data[body:at]), wanted, names)


def _channel(data: bytes) -> Channel:
    identity, schema, length = struct.unpack_from("<HHI", data)
    topic = data[8 : 8 + length].decode()
    return Channel(id=identity, schema_id=schema, topic=topic, message_encoding="", metadata={})
