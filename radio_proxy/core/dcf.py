"""The distributed coordination function of 802.11, event by event (802.11-1999, 9.2).

Carrier sense, backoff that freezes while the medium is busy, RTS/CTS or basic access, retries with a
growing window, and the event queue that everything above shares. Stations are indices.

Differs: a station that finds the medium idle waits a whole DIFS from that moment, because both measured
references (ns-3's idle exchange of 7.542 ms, thesis eq. 3.16) count it. A frame handed over in the same
instant as another station's draws a backoff, because ticks would otherwise make them collide always.
"""

import heapq
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from onehop.contracts.airtime import ACK_BYTES, RTS_BYTES
from onehop.contracts.messages import Fate
from radio_proxy.core.airtime import Timing, delay_ns
from radio_proxy.core.draws import Draws
from radio_proxy.core.medium import Emission, Medium, Reservation

EVERYONE = -1
"""Receiver of a broadcast frame."""

NEVER = 1 << 62

Event = Callable[[Any, int], None]


@dataclass(slots=True, eq=False)
class Frame:
    """One MSDU for one hop. receiver: station index or EVERYONE; packet: opaque to this layer.

    service_start: when it became the head of its queue [ns]. sinr_db, cause: of the last frame of its
    exchange that was judged at a receiver.
    """

    receiver: int
    msdu_bytes: int
    packet: object
    service_start: int = -1
    attempts: int = 0
    received: bool = False
    sinr_db: float = 0.0
    cause: Fate | None = None


class Listener(Protocol):
    """The layer above: what becomes of frames."""

    def on_service(self, sender: int, frame: Frame, now: int) -> None: ...
    def on_received(self, receiver: int, sender: int, frame: Frame, now: int) -> None: ...
    def on_broadcast_done(self, sender: int, frame: Frame, emission: Emission, now: int) -> None: ...
    def on_acknowledged(self, sender: int, frame: Frame, now: int) -> None: ...
    def on_undeliverable(self, sender: int, frame: Frame, now: int) -> None: ...


@dataclass(slots=True, eq=False)
class Station:
    """A network card. slots: backoff left. access: when it will speak, NEVER while frozen [ns].

    idle_start: from when its DIFS counts [ns]. fresh: its head found the medium idle, so it has drawn
    no backoff yet. gone: its robot left; events that still name it are void.
    """

    index: int
    queue: deque[Frame] = field(default_factory=deque)
    frame: Frame | None = None
    slots: int = 0
    access: int = NEVER
    idle_start: int = 0
    contending: bool = False
    fresh: bool = False
    gone: bool = False


@dataclass(slots=True, eq=False)
class Exchange:
    """One attempt to send a frame: who, to whom, over what distance, with which fading."""

    sender: Station
    receiver: Station
    frame: Frame
    delay: int
    fade_db: float | None
    emission: Emission


class Dcf:
    """All cards of a mission on one medium, and the events of the radio in order of time."""

    def __init__(
        self,
        count: int,
        timing: Timing,
        medium: Medium,
        draws: Draws,
        listener: Listener,
        *,
        retry_limit: int,
        queue_frames: int,
        rts_threshold_bytes: int,
        fade_per_exchange: bool,
    ) -> None:
        self.timing = timing
        self.medium = medium
        self._draws = draws
        self._listener = listener
        self._retry_limit = retry_limit
        self._queue_frames = queue_frames
        self._rts_threshold_bytes = rts_threshold_bytes
        self._fade_per_exchange = fade_per_exchange
        self._stations = [Station(i) for i in range(count)]
        self._contenders: list[Station] = []
        self._next_access = NEVER
        self._next_station: Station | None = None
        self._events: list[tuple[int, int, Event, Any]] = []
        self._sequence = 0

    def at(self, time_ns: int, event: Event, argument: Any) -> None:
        """Call event(argument, time_ns) at that time; events of one instant in order of this call."""
        self._sequence += 1
        heapq.heappush(self._events, (time_ns, self._sequence, event, argument))

    def run(self, until: int) -> None:
        """Everything that happens up to and including `until` [ns]."""
        events = self._events
        while True:
            time_ns = events[0][0] if events else NEVER
            if self._next_access < time_ns:
                if self._next_access > until:
                    return
                station = self._next_station
                assert station is not None
                self._on_access(station, self._next_access)
            else:
                if time_ns > until:
                    return
                _, _, event, argument = heapq.heappop(events)
                event(argument, time_ns)

    def enqueue(self, index: int, frame: Frame, now: int, hold_back: bool) -> bool:
        """Give a frame to a card; False when its queue is full. hold_back: draw a backoff anyway."""
        station = self._stations[index]
        if len(station.queue) + (station.frame is not None) >= self._queue_frames:
            return False
        station.queue.append(frame)
        if station.frame is None:
            self._serve(station, now, hold_back)
        return True

    def remove(self, index: int) -> list[Frame]:
        """A robot left: its card dies with everything in it, which is returned in order of service."""
        station = self._stations[index]
        station.gone = True
        if station.contending:
            self._contenders.remove(station)
            self._reschedule()
        self._stations[index] = Station(index)
        head = [] if station.frame is None else [station.frame]
        return head + list(station.queue)

    def _serve(self, station: Station, now: int, hold_back: bool) -> None:
        """The head of the queue comes into service; it waits out a backoff that is still running."""
        station.frame = frame = station.queue.popleft()
        frame.service_start = now
        self._listener.on_service(station.index, frame, now)
        if station.contending:
            return
        busy = self.medium.is_busy(station.index)
        if hold_back or busy or self.medium.reserved_until(station.index, now) > now:
            station.slots = self._draws.slots(self.timing.window(0))
        else:
            station.slots = 0
            station.fresh = True
        self._contend(station, now)

    def _contend(self, station: Station, now: int) -> None:
        station.contending = True
        self._contenders.append(station)
        station.access = NEVER
        if not self.medium.is_busy(station.index):
            self._resume(station, now)
        self._reschedule()

    def _resume(self, station: Station, now: int) -> None:
        station.idle_start = start = self.medium.reserved_until(station.index, now)
        station.access = start + self.timing.difs + station.slots * self.timing.slot

    def _freeze(self, station: Station, emission: Emission, now: int) -> None:
        """The medium turned busy: keep the slots that have not passed (802.11-1999, 9.2.5.2)."""
        elapsed = now - station.idle_start - self.timing.difs
        if elapsed > 0:
            station.slots -= elapsed // self.timing.slot
        if station.fresh and emission.source != station.index:
            station.fresh = False
            station.slots = self._draws.slots(self.timing.window(0))
        station.access = NEVER

    def _reschedule(self) -> None:
        self._next_access = NEVER
        for station in self._contenders:
            if station.access < self._next_access:
                self._next_access = station.access
                self._next_station = station

    def _begin(self, station: Station, fade_db: float | None, now: int) -> Emission:
        """Start to emit; everyone who senses it freezes, except who is about to speak itself."""
        emission = self.medium.begin(station.index, fade_db)
        committed = now + self.timing.turnaround
        for other in self._contenders:
            if committed < other.access < NEVER and self.medium.senses(other.index, emission):
                self._freeze(other, emission, now)
        self._reschedule()
        return emission

    def _end(self, emission: Emission, now: int, answerer: int = EVERYONE) -> None:
        """Stop to emit; who finds the medium idle goes on, except who will sense the answer at once."""
        self.medium.end(emission)
        row = self.medium.field.row(answerer) if answerer != EVERYONE else None
        sense_db = self.medium.field.budget.carrier_sense_db
        for other in self._contenders:
            if other.access != NEVER or (row is not None and row[other.index] >= sense_db):
                continue
            if not self.medium.is_busy(other.index):
                self._resume(other, now)
        self._reschedule()

    def _on_access(self, station: Station, now: int) -> None:
        """A station's wait is over: it speaks, or it has only finished its backoff after a success."""
        station.contending = station.fresh = False
        station.slots = 0
        station.access = NEVER
        self._contenders.remove(station)
        frame = station.frame
        if frame is None:
            self._reschedule()
            return
        frame.attempts += 1
        fade_db = self.medium.fade_db() if self._fade_per_exchange else None
        emission = self._begin(station, fade_db, now)
        if frame.receiver == EVERYONE:
            delay = delay_ns(self.medium.field.farthest(station.index))
            end = now + self.timing.broadcast(frame.msdu_bytes) + delay
            exchange = Exchange(station, station, frame, delay, fade_db, emission)
            self.at(end, self._on_broadcast_end, exchange)
            return
        receiver = self._stations[frame.receiver]
        delay = delay_ns(self.medium.field.distance(station.index, receiver.index))
        exchange = Exchange(station, receiver, frame, delay, fade_db, emission)
        if frame.msdu_bytes > self._rts_threshold_bytes:
            self.at(now + self.timing.rts + delay, self._on_rts_end, exchange)
        else:
            self.at(now + self.timing.data(frame.msdu_bytes) + delay, self._on_data_end, exchange)

    def _on_broadcast_end(self, exchange: Exchange, now: int) -> None:
        sender = exchange.sender
        self._end(exchange.emission, now)
        if not sender.gone:
            frame = self._finish(sender, now)
            self._listener.on_broadcast_done(sender.index, frame, exchange.emission, now)
            self._serve_next(sender, now)

    def _hears(self, exchange: Exchange, at: Station, rate_mbps: float, size_bytes: int) -> bool:
        """Judge the frame on the air at one end of the exchange, and remember what kept it away."""
        if exchange.sender.gone or exchange.receiver.gone:
            exchange.frame.cause = Fate.RECEIVER_GONE
            return False
        cause, sinr_db = self.medium.receive(exchange.emission, at.index, rate_mbps, 8 * size_bytes)
        exchange.frame.cause, exchange.frame.sinr_db = cause, sinr_db
        return cause is None

    def _reserve(self, exchange: Exchange, now: int, frames: int, airtime: int) -> Reservation:
        """The duration field: so many frames of so much airtime are still to come in this exchange."""
        until = now + frames * (self.timing.sifs + exchange.delay) + airtime
        ends = exchange.sender.index, exchange.receiver.index
        return self.medium.reserve(exchange.emission, *ends, until, now)

    def _on_rts_end(self, exchange: Exchange, now: int) -> None:
        timing, receiver = self.timing, exchange.receiver
        data = timing.data(exchange.frame.msdu_bytes)
        heard = self._hears(exchange, receiver, timing.basic_rate_mbps, RTS_BYTES)
        if heard and self.medium.reserved_until(receiver.index, now) > now:
            exchange.frame.cause = Fate.RETRY_LIMIT
            heard = False
        reservation = self._reserve(exchange, now, 3, timing.cts + data + timing.ack)
        if heard:
            self.at(now + timing.sifs, self._send_cts, exchange)
            self._end(exchange.emission, now, receiver.index)
            return
        self._end(exchange.emission, now)
        self.at(now - exchange.delay + timing.answer_timeout, self._on_timeout, exchange)
        silence = 2 * timing.sifs + timing.cts + 2 * timing.slot
        self.at(now + silence, self._on_reservation_unused, reservation)

    def _on_reservation_unused(self, reservation: Reservation, now: int) -> None:
        self.medium.release(reservation)
        for station in self._contenders:
            if station.idle_start > now and station.access != NEVER:
                self._resume(station, now)
        self._reschedule()

    def _send_cts(self, exchange: Exchange, now: int) -> None:
        if self._answer(exchange, exchange.receiver, now):
            self.at(now + self.timing.cts + exchange.delay, self._on_cts_end, exchange)

    def _on_cts_end(self, exchange: Exchange, now: int) -> None:
        timing, sender = self.timing, exchange.sender
        heard = self._hears(exchange, sender, timing.basic_rate_mbps, ACK_BYTES)
        self._reserve(exchange, now, 2, timing.data(exchange.frame.msdu_bytes) + timing.ack)
        if heard:
            self.at(now + timing.sifs, self._send_data, exchange)
            self._end(exchange.emission, now, sender.index)
            return
        self._end(exchange.emission, now)
        asked = now - timing.cts - timing.sifs - 2 * exchange.delay
        self.at(max(now, asked + timing.answer_timeout), self._on_timeout, exchange)

    def _send_data(self, exchange: Exchange, now: int) -> None:
        if self._answer(exchange, exchange.sender, now):
            end = now + self.timing.data(exchange.frame.msdu_bytes) + exchange.delay
            self.at(end, self._on_data_end, exchange)

    def _on_data_end(self, exchange: Exchange, now: int) -> None:
        timing, receiver, frame = self.timing, exchange.receiver, exchange.frame
        size_bytes = timing.mac_header_bytes + frame.msdu_bytes
        heard = self._hears(exchange, receiver, timing.rate_mbps, size_bytes)
        if not exchange.sender.gone:
            self._reserve(exchange, now, 1, timing.ack)
        if not heard:
            self._end(exchange.emission, now)
            self.at(now - exchange.delay + timing.answer_timeout, self._on_timeout, exchange)
            return
        self.at(now + timing.sifs, self._send_ack, exchange)
        self._end(exchange.emission, now, receiver.index)
        if not frame.received:
            frame.received = True
            self._listener.on_received(receiver.index, exchange.sender.index, frame, now)

    def _send_ack(self, exchange: Exchange, now: int) -> None:
        if self._answer(exchange, exchange.receiver, now):
            self.at(now + self.timing.ack + exchange.delay, self._on_ack_end, exchange)

    def _on_ack_end(self, exchange: Exchange, now: int) -> None:
        timing, sender = self.timing, exchange.sender
        heard = self._hears(exchange, sender, timing.basic_rate_mbps, ACK_BYTES)
        self._end(exchange.emission, now)
        if not heard:
            asked = now - timing.ack - timing.sifs - 2 * exchange.delay
            self.at(max(now, asked + timing.answer_timeout), self._on_timeout, exchange)
        elif not sender.gone:
            frame = self._finish(sender, now)
            self._listener.on_acknowledged(sender.index, frame, now)
            self._serve_next(sender, now)

    def _answer(self, exchange: Exchange, speaker: Station, now: int) -> bool:
        """Emit the next frame of an exchange a SIFS after the last; False when its speaker has left."""
        if speaker.gone:
            self.at(now + self.timing.answer_timeout, self._on_timeout, exchange)
            return False
        exchange.emission = self._begin(speaker, exchange.fade_db, now)
        return True

    def _on_timeout(self, exchange: Exchange, now: int) -> None:
        """No answer: another attempt after a longer backoff, or the end of this frame."""
        sender, frame = exchange.sender, exchange.frame
        if sender.gone:
            return
        if frame.attempts < self._retry_limit:
            sender.slots = self._draws.slots(self.timing.window(frame.attempts))
            self._contend(sender, now)
            return
        self._finish(sender, now)
        self._listener.on_undeliverable(sender.index, frame, now)
        self._serve_next(sender, now)

    def _finish(self, station: Station, now: int) -> Frame:
        """The head leaves the card; a backoff follows in any case (802.11-1999, 9.2.5.2)."""
        frame = station.frame
        assert frame is not None
        station.frame = None
        station.slots = self._draws.slots(self.timing.window(0))
        self._contend(station, now)
        return frame

    def _serve_next(self, station: Station, now: int) -> None:
        if station.frame is None and station.queue:
            self._serve(station, now, hold_back=True)
