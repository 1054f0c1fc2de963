"""A sound log from a torn or damaged one: everything up to the tear, in whole ticks.

Records are copied, not understood, so that a viewer layer or metadata of a later version survive too.
The last tick of a torn log is given up unless everything that world, radio and robots owe each other in
a tick is there; nothing before it is ever left out.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgpack
from mcap.exceptions import EndOfFile, McapError
from mcap.records import Message, Metadata
from mcap.stream_reader import StreamReader
from zstandard import ZstdError

from onehop.analysis.copying import LogCopy
from onehop.contracts import topics
from onehop.wire.log_reader import LogFile

_WIRE = topics.wire("")


@dataclass(frozen=True, slots=True)
class Salvage:
    """What was saved and what was lost. last_tick: -1 when no tick was whole.

    given_up: messages of the unfinished last tick. unread_bytes: bytes of the file after the last whole
    record. damage: why reading stopped, "" at the end of a sound file. ended: the outcome is there.
    """

    last_tick: int
    messages: int
    given_up: int
    unread_bytes: int
    damage: str
    ended: bool


class _Tail:
    """Reads records until the file ends or makes no sense, and remembers where and why."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.good = 0
        self.damage = ""

    def records(self) -> Iterator[Any]:
        with self._path.open("rb") as stream:
            try:
                for record in StreamReader(stream, validate_crcs=True).records:
                    yield record
                    self.good = stream.tell()
            except (EndOfFile, struct.error):  # the latter where an index is torn
                self.damage = "the file ends before the log does"
            except (McapError, ValueError, ZstdError) as error:
                self.damage = f"damaged near byte {stream.tell()}: {error}"


class _Rescue:
    """Copies records into a new file; whole ticks only."""

    def __init__(self, copy: LogCopy) -> None:
        self._copy = copy
        self._pending: list[Message] = []
        self.last_tick = -1
        self.messages = 0
        self.ended = False

    def take(self, record: Any) -> None:
        if isinstance(record, Message):
            if self._pending and self._pending[0].sequence != record.sequence:
                self._write_pending()
            self._pending.append(record)
            return
        if isinstance(record, Metadata) and record.name == "outcome":
            self.ended = True
            self._write_pending()
        self._copy.take(record)

    def _write_pending(self) -> None:
        for message in self._pending:
            self._copy.take_message(message)
        if self._pending:
            self.last_tick = self._pending[0].sequence
            self.messages += len(self._pending)
        self._pending = []

    def finish(self, torn: bool) -> int:
        """Close the file; returns how many messages of an unfinished last tick were given up."""
        if not torn or self._is_whole():
            self._write_pending()
        self._copy.finish()
        return len(self._pending)

    def _is_whole(self) -> bool:
        data = {self._copy.keys[m.channel_id].removeprefix(_WIRE): m.data for m in self._pending}
        if topics.TRUTH not in data or topics.RADIO_RECORD not in data:
            return False
        robots = [one["robot"] for one in msgpack.unpackb(data[topics.TRUTH])["present"]]
        owed = (key(robot) for robot in robots for key in (topics.rx, topics.obs, topics.out))
        return all(key in data for key in owed)


def salvage(torn: Path, out: Path) -> Salvage:
    """Write a sound log to `out`. Raises LogError when `torn` is no log of ours at all."""
    LogFile(torn)
    tail = _Tail(torn)
    with LogCopy(out, "salvaged") as copy:
        rescue = _Rescue(copy)
        for record in tail.records():
            rescue.take(record)
        given_up = rescue.finish(torn=bool(tail.damage))
    unread = torn.stat().st_size - tail.good if tail.damage else 0
    return Salvage(rescue.last_tick, rescue.messages, given_up, unread, tail.damage, rescue.ended)
