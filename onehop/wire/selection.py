"""Pick messages out of a log by bus key and tick, without unpacking the rest.

A chunk whose ticks lie outside of the range is skipped, not even decompressed, and a message of another
key costs one look at its head. What is read is checked against itself: records, checksums, channels, and
that time goes forward.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from mcap.opcode import Opcode

from onehop.contracts import topics
from onehop.contracts.printable import printable
from onehop.wire.contents import Contents, damaged, records_of
from onehop.wire.log_writer import LOG_EPOCH_NS
from onehop.wire.records import MESSAGE, MESSAGE_RECORD, RECORD, RecordError, record_at, topic_of

WIRE = topics.wire("")
"""Beginning of the topics of wire channels."""

_LAST_TICK = (1 << 32) - 1
"""The sequence number of a message, which is its tick, has 32 bits."""


class Selected(NamedTuple):
    """One message as it crossed the wire. key: bus key, e.g. "out/3"."""

    tick: int
    key: str
    data: bytes


HEADS = RECORD.size + MESSAGE.size
"""What comes before the data of a message [B]."""

MESSAGE_OPCODE = int(Opcode.MESSAGE)
"""As a plain number: it is compared for every message."""

Wanted = Callable[[str], bool]
"""Says of a bus key whether its messages are wanted."""


def one_of(*keys: str) -> Wanted:
    """These keys; a key that ends in "/" stands for all robots, as in "out/"."""
    stems = tuple(key for key in keys if key.endswith("/"))

    def wanted(key: str) -> bool:
        return key in keys or key.startswith(stems)

    return wanted


@dataclass(frozen=True, slots=True)
class WireMessages:
    """The wire messages of a log. keys: every key that a log of this mission can have."""

    path: Path
    contents: Contents
    keys: frozenset[str]
    period_ns: int

    def select(
        self, wanted: Wanted, first_tick: int = 0, last_tick: int | None = None
    ) -> Iterator[Selected]:
        """Wanted messages of first_tick..last_tick, in the order of the log; stops where it is torn.

        Raises LogError where the log is not sound.
        """
        final = _LAST_TICK if last_tick is None else last_tick
        begin_ns = LOG_EPOCH_NS + first_tick * self.period_ns
        end_ns = LOG_EPOCH_NS + final * self.period_ns
        reader = _Reader(wanted, self.keys, self.period_ns, first_tick, final)
        channels, stretches = self.contents.channels, self.contents.stretches
        at = 0
        with self.path.open("rb") as stream:
            try:
                for channel in channels:
                    reader.learn(channel.id, channel.topic)
                for stretch in self.contents.stretches_of(begin_ns if channels else 0, end_ns):
                    at = stretch.at
                    yield from reader.messages(records_of(stretch, stream))
                broken = self.contents.broken
                if broken is not None and not (stretches and stretches[-1].first_ns > end_ns):
                    raise broken
            except RecordError as error:
                raise damaged(self.path, max(at, error.at), error.why) from None


class _Reader:
    """Reads stretches one after the other. Raises RecordError."""

    def __init__(
        self, wanted: Wanted, known: frozenset[str], period_ns: int, first_tick: int, last_tick: int
    ) -> None:
        self._wanted, self._known = wanted, known
        self._period_ns = period_ns
        self._first_tick, self._last_tick = first_tick, last_tick
        self._topics: dict[int, str] = {}
        self._keys: dict[int, str] = {}
        self._tick, self._time_ns = -1, 0

    def learn(self, channel: int, topic: str) -> None:
        """The topic of a channel: always the same one, and of wire channels one that a mission has."""
        before = self._topics.setdefault(channel, topic)
        if before != topic:
            raise RecordError(f"channel {channel} is {_quoted(before)} and {_quoted(topic)}")
        key = topic.removeprefix(WIRE)
        if not topic.startswith(WIRE):
            return
        if key not in self._known:
            raise RecordError(f"this mission has no channel {_quoted(topic)}")
        if self._wanted(key):
            self._keys[channel] = key

    def messages(self, data: bytes) -> Iterator[Selected]:
        """The wanted messages among records: one look at each, since a log is little but messages."""
        unpack, keys, known = MESSAGE_RECORD.unpack_from, self._keys, self._topics
        first, last = self._first_tick, self._last_tick
        at, length = 0, len(data)
        while at < length:
            if at + MESSAGE_RECORD.size <= length:
                opcode, size, channel, tick, time_ns = unpack(data, at)
                begin, end = at + HEADS, at + RECORD.size + size
                if opcode == MESSAGE_OPCODE and begin <= end <= length:
                    at = end
                    if channel in keys:
                        if tick != self._tick or time_ns != self._time_ns:
                            self._on_tick(tick, time_ns)
                        if first <= tick <= last:
                            yield Selected(tick, keys[channel], data[begin:end])
                    elif channel not in known:
                        raise RecordError(f"a message of channel {channel}, which there is not")
                    continue
            opcode, begin, at = record_at(data, at)
            if opcode == Opcode.CHANNEL:
                self.learn(*topic_of(data[begin:at]))

    def _on_tick(self, tick: int, time_ns: int) -> None:
        if time_ns != LOG_EPOCH_NS + tick * self._period_ns:
            raise RecordError(f"a message of tick {tick} has the log time of another")
        if tick < self._tick:
            raise RecordError(f"tick {tick} comes after tick {self._tick}")
        self._tick, self._time_ns = tick, time_ns


def _quoted(topic: str) -> str:
    return repr(printable(topic, 60))
