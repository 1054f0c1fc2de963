"""What is in a log and where, found by one pass over its records that unpacks no message.

A stretch is what is read at once: a chunk, or messages that lie between the other records. Its head says
from which log time to which it goes.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import BinaryIO, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Channel, Schema

from onehop.contracts.errors import LogError
from onehop.wire.records import (
    CHUNK_HEAD_BYTES,
    MAGIC,
    MESSAGE,
    Record,
    RecordError,
    attachment,
    channel,
    chunk_head,
    content_of,
    metadata,
    read_exactly,
    schema,
    unpacked,
    walk,
)

STRETCH_BYTES = 1 << 20
"""Messages outside of chunks are read in stretches of about this size [B], the size of our chunks."""

_BETWEEN = (Opcode.MESSAGE, Opcode.CHANNEL, Opcode.SCHEMA)
"""Records that lie in chunks, or without chunks between the others."""


_WHOLE = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA, Opcode.ATTACHMENT)
"""Records that are read as a whole; schemas and channels among them are those of the summary."""


class Stretch(NamedTuple):
    """Messages that lie together in the file. first_ns, last_ns: log times; 0 where is no message.

    at, length: bytes of the records themselves, or of the content of a chunk.
    """

    at: int
    length: int
    first_ns: int
    last_ns: int
    is_chunk: bool


@dataclass(slots=True)
class Contents:
    """One log file. metadata, attachments: by name; of several of a name the last counts.

    schemas, channels: as the summary at the end lists them; none in a torn log. apart: metadata and
    attachments as records. end: the byte behind the last record.
    torn: the file ends before its footer, since its recorder was killed.
    broken: where the chain of records breaks though the file goes on, and why. unreadable: metadata and
    attachments that are damaged.
    """

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    stretches: list[Stretch] = field(default_factory=list)
    schemas: list[Schema] = field(default_factory=list)
    channels: list[Channel] = field(default_factory=list)
    apart: list[Record] = field(default_factory=list)
    end: int = 0
    torn: bool = True
    broken: RecordError | None = None
    unreadable: list[RecordError] = field(default_factory=list)
    _looked_at: int = 0
    _in_order: bool = True

    def stretches_of(self, first_ns: int, last_ns: int) -> Iterator[Stretch]:
        """Those with messages of these log times, ends included, found without a look at all others.

        In a file whose heads do not go forward in time all are looked at.
        """
        stretches = self.stretches
        self._look_at_new()
        begin, end = 0, len(stretches)
        if self._in_order:
            begin = bisect_left(stretches, first_ns, key=attrgetter("last_ns"))
            end = bisect_right(stretches, last_ns, lo=begin, key=attrgetter("first_ns"))
        for i in range(begin, end):
            if stretches[i].last_ns >= first_ns and stretches[i].first_ns <= last_ns:
                yield stretches[i]

    def _look_at_new(self) -> None:
        """Whether those that have been added begin and end no earlier than the ones before."""
        stretches, count = self.stretches, len(self.stretches)  # another thread may add more meanwhile
        for i in range(max(1, self._looked_at), count):
            before, one = stretches[i - 1], stretches[i]
            if one.first_ns < before.first_ns or one.last_ns < before.last_ns:
                self._in_order = False
        self._looked_at = count


def damaged(path: Path, at: int, why: str) -> LogError:
    """The error of a log that is not sound at a byte."""
    remedy = "onehop salvage saves what is sound"
    return LogError(str(path), f"damaged in the record at byte {at} ({why})", remedy)


def read_contents(path: Path, start: int = len(MAGIC)) -> Contents:
    """The contents from a record on, by default all. Raises LogError for what is no MCAP file."""
    try:
        with path.open("rb") as stream:
            if stream.read(len(MAGIC)) != MAGIC:
                raise LogError(str(path), "not an MCAP file", "give a .mcap log")
            return _Pass(stream).contents(start)
    except OSError as error:
        why = error.strerror or "cannot be read"
        raise LogError(str(path), why, "name a log that exists") from None


def records_of(stretch: Stretch, stream: BinaryIO) -> bytes:
    """The records of a stretch, one after the other. Raises RecordError."""
    content = read_exactly(stream, stretch.at, stretch.length)
    return unpacked(content) if stretch.is_chunk else content


class _Pass:
    """One pass over a file."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._found = Contents()
        self._in_summary = False
        self._open: Stretch | None = None

    def contents(self, start: int) -> Contents:
        found = self._found
        found.end = start
        try:
            for record in walk(self._stream, start):
                try:
                    self._take(record)
                except RecordError as error:
                    if record.opcode == Opcode.CHUNK:
                        raise RecordError(error.why, record.at) from None
                    found.unreadable.append(RecordError(error.why, record.at))
                found.end, found.torn = record.end, record.opcode != Opcode.FOOTER
        except RecordError as error:
            found.broken, found.torn = error, False
        self._close_stretch()
        return found

    def _take(self, record: Record) -> None:
        opcode = record.opcode
        if opcode in _BETWEEN and not self._in_summary:
            self._extend_stretch(record)
            return
        self._close_stretch()
        if opcode == Opcode.CHUNK:
            head = chunk_head(self._stream.read(min(record.length, CHUNK_HEAD_BYTES)), record.length)
            place = record.start, record.length
            self._found.stretches.append(Stretch(*place, head.first_ns, head.last_ns, is_chunk=True))
        elif opcode in _WHOLE:
            self._take_whole(record, content_of(self._stream, record))
        self._in_summary |= opcode == Opcode.DATA_END

    def _take_whole(self, record: Record, content: bytes) -> None:
        found, opcode = self._found, record.opcode
        if opcode == Opcode.SCHEMA:
            found.schemas.append(schema(content))
        elif opcode == Opcode.CHANNEL:
            found.channels.append(channel(content))
        elif opcode == Opcode.METADATA:
            about = metadata(content)
            found.metadata[about.name] = about.metadata
            found.apart.append(record)
        else:
            file = attachment(content)
            found.attachments[file.name] = file.data
            found.apart.append(record)

    def _extend_stretch(self, record: Record) -> None:
        """A record that lies between the others goes to the stretch before it, if that is not long."""
        if self._open is not None and self._open.length >= STRETCH_BYTES:
            self._close_stretch()
        one = self._open or Stretch(record.at, 0, 0, 0, is_chunk=False)
        first_ns, last_ns = one.first_ns, one.last_ns
        if record.opcode == Opcode.MESSAGE:
            if record.length < MESSAGE.size:
                raise RecordError("a message without a head")
            _, _, log_ns, _ = MESSAGE.unpack(self._stream.read(MESSAGE.size))
            first_ns = min(first_ns, log_ns) if last_ns else log_ns
            last_ns = max(last_ns, log_ns)
        self._open = Stretch(one.at, record.end - one.at, first_ns, last_ns, is_chunk=False)

    def _close_stretch(self) -> None:
        if self._open is not None:
            self._found.stretches.append(self._open)
        self._open = None
