"""Pick messages out of a log by bus key and tick, without unpacking the rest.

The file is walked record by record; a chunk whose ticks lie outside the range is skipped, not even
decompressed, and a message of another key costs one look at its head. The layout of records is that of
the MCAP specification (version 0): opcode, length, content.
"""

import struct
import zlib
from collections.abc import Callable, Iterator
from io import BufferedReader
from pathlib import Path
from typing import NamedTuple

import zstandard
from mcap.opcode import Opcode

from onehop.contracts import topics
from onehop.contracts.errors import LogError
from onehop.wire.log_writer import LOG_EPOCH_NS

_WIRE = topics.wire("")
_MAGIC = 8
"""Length of the magic bytes before the first record [B]; LogFile has looked at them."""

_RECORD = struct.Struct("<BQ")
"""Opcode and length [B] before every record."""

_CHUNK = struct.Struct("<QQQII")
"""Head of a chunk: first and last log time, uncompressed size and CRC-32, length of the next text."""

_CHANNEL = struct.Struct("<HHI")
"""Head of a channel: id, schema id, length of the topic; the topic follows."""

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


def walk(stream: BufferedReader) -> Iterator[tuple[int, int]]:
    """(opcode, length) of every whole record, the stream at its content; stops where the log is torn."""
    end = stream.seek(0, 2)
    at = _MAGIC
    while at + _RECORD.size <= end:
        stream.seek(at)
        opcode, length = _RECORD.unpack(stream.read(_RECORD.size))
        at += _RECORD.size + length
        if at > end:
            return
        yield opcode, length
        if opcode == Opcode.FOOTER:
            return


def select(
    path: Path, wanted: Wanted, period_ns: int, first_tick: int = 0, last_tick: int | None = None
) -> Iterator[Selected]:
    """Wanted messages of first_tick..last_tick, in the order of the log; stops where the log is torn.

    Raises LogError when a chunk is damaged.
    """
    final = last_tick if last_tick is not None else (1 << 62) // period_ns
    begin_ns, end_ns = LOG_EPOCH_NS + first_tick * period_ns, LOG_EPOCH_NS + final * period_ns
    with path.open("rb") as stream:
        names = _indexed(stream, wanted)
        indexed = bool(names)
        for opcode, length in walk(stream):
            if opcode != Opcode.CHUNK:
                continue
            start = stream.tell()
            first_ns, last_ns, size, crc, text = _head(stream)
            if first_ns > end_ns:
                return
            if indexed and last_ns < begin_ns:
                continue
            compression = stream.read(text)
            stream.seek(8, 1)
            packed = stream.read(start + length - stream.tell())
            data = _unpacked(path, start, packed, compression, size, crc)
            yield from _messages(data, wanted, names, first_tick, final)


def _indexed(stream: BufferedReader, wanted: Wanted) -> dict[int, str]:
    """Wanted channels as the summary at the end of a sound file lists them; nothing for a torn one."""
    names: dict[int, str] = {}
    for opcode, length in walk(stream):
        if opcode == Opcode.CHANNEL:
            _learn(stream.read(length), wanted, names)
    return names


def _learn(record: bytes, wanted: Wanted, names: dict[int, str]) -> None:
    channel, _, length = _CHANNEL.unpack_from(record)
    topic = record[_CHANNEL.size : _CHANNEL.size + length].decode()
    key = topic.removeprefix(_WIRE)
    if topic.startswith(_WIRE) and wanted(key):
        names[channel] = key


def _head(stream: BufferedReader) -> tuple[int, int, int, int, int]:
    first_ns, last_ns, size, crc, text = _CHUNK.unpack(stream.read(_CHUNK.size))
    return first_ns, last_ns, size, crc, text


def _unpacked(path: Path, at: int, packed: bytes, compression: bytes, size: int, crc: int) -> bytes:
    try:
        data = zstandard.decompress(packed, size) if compression == b"zstd" else packed
    except zstandard.ZstdError as error:
        raise _damaged(path, at, str(error)) from None
    if crc and zlib.crc32(data) != crc:
        raise _damaged(path, at, "its checksum is wrong")
    return data


def _damaged(path: Path, at: int, why: str) -> LogError:
    remedy = "onehop salvage saves what comes before"
    return LogError(str(path), f"damaged in the record at byte {at} ({why})", remedy)


def _messages(
    data: bytes, wanted: Wanted, names: dict[int, str], first_tick: int, last_tick: int
) -> Iterator[Selected]:
    record, head, length = _RECORD.unpack_from, _MESSAGE.unpack_from, len(data)
    at = 0
    while at < length:
        opcode, size = record(data, at)
        body = at + _RECORD.size
        at = body + size
        if opcode == Opcode.MESSAGE:
            channel, tick, _, _ = head(data, body)
            if channel in names and first_tick <= tick <= last_tick:
                yield Selected(tick, names[channel], data[body + _MESSAGE.size : at])
        elif opcode == Opcode.CHANNEL:
            _learn(data[body:at], wanted, names)
