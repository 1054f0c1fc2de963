"""The radio as the world speaks to it in real time: nobody waits for an answer."""

import time
from collections import deque
from collections.abc import Callable

from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import TransmitRequest, Truth
from onehop.contracts.realtime import Handed, Placed
from onehop.node.bus import Bus
from onehop.wire.batch import TickMessages, unpack_tick
from onehop.wire.codec import encode
from world_server.mailbox import Mailbox, MissionBrokenError
from world_server.realtime.schedule import Schedule
from world_server.roll_call import ACCOUNT_S, RollCall


class RealTimeRadio:
    """The radio process. take: is given what it says of a tick. silence_s: its patience [s]."""

    def __init__(
        self,
        bus: Bus,
        mail: Mailbox,
        roll: RollCall,
        schedule: Schedule,
        take: Callable[[TickMessages], None],
        silence_s: float,
    ) -> None:
        self._mail = mail
        self._roll = roll
        self._schedule = schedule
        self._take = take
        self._silence_s = silence_s
        self._put_placed = bus.publisher(topics.to(topics.RADIO, topics.PLACED))
        self._put_handed = bus.publisher(topics.to(topics.RADIO, topics.HANDED))
        self._heard_s: float | None = None
        self._unaccounted: deque[tuple[int, bytes]] = deque()
        self.last_tick = -1
        roll.when_present(topics.RADIO, self._send_again)
        mail.read(topics.RADIO, topics.CARRIED, self._on_carried)

    def place(self, truth: Truth) -> None:
        """Tell where everybody is from now on. Raises MissionBrokenError when there is no radio."""
        if topics.RADIO not in self._roll.present:
            self._mail.wait(lambda: False, 2.0 * ACCOUNT_S)  # until it is known how it ended
            raise MissionBrokenError("the radio is gone")
        now_s = time.monotonic()
        if self._heard_s is None:
            self._heard_s = now_s
        if now_s - self._heard_s > self._silence_s:
            raise MissionBrokenError(f"the radio is silent for {self._silence_s:g} s")
        schedule = self._schedule
        placed = encode(Placed(schedule.clock_ns(now_s), schedule.anchor, truth))
        self._unaccounted.append((truth.tick, placed))
        self._put_placed(placed)

    def excuse(self) -> None:
        """Nobody could be heard: the radio's patience begins anew."""
        self._heard_s = time.monotonic()

    def _send_again(self) -> None:
        """The radio is back: truths without an account may be lost. It knows what it has."""
        for _, placed in self._unaccounted:
            self._put_placed(placed)

    def hand_over(self, request: TransmitRequest) -> None:
        """A robot has handed something to its NIC."""
        self._put_handed(encode(Handed(self._schedule.clock_ns(time.monotonic()), request)))

    def _on_carried(self, data: bytes) -> None:
        try:
            said = unpack_tick(data)
        except DecodeError as error:
            raise MissionBrokenError(f"the radio put no {error}") from None
        self._heard_s = time.monotonic()
        self.last_tick = said[0]
        while self._unaccounted and self._unaccounted[0][0] <= self.last_tick:
            self._unaccounted.popleft()
        self._take(said)
