"""The record of a mission in real time: put together when all of a tick is there, and never waited for.

What robots have taken in from the radio comes to the world with the radio's account of the tick, a tick
later. A recorder that does not keep up costs ticks of the log, and no time of the mission.
"""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from onehop.contracts import topics
from onehop.contracts.messages import Heard, Lateness
from onehop.node.bus import Bus
from onehop.wire.batch import TickMessages, pack_ticks
from onehop.wire.codec import decode, encode
from onehop.wire.heard import inbox_of
from onehop.wire.journal import WireMessage
from world_server.mailbox import Mailbox
from world_server.realtime.robots import Answers, Given

BATCH_TICKS = 3
"""Ticks that go to the recorder at once."""

BATCH_BYTES = 1 << 16
"""The same [B]: a batch ends with the tick that exceeds it."""

UNDER_WAY_BYTES = 1 << 17
"""What may be under way to the recorder when a batch is sent [B]. With the batch that is less than
Zenoh's queue (two of 64 KiB) and the buffers of a connection hold: no put waits for the recorder."""

WAITING_BYTES = 1 << 26
"""What waits in the world at most until the recorder has caught up [B]; what comes then is left out."""


@dataclass(slots=True)
class _Tick:
    """A tick in the making. said: by the radio. answers: that counted at its end."""

    messages: list[WireMessage]
    said: list[WireMessage] | None = None
    answers: dict[int, Given] | None = None


@dataclass(slots=True)
class _Store:
    """What the radio has told one robot and went into no answer yet, by number. last: that did so."""

    heard: dict[int, Heard] = field(default_factory=dict)
    last: int = 0


class RealTimeRecording:
    """The world's side of the record.

    period_ns: of a tick. on_lie: told of robots that name what they were not given.
    last_tick: the last one that was sent. left_out: ticks that the recorder was too slow for.
    """

    def __init__(self, bus: Bus, mail: Mailbox, period_ns: int, on_lie: Callable[[int], None]) -> None:
        self._put_ticks = bus.publisher(topics.to(topics.RECORDER, topics.TICKS), express=False)
        self._period_ns = period_ns
        self._on_lie = on_lie
        self._open: dict[int, _Tick] = {}
        self._stores: dict[int, _Store] = {}
        self._waiting: deque[tuple[int, TickMessages]] = deque()
        self._waiting_bytes = 0
        self._under_way: deque[tuple[int, int]] = deque()
        self._under_way_bytes = 0
        self.last_tick = -1
        self.left_out = 0
        mail.read(topics.RECORDER, topics.RECORDED, self._on_recorded)

    def begin(self, tick: int, messages: list[WireMessage]) -> None:
        """A tick begins with its truth and observations."""
        self._open[tick] = _Tick(messages)

    def note_late(self, tick: int, late_s: float) -> None:
        """This tick began late."""
        late = Lateness(tick, tick * self._period_ns, round(late_s * 1e9))
        self._open[tick].messages.append((topics.LATE, encode(late)))

    def end(self, tick: int, answers: Answers) -> None:
        """A tick ends with these answers."""
        self._open[tick].answers = answers.given

    def take(self, said: TickMessages) -> None:
        """The radio's account of a tick, and what it has told robots in it."""
        tick, messages = said
        if tick not in self._open:
            return
        self._open[tick].said = [one for one in messages if one[0] == topics.RADIO_RECORD]
        for key, data in messages:
            stem, _, robot = key.partition("/")
            if stem == "rx":
                heard = decode(Heard, data)
                self._stores.setdefault(int(robot), _Store()).heard[heard.number] = heard
        self._complete()

    def hand_over(self) -> None:
        """Send all that is whole, at the end of the mission; the rest is left out."""
        self._complete()
        self.left_out += sum(1 for one in self._open.values() if one.answers is not None)
        self._open.clear()
        self._send(least=1)

    def _complete(self) -> None:
        """Put together the ticks of which all is there."""
        while self._open:
            tick, one = next(iter(self._open.items()))
            if one.said is None or one.answers is None:
                break
            del self._open[tick]
            messages = [*one.messages, *one.said]
            for robot, given in one.answers.items():
                messages.append((topics.out(robot), given.data))
                messages.append((topics.rx(robot), self._inbox(robot, given)))
            self._add(tick, messages)
        self._send(BATCH_TICKS)

    def _inbox(self, robot: int, given: Given) -> bytes:
        """What a robot has taken in for its answer, as one inbox."""
        store = self._stores.setdefault(robot, _Store())
        named: list[Heard] = []
        for number in given.heard:
            heard = store.heard.get(number)
            if heard is None or number <= store.last:
                self._on_lie(robot)
                continue
            named.append(heard)
            store.last = number
        store.heard = {number: one for number, one in store.heard.items() if number > store.last}
        tick = given.action.tick
        return encode(inbox_of(tick, tick * self._period_ns, named))

    def _add(self, tick: int, messages: list[WireMessage]) -> None:
        size = _size(messages)
        if self._waiting_bytes + size > WAITING_BYTES:
            self.left_out += 1
            return
        self._waiting.append((size, (tick, messages)))
        self._waiting_bytes += size

    def _send(self, least: int) -> None:
        while len(self._waiting) >= least and (self._under_way_bytes < UNDER_WAY_BYTES or least == 1):
            batch: list[TickMessages] = []
            bytes_of_batch = 0
            while self._waiting and len(batch) < BATCH_TICKS and bytes_of_batch < BATCH_BYTES:
                size, tick = self._waiting.popleft()
                bytes_of_batch += size
                batch.append(tick)
            self._waiting_bytes -= bytes_of_batch
            self.last_tick = batch[-1][0]
            self._under_way.append((self.last_tick, bytes_of_batch))
            self._under_way_bytes += bytes_of_batch
            self._put_ticks(pack_ticks(batch))

    def _on_recorded(self, data: bytes) -> None:
        in_file = int.from_bytes(data, "little")
        while self._under_way and self._under_way[0][0] <= in_file:
            self._under_way_bytes -= self._under_way.popleft()[1]
        self._send(BATCH_TICKS)


def _size(messages: Iterable[WireMessage]) -> int:
    return sum(len(key) + len(data) for key, data in messages)
