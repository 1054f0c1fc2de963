"""What goes to the recorder, and how far the world may be ahead of the file."""

from onehop.contracts import topics
from onehop.node.bus import Bus
from onehop.wire.batch import TickMessages, pack_ticks
from onehop.wire.journal import WireMessage
from world_server.mailbox import Mailbox, MissionBrokenError

BATCH_TICKS = 3
"""Ticks that go to the recorder at once."""

WINDOW_TICKS = 5
"""Ticks that the world may be ahead of the file: what a kill -9 of the recorder can cost at most."""


class Recording:
    """The world's side of the record. silence_s: how long the recorder may take, wall clock [s]."""

    def __init__(self, bus: Bus, mail: Mailbox, silence_s: float) -> None:
        self._mail = mail
        self._silence_s = silence_s
        self._put_ticks = bus.publisher(topics.to(topics.RECORDER, topics.TICKS), express=False)
        self._batch: list[TickMessages] = []
        self._in_file = -1
        self.last_tick = -1
        mail.read(topics.RECORDER, topics.RECORDED, self._on_recorded)

    def add(self, tick: int, messages: list[WireMessage]) -> None:
        """Record a tick, as soon as the file is not too far behind. Raises MissionBrokenError."""
        if not self._mail.wait(lambda: tick - self._in_file <= WINDOW_TICKS, self._silence_s):
            raise MissionBrokenError("the recorder does not keep up")
        self._batch.append((tick, messages))
        self.last_tick = tick

    def hand_over_batch(self) -> None:
        """Send what has been added if it is a whole batch: at a moment when somebody else is at work."""
        if len(self._batch) >= BATCH_TICKS:
            self.hand_over()

    def hand_over(self) -> None:
        """Send what has been added and not been sent."""
        if self._batch:
            self._put_ticks(pack_ticks(self._batch))
            self._batch.clear()

    def _on_recorded(self, data: bytes) -> None:
        self._in_file = int.from_bytes(data, "little")
