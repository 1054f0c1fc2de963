"""The records of an MCAP file, without trust in what they say of themselves.

The layout is that of the MCAP specification, version 0: after eight magic bytes records of opcode,
length and content; messages lie in chunks (plain, zstd or lz4) or between the other records. Whatever a
file says, no record is read beyond the file's end and no chunk takes more memory than MAX_CHUNK_BYTES.
"""

import struct
import zlib
from collections.abc import Callable, Iterator
from io import BytesIO
from typing import BinaryIO, NamedTuple, TypeVar

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Message, Metadata, Schema

from onehop.contracts.printable import printable

R = TypeVar("R")

MAGIC = b"\x89MCAP0\r\n"
"""The first and the last bytes of a finished file."""

MAX_CHUNK_BYTES = 1 << 28
"""Longest chunk that is unpacked, and longest other record that is read [B]: ours have 1 MiB."""

RECORD = struct.Struct("<BQ")
"""Opcode and length [B] before every record."""

_CHUNK = struct.Struct("<QQQII")
"""Head of a chunk: first and last log time, unpacked size, CRC-32, length of the compression's name."""

CHUNK_HEAD_BYTES = _CHUNK.size + 32
"""Enough of a chunk's content to read its head [B]."""

_PACKED = struct.Struct("<Q")
"""Length [B] of the packed records, between the head of a chunk and them."""

_CHANNEL = struct.Struct("<HHI")
"""Head of a channel: id, schema id, length of the topic; the topic follows."""

MESSAGE = struct.Struct("<HIQQ")
"""Head of a message: channel, sequence, log time, publish time; the data follows."""

MESSAGE_RECORD = struct.Struct("<BQHIQ")
"""How the record of a message begins: opcode, length, channel, sequence, log time."""

_NOT_PARSABLE = (McapError, struct.error, ValueError)
"""What mcap raises for the content of a record that is none."""


class RecordError(Exception):
    """Bytes that are not the record they should be, and why. at: where in the file, if that is known."""

    def __init__(self, why: str, at: int = -1) -> None:
        super().__init__(why)
        self.why = why
        self.at = at


class Record(NamedTuple):
    """Where a record lies. at: its first byte in the file. start: first byte of its content."""

    opcode: int
    at: int
    start: int
    length: int

    @property
    def end(self) -> int:
        """The byte behind it."""
        return self.start + self.length


class ChunkHead(NamedTuple):
    """What a chunk says of itself. size: unpacked [B]. crc: 0 when there is none.

    start: where in its content the packed records begin.
    """

    first_ns: int
    last_ns: int
    size: int
    crc: int
    compression: bytes
    start: int


def walk(stream: BinaryIO, start: int = len(MAGIC)) -> Iterator[Record]:
    """Every whole record from `start` on, to the footer. The stream may be moved between two records.

    Ends early in a file that is torn within a record. Raises RecordError where there can be no record:
    for want of an opcode, or because it would end beyond a file that has its regular last bytes.
    """
    end = stream.seek(0, 2)
    stream.seek(max(0, end - len(MAGIC)))
    finished = end >= 2 * len(MAGIC) and stream.read() == MAGIC
    at = start
    while at + RECORD.size <= end:
        stream.seek(at)
        opcode, length = RECORD.unpack(stream.read(RECORD.size))
        record = Record(opcode, at, at + RECORD.size, length)
        if record.end > end:
            break
        if not opcode:
            raise RecordError("no record begins there", at)
        yield record
        if opcode == Opcode.FOOTER:
            return
        at = record.end
    if finished:
        raise RecordError("what begins there leads beyond the end of the file", at)


def content_of(stream: BinaryIO, record: Record) -> bytes:
    """The content of a record. Raises RecordError for one that is too long to be true."""
    return read_exactly(stream, record.start, record.length)


def read_exactly(stream: BinaryIO, at: int, length: int) -> bytes:
    """So many bytes of a file. Raises RecordError if they are too many for one record, or not there."""
    if length > MAX_CHUNK_BYTES:
        raise RecordError(f"{length} bytes in one record; at most {MAX_CHUNK_BYTES} are read", at)
    stream.seek(at)
    content = stream.read(length)
    if len(content) < length:
        raise RecordError("the file has become shorter", at)
    return content


def chunk_head(content: bytes, length: int) -> ChunkHead:
    """The head of a chunk, from the beginning of its content, which has `length` bytes.

    Raises RecordError when that is not the length that the head says.
    """
    try:
        first_ns, last_ns, size, crc, name = _CHUNK.unpack_from(content)
        compression = content[_CHUNK.size : _CHUNK.size + name]
        start = _CHUNK.size + name + _PACKED.size
        (packed,) = _PACKED.unpack_from(content, start - _PACKED.size)
    except struct.error:
        raise RecordError("a chunk without a head") from None
    if start + packed != length:
        raise RecordError("a chunk of another length than its head says")
    return ChunkHead(first_ns, last_ns, size, crc, compression, start)


def unpacked(content: bytes) -> bytes:
    """The records in a chunk. Raises RecordError when they are not what was written."""
    head = chunk_head(content, len(content))
    if head.size > MAX_CHUNK_BYTES:
        raise RecordError(f"a chunk of {head.size} bytes; at most {MAX_CHUNK_BYTES} are read")
    unpack = _UNPACKERS.get(head.compression)
    if unpack is None:
        raise RecordError(f"compression {head.compression[:20]!r}; zstd, lz4 or none is read")
    data = unpack(content[head.start :], head.size)
    if len(data) != head.size or (head.crc and zlib.crc32(data) != head.crc):
        raise RecordError("its checksum is wrong")
    return data


def _plain(packed: bytes, _: int) -> bytes:
    return packed


def _zstd(packed: bytes, size: int) -> bytes:
    """Without looking first, zstandard would make room for whatever the packed bytes promise."""
    if not size:
        return b""
    try:
        if zstandard.frame_content_size(packed) not in (-1, size):
            raise RecordError("a chunk of another size than its head says")
        return zstandard.decompress(packed, size)
    except zstandard.ZstdError as error:
        raise RecordError(str(error)) from None


def _lz4(packed: bytes, size: int) -> bytes:
    try:
        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(packed, size + 1))
    except RuntimeError as error:
        raise RecordError(str(error)) from None


_UNPACKERS: dict[bytes, Callable[[bytes, int], bytes]] = {b"": _plain, b"zstd": _zstd, b"lz4": _lz4}


def records_in(data: bytes) -> Iterator[tuple[int, int, int]]:
    """(opcode, begin, end) of the content of each record in `data`. Raises RecordError."""
    at = 0
    while at < len(data):
        opcode, begin, at = record_at(data, at)
        yield opcode, begin, at


def record_at(data: bytes, at: int) -> tuple[int, int, int]:
    """(opcode, begin, end) of the content of the record at a byte. Raises RecordError."""
    begin = at + RECORD.size
    if begin > len(data):
        raise RecordError("it ends within a record")
    opcode, size = RECORD.unpack_from(data, at)
    if begin + size > len(data) or not opcode or (opcode == Opcode.MESSAGE and size < MESSAGE.size):
        raise RecordError("no record where one should be")
    return opcode, begin, begin + size


def topic_of(content: bytes) -> tuple[int, str]:
    """Id and topic of a channel. Raises RecordError."""
    try:
        number, _, length = _CHANNEL.unpack_from(content)
        return number, content[_CHANNEL.size : _CHANNEL.size + length].decode()
    except (struct.error, UnicodeDecodeError):
        raise RecordError("a channel that cannot be read") from None


def message(content: bytes) -> Message:
    """From the content of a record that records_in gave."""
    number, sequence, log_ns, publish_ns = MESSAGE.unpack_from(content)
    return Message(number, log_ns, content[MESSAGE.size :], publish_ns, sequence)


def channel(content: bytes) -> Channel:
    """Raises RecordError."""
    return _parsed(Channel, content)


def schema(content: bytes) -> Schema:
    """Raises RecordError."""
    return _parsed(Schema, content)


def metadata(content: bytes) -> Metadata:
    """Raises RecordError."""
    return _parsed(Metadata, content)


def attachment(content: bytes) -> Attachment:
    """Raises RecordError, also when its checksum is wrong."""
    found = _parsed(Attachment, content)
    crc = int.from_bytes(content[-4:], "little")
    if crc and zlib.crc32(content[:-4]) != crc:
        raise RecordError(f"the checksum of attachment {printable(found.name, 60)!r} is wrong")
    return found


def _parsed(kind: type[R], content: bytes) -> R:
    try:
        found: R = kind.read(ReadDataStream(BytesIO(content)))  # type: ignore[attr-defined]
    except _NOT_PARSABLE as error:
        raise RecordError(f"cannot be read ({printable(str(error))})") from None
    return found
