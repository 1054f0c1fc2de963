"""What of a damaged log is sound: every stretch that can be read, in the order of its ticks.

The records of a file lead from one to the next. Where that chain breaks, the next chunk is found by how
chunks of a log begin, and proven by its checksum.
"""

import mmap
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, NamedTuple

from mcap.records import Channel, Message, Schema

from onehop.analysis.copying import parsed
from onehop.wire.contents import Contents, Stretch, read_contents, records_of
from onehop.wire.log_writer import LOG_EPOCH_NS
from onehop.wire.records import MAGIC, Record, RecordError, walk
from onehop.wire.selection import WIRE

_CHUNK_BEGINS = re.compile(rb"\x06.{4}\0{4}.{6}[\xe0-\xff]\x0d.{6}[\xe0-\xff]\x0d", re.DOTALL)
"""Opcode, a length below 2^32 and two log times within 100 days after LOG_EPOCH_NS, as 64 bits each."""


class Loss(NamedTuple):
    """Bytes that cannot be read, and why."""

    at: int
    length: int
    why: str


class Piece(NamedTuple):
    """A sound stretch, and the first and last tick of its messages."""

    first_tick: int
    last_tick: int
    stretch: Stretch


@dataclass(slots=True)
class Survey:
    """What is sound: pieces in order of their ticks, metadata and attachments, schemas, channels by id.

    losses: in order of place. ended: the file has its regular end.
    """

    pieces: list[Piece] = field(default_factory=list)
    apart: list[Record] = field(default_factory=list)
    schemas: list[Schema] = field(default_factory=list)
    channels: dict[int, Channel] = field(default_factory=dict)
    losses: list[Loss] = field(default_factory=list)
    ended: bool = False


def survey(path: Path, period_ns: int) -> Survey:
    """Look through a log of ours."""
    found = Survey()
    looks: list[_Look] = []
    with path.open("rb") as stream:
        for contents in _segments(path, found):
            found.apart += contents.apart
            found.schemas += contents.schemas
            found.channels.update({channel.id: channel for channel in contents.channels})
            for stretch in contents.stretches:
                try:
                    looks.append(_look(stretch, stream, found, period_ns))
                except RecordError as error:
                    found.losses.append(Loss(stretch.at, stretch.length, error.why))
    for look in looks:
        try:
            found.pieces += _sound(look, found.channels)
        except RecordError as error:
            found.losses.append(Loss(look.stretch.at, look.stretch.length, error.why))
    found.pieces.sort(key=lambda piece: (piece.first_tick, piece.stretch.at))
    found.losses.sort()
    return found


def _segments(path: Path, found: Survey) -> Iterator[Contents]:
    """The file from each place where the chain of its records begins anew."""
    size = path.stat().st_size
    start: int | None = len(MAGIC)
    while start is not None:
        contents = read_contents(path, start)
        yield contents
        found.losses += (Loss(error.at, 0, error.why) for error in contents.unreadable)
        found.ended = not contents.torn and contents.broken is None
        if found.ended:
            return
        start = _next_chunk(path, contents.end)
        why = "the file ends before the log does" if contents.broken is None else contents.broken.why
        found.losses.append(Loss(contents.end, (start or size) - contents.end, why))


def _next_chunk(path: Path, start: int) -> int | None:
    """Where behind a byte a sound chunk begins, None if there is none."""
    if start >= path.stat().st_size:
        return None
    with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as file:
        for begin in _CHUNK_BEGINS.finditer(file, start):
            try:
                record = next(walk(stream, begin.start()))
                records_of(Stretch(record.start, record.length, 0, 0, is_chunk=True), stream)
            except (StopIteration, RecordError):
                continue
            return begin.start()
    return None


class _Look(NamedTuple):
    """What is in a stretch. used: its channels. mistimed: those with the log time of another tick."""

    stretch: Stretch
    ticks: set[int]
    used: set[int]
    mistimed: set[int]


def _look(stretch: Stretch, stream: BinaryIO, found: Survey, period_ns: int) -> _Look:
    """Look through a stretch, and take over its schemas and channels. Raises RecordError."""
    look = _Look(stretch, set(), set(), set())
    for record in parsed(records_of(stretch, stream)):
        if isinstance(record, Message):
            tick = tick_of(record, period_ns)
            look.ticks.add(tick)
            look.used.add(record.channel_id)
            if record.log_time != LOG_EPOCH_NS + record.sequence * period_ns:
                look.mistimed.add(record.channel_id)
        elif isinstance(record, Schema):
            found.schemas.append(record)
        elif found.channels.setdefault(record.id, record).topic != record.topic:
            raise RecordError(f"channel {record.id} has two topics")
    return look


def _sound(look: _Look, channels: dict[int, Channel]) -> Iterator[Piece]:
    """The stretch as a piece, if there are messages in it. Raises RecordError."""
    for number in sorted(look.used - channels.keys()):
        raise RecordError(f"a message of channel {number}, which there is not")
    for number in sorted(look.mistimed):
        if channels[number].topic.startswith(WIRE):
            raise RecordError(f"a message of {channels[number].topic} has the time of another tick")
    if look.ticks:
        yield Piece(min(look.ticks), max(look.ticks), look.stretch)


def tick_of(message: Message, period_ns: int) -> int:
    """The tick of a message, from its log time: other channels than ours count as they like."""
    return max(0, message.log_time - LOG_EPOCH_NS) // period_ns
