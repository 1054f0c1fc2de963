"""The distributed coordination function of 802.11: exchanges, retries, queues (802.11-1999, 9.2).

Here is also the event queue that everything above shares. Stations are indices.

A broadcast is sent once, without RTS, ACK or repetition (9.2.7): beacons of two teams, and requests that
neighbours pass on, may collide and are then lost. That is the standard's way, and nothing above relies
on any single one: beacons come every period, requests are jittered and repeated.

An exchange that nobody can disturb is taken in three events instead of eight: every station senses both
of its ends, nothing else is on the air, nobody is about to speak, and it ends before the horizon. Its
frames are judged as ever; only the gaps of a SIFS, in which nobody may speak, are not played.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from onehop.contracts.ideal_link import ACK_BYTES, RTS_BYTES
from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.airtime import Timing, delay_ns
from radio_proxy.core.contention import EVERYONE, NEVER, Contention, Frame, Station
from radio_proxy.core.draws import Draws
from radio_proxy.core.medium import Emission, Medium, Reservation

Callback = Callable[[Any, int], None]
Judgement = tuple[DeliveryStatus | None, float]


class Listener(Protocol):
    """The layer above: what becomes of frames."""

    def on_service(self, sender: int, frame: Frame, now: int) -> None: ...
    def on_received(self, receiver: int, sender: int, frame: Frame, now: int) -> None: ...
    def on_broadcast_done(self, sender: int, frame: Frame, emission: Emission, now: int) -> None: ...
    def on_acknowledged(self, sender: int, frame: Frame, now: int) -> None: ...
    def on_undeliverable(self, sender: int, frame: Frame, now: int) -> None: ...


@dataclass(slots=True, eq=False)
class Exchange:
    """One attempt to send a frame: who, to whom, over what distance, with which fading.

    quiet: nobody can disturb it. foreseen: frames that were judged before they end.
    """

    sender: Station
    receiver: Station
    frame: Frame
    delay: int
    fade_db: float | None
    emission: Emission
    quiet: bool = False
    foreseen: list[Judgement] = field(default_factory=list)


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
        take_shortcuts: bool = True,
    ) -> None:
        self.timing = timing
        self.medium = medium
        self._listener = listener
        self._retry_limit = retry_limit
        self._queue_frames = queue_frames
        self._rts_threshold_bytes = rts_threshold_bytes
        self._fade_per_exchange = fade_per_exchange
        self._take_shortcuts = take_shortcuts
        self._stations = [Station(i) for i in range(count)]
        self._contention = Contention(timing, medium, draws)
        self._events: list[tuple[int, int, Callback, Any]] = []
        self._sequence = 0
        self._horizon = 0

    def at(self, time_ns: int, event: Callback, argument: Any) -> None:
        """Call event(argument, time_ns) at that time; events of one instant in order of this call."""
        self._sequence += 1
        heapq.heappush(self._events, (time_ns, self._sequence, event, argument))

    def run(self, until: int) -> None:
        """Everything that happens up to and including `until` [ns]."""
        self._horizon = until
        events, contention = self._events, self._contention
        while True:
            time_ns = events[0][0] if events else NEVER
            if contention.next_access < time_ns:
                if contention.next_access > until:
                    return
                self._on_access(contention.next_access)
            else:
                if time_ns > until:
                    return
                _, _, event, argument = heapq.heappop(events)
                event(argument, time_ns)

    def enqueue(self, index: int, frame: Frame, now: int, hold_back: bool) -> bool:
        """Give a frame to a card; False when its queue is full. hold_back: draw a backoff anyway.

        Routing packets wait before data, as in the card of Das, Perkins and Royer, "Performance
        comparison of two on-demand routing protocols for ad hoc networks", INFOCOM 2000, section IV:
        behind data a request would still lie here when the patience with its answer is over.
        """
        station = self._stations[index]
        waiting = len(station.urgent) + len(station.queue)
        if waiting + (station.frame is not None) >= self._queue_frames:
            return False
        (station.urgent if frame.urgent else station.queue).append(frame)
        if station.frame is None:
            self._serve(station, now, hold_back)
        return True

    def remove(self, index: int) -> list[Frame]:
        """A robot left: its card dies with everything in it, which is returned in order of service."""
        station = self._stations[index]
        station.gone = True
        if station.contending:
            self._contention.leave(station)
        self._stations[index] = Station(index)
        head = [] if station.frame is None else [station.frame]
        return [*head, *station.urgent, *station.queue]

    def _serve(self, station: Station, now: int, hold_back: bool) -> None:
        """The head of the queue comes into service; it waits out a backoff that is still running."""
        station.frame = frame = (station.urgent or station.queue).popleft()
        frame.service_start = now
        self._listener.on_service(station.index, frame, now)
        if not station.contending:
            self._contention.join_with_frame(station, now, hold_back)

    def _on_access(self, now: int) -> None:
        """A station's wait is over: it speaks, or it has only finished its backoff after a success."""
        station = self._contention.take_next()
        frame = station.frame
        if frame is None:
            self._contention.on_silence()
            return
        frame.attempts += 1
        fade_db = self.medium.fade_db() if self._fade_per_exchange else None
        alone = not self.medium.on_air
        emission = self._begin(station, fade_db, now)
        alone = alone and self._contention.next_access > now + self.timing.turnaround
        if frame.receiver == EVERYONE:
            delay = delay_ns(self.medium.field.farthest(station.index))
            end = now + self.timing.broadcast(frame.msdu_bytes) + delay
            exchange = Exchange(station, station, frame, delay, fade_db, emission)
            self.at(end, self._on_broadcast_end, exchange)
            return
        receiver = self._stations[frame.receiver]
        delay = self.medium.field.delay_ns(station.index, receiver.index)
        exchange = Exchange(station, receiver, frame, delay, fade_db, emission)
        self._open(exchange, alone, now)

    def _open(self, exchange: Exchange, alone: bool, now: int) -> None:
        """Begin with RTS or data; a quiet exchange goes straight to the end of its data."""
        timing, frame = self.timing, exchange.frame
        asks = frame.msdu_bytes > self._rts_threshold_bytes
        question = timing.rts + timing.cts + 2 * (timing.sifs + exchange.delay) if asks else 0
        data_end = now + question + timing.data(frame.msdu_bytes) + exchange.delay
        if alone and self._take_shortcuts:
            end = data_end + timing.sifs + timing.ack + exchange.delay
            exchange.quiet = self._is_quiet(exchange, now, end)
        if not asks or (exchange.quiet and self._is_cleared(exchange)):
            self.at(data_end, self._on_data_end, exchange)
        else:
            self.at(now + timing.rts + exchange.delay, self._on_rts_end, exchange)

    def _is_quiet(self, exchange: Exchange, now: int, end: int) -> bool:
        """Whether nobody can disturb the exchange before its end, and no reservation forbids it."""
        place, receiver = self.medium.field, exchange.receiver.index
        return (
            end <= self._horizon
            and place.is_sensed_by_all(exchange.sender.index)
            and place.is_sensed_by_all(receiver)
            and self.medium.reserved_until(receiver, now) <= now
        )

    def _is_cleared(self, exchange: Exchange) -> bool:
        """Judge RTS and CTS of a quiet exchange in advance; if one fails, they are played out."""
        rate_mbps = self.timing.basic_rate_mbps
        emission, receiver, sender = exchange.emission, exchange.receiver.index, exchange.sender.index
        rts = self.medium.receive(emission, receiver, rate_mbps, 8 * RTS_BYTES)
        exchange.foreseen.append(rts)
        if rts[0] is None:
            answer = Emission(receiver, self.medium.field.row(receiver), exchange.fade_db)
            cts = self.medium.receive(answer, sender, rate_mbps, 8 * ACK_BYTES)
            exchange.foreseen.append(cts)
            if cts[0] is None:
                exchange.foreseen.clear()
                return True
        exchange.quiet = False
        return False

    def _begin(self, station: Station, fade_db: float | None, now: int) -> Emission:
        emission = self.medium.begin(station.index, fade_db)
        self._contention.on_busy(emission, now)
        return emission

    def _end(self, emission: Emission, now: int, answerer: int = EVERYONE) -> None:
        self.medium.end(emission)
        self._contention.on_idle(now, None if answerer == EVERYONE else self.medium.field.row(answerer))

    def _on_broadcast_end(self, exchange: Exchange, now: int) -> None:
        sender = exchange.sender
        self._end(exchange.emission, now)
        if not sender.gone:
            frame = self._finish(sender, now)
            self._listener.on_broadcast_done(sender.index, frame, exchange.emission, now)
            self._serve_next(sender, now)

    def _hears(self, exchange: Exchange, at: Station, rate_mbps: float, size_bytes: int) -> bool:
        """Judge the frame on the air at one end of the exchange, and remember what kept it away."""
        frame = exchange.frame
        if exchange.sender.gone or exchange.receiver.gone:
            frame.cause = DeliveryStatus.RECEIVER_GONE
        elif exchange.foreseen:
            frame.cause, frame.sinr_db = exchange.foreseen.pop(0)
        else:
            judged = self.medium.receive(exchange.emission, at.index, rate_mbps, 8 * size_bytes)
            frame.cause, frame.sinr_db = judged
        return frame.cause is None

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
            exchange.frame.cause = DeliveryStatus.RECEIVER_BUSY
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
        self._contention.on_reservation_unused(now)

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
        if not exchange.quiet or not heard:
            self._reserve(exchange, now, 1, timing.ack)
        if not heard:
            self._end(exchange.emission, now)
            self.at(now - exchange.delay + timing.answer_timeout, self._on_timeout, exchange)
            return
        if exchange.quiet:
            self.medium.end(exchange.emission)
        else:
            self.at(now + timing.sifs, self._send_ack, exchange)
            self._end(exchange.emission, now, receiver.index)
        if not frame.received:
            frame.received = True
            self._listener.on_received(receiver.index, exchange.sender.index, frame, now)
        if exchange.quiet:
            exchange.emission = self._begin(receiver, exchange.fade_db, now)
            self.at(now + timing.sifs + timing.ack + exchange.delay, self._on_ack_end, exchange)

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
            exchange.frame.cause = DeliveryStatus.RECEIVER_GONE
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
            self._contention.join(sender, frame.attempts, now)
            return
        self._finish(sender, now)
        self._listener.on_undeliverable(sender.index, frame, now)
        self._serve_next(sender, now)

    def _finish(self, station: Station, now: int) -> Frame:
        """The head leaves the card; a backoff follows in any case (802.11-1999, 9.2.5.2)."""
        frame = station.frame
        assert frame is not None
        station.frame = None
        self._contention.join(station, 0, now)
        return frame

    def _serve_next(self, station: Station, now: int) -> None:
        if station.frame is None and (station.urgent or station.queue):
            self._serve(station, now, hold_back=True)
