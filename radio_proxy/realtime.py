"""The shell of the radio in real time: it follows the world's clock, and waits for nobody.

What a robot hands to its NIC is in the air as soon as it is here, and what a robot receives goes
straight to it when its last bit has arrived. With each truth the account of the one before goes to the
world.
"""

import math
import time
from collections.abc import Callable, Iterable

from onehop.contracts import topics
from onehop.contracts.realtime import Handed, Heard, Placed
from onehop.node import startup
from onehop.node.bus import GONE, Bus
from onehop.wire.batch import pack_tick
from onehop.wire.codec import decode, encode
from onehop.wire.journal import WireMessage
from radio_proxy.core.bounds import Carrier
from radio_proxy.core.continuous import ContinuousRadio
from radio_proxy.core.event_queue import NEVER
from radio_proxy.simulated_clock import SimulatedClock

GRAIN_S = 0.0001
"""Events that lie closer together are taken at one wake-up [s]: an exchange of frames has eight."""

IDLE_S = 1.0
"""How long to sleep at most when nothing is in the air [s]."""

AHEAD_TICKS = 2
"""How far after the instant of a truth the radio goes at most: a tick lasts one, and the next truth may
be late by one. If it is later the world sets its clock back, and the radio would be ahead of it."""


class RealTimeRadio:
    """One mission. robots: ids of the team. speed: simulated seconds in one of the wall clock.

    period_ns: of a tick.
    """

    def __init__(
        self, bus: Bus, radio: Carrier, robots: Iterable[int], speed: float, period_ns: int
    ) -> None:
        self._bus = bus
        self._radio = ContinuousRadio(radio)
        self._clock = SimulatedClock(speed)
        self._put: dict[int, Callable[[bytes], None]] = {
            i: bus.publisher(topics.to(topics.robot_name(i), topics.HEARD), may_drop=True)
            for i in robots
        }
        self._put_carried = bus.publisher(topics.by(topics.RADIO, topics.CARRIED))
        self._delivered: list[WireMessage] = []
        self._anchor = 0
        self._tick = -1
        self._account = b""
        self._period_ns = period_ns
        self._latest_ns = NEVER

    def serve(self) -> int:
        """Until the end of the mission, or of the world; the exit status."""
        away_until_s = math.inf
        while time.monotonic() < away_until_s:
            received = self._bus.receive_by(min(self._wake_up_s(), away_until_s))
            if received is not None:
                what, data = received
                if what == topics.HANDED:
                    self._on_handed(decode(Handed, data))
                elif what == topics.PLACED:
                    self._on_placed(decode(Placed, data))
                elif what == topics.END:
                    return 0
                elif what == topics.alive(topics.WORLD):
                    away_until_s = time.monotonic() + startup.REUNION_S if data == GONE else math.inf
            if self._clock.is_set:
                now_ns = self._clock.now_ns(time.monotonic())
                self._deliver(self._radio.follow(min(now_ns, self._latest_ns)))
        return startup.WORLD_IS_GONE

    def _wake_up_s(self) -> float:
        now_s, due_ns = time.monotonic(), self._radio.next_event()
        if due_ns == NEVER or due_ns > self._latest_ns or not self._clock.is_set:
            return now_s + IDLE_S
        return min(max(self._clock.wall_s(due_ns), now_s + GRAIN_S), now_s + IDLE_S)

    def _on_handed(self, handed: Handed) -> None:
        self._clock.on_stamp(handed.sent_ns, time.monotonic(), self._anchor)
        at_ns = min(handed.sent_ns, self._latest_ns)
        self._deliver(self._radio.hand_over(handed.request, at_ns))

    def _on_placed(self, placed: Placed) -> None:
        if placed.truth.tick <= self._tick:  # again: the account of the one before may be lost
            if placed.truth.tick == self._tick and self._account:
                self._put_carried(self._account)
            return
        self._tick = placed.truth.tick
        self._anchor = placed.anchor
        self._clock.on_stamp(placed.sent_ns, time.monotonic(), placed.anchor)
        due, record = self._radio.close(placed.sent_ns)
        self._deliver(due)
        if record is not None:
            said = [(topics.RADIO_RECORD, encode(record)), *self._delivered]
            self._account = pack_tick(record.tick, said)
            self._put_carried(self._account)
            self._delivered = []
        self._deliver(self._radio.place(placed.truth, placed.sent_ns))
        self._latest_ns = placed.truth.time_ns + AHEAD_TICKS * self._period_ns

    def _deliver(self, due: Iterable[tuple[int, Heard]]) -> None:
        """Tell robots what they have received, and remember it for the world."""
        for robot, heard in due:
            data = encode(heard)
            self._put[robot](data)
            self._delivered.append((topics.rx(robot), data))
