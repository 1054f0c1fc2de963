"""The exchanges of the distributed coordination function: RTS, CTS, data, ACK (802.11-1999, 9.2).

A broadcast is sent once, without RTS, ACK or repetition (9.2.7): beacons of two teams, and requests that
neighbours pass on, may collide and are then lost. That is the standard's way, and nothing above relies
on any single one: beacons come every period, requests are jittered and repeated.

An undisturbed exchange is taken in three events instead of eight: every station senses both of its ends,
no other emission is in progress, nobody is about to transmit, and it ends before the horizon. Its frames
are judged as ever; only the gaps of a SIFS, in which nobody may transmit, are not played.
"""

from dataclasses import dataclass, field
from typing import Protocol

from onehop.contracts.ideal_link import ACK_BYTES, RTS_BYTES
from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import EVERYONE, StationIndex
from radio_proxy.core.airtime import Timing, delay_ns
from radio_proxy.core.contention import Contention, Frame, Station
from radio_proxy.core.draws import Draws
from radio_proxy.core.event_queue import EventQueue
from radio_proxy.core.medium import Emission, Medium, Reservation

Judgement = tuple[DeliveryStatus | None, float]
"""What kept a frame from being received (None: nothing), and its SINR [dB]."""


class Listener(Protocol):
    """The layer above: what becomes of frames."""

    def on_service(self, sender: StationIndex, frame: Frame, now: int) -> None: ...
    def on_expired(self, sender: StationIndex, frame: Frame, now: int) -> None: ...
    def on_received(
        self, receiver: StationIndex, sender: StationIndex, frame: Frame, now: int
    ) -> None: ...
    def on_broadcast_done(
        self, sender: StationIndex, frame: Frame, emission: Emission, now: int
    ) -> None: ...
    def on_acknowledged(self, sender: StationIndex, frame: Frame, now: int) -> None: ...
    def on_undeliverable(self, sender: StationIndex, frame: Frame, now: int) -> None: ...


@dataclass(slots=True, eq=False)
class Exchange:
    """One attempt to send a frame. delay: of propagation [ns]; fade_db, emission: as in the medium.

    undisturbed: nobody can interfere with it. judged: frames that were judged before they end.
    """

    sender: Station
    receiver: Station
    frame: Frame
    delay: int
    fade_db: float | None
    emission: Emission
    undisturbed: bool = False
    judged: list[Judgement] = field(default_factory=list)


class Dcf:
    """All stations of a mission on one medium. events: theirs, and the timers of the layers above."""

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
        self._stations = [Station(StationIndex(i)) for i in range(count)]
        self._contention = Contention(timing, medium, draws)
        self.events = EventQueue(self._contention, self._on_access)
        self._at = self.events.at

    def enqueue(self, index: StationIndex, frame: Frame, now: int, force_backoff: bool) -> bool:
        """Give a station a frame to send; False when its queue is full.

        Routing packets wait before data, as in the interface queue of Das, Perkins and Royer,
        "Performance comparison of two on-demand routing protocols for ad hoc networks", INFOCOM 2000,
        section IV: behind data a request would still wait here when its timeout is over.
        """
        station = self._stations[index]
        waiting = len(station.urgent) + len(station.queue)
        if waiting + (station.frame is not None) >= self._queue_frames:
            return False
        (station.urgent if frame.urgent else station.queue).append(frame)
        if station.frame is None:
            self._serve(station, now, force_backoff)
        return True

    def remove(self, index: StationIndex) -> list[Frame]:
        """A robot left: what its station still had to send, in order of service, which is lost."""
        station = self._stations[index]
        station.gone = True
        if station.contending:
            self._contention.leave(station)
        self._stations[index] = Station(index)
        head = [] if station.frame is None else [station.frame]
        return [*head, *station.urgent, *station.queue]

    def _serve(self, station: Station, now: int, force_backoff: bool) -> None:
        """The head of the queue comes into service; it waits out a backoff that is still running.

        What has expired meanwhile is not served.
        """
        frame = (station.urgent or station.queue).popleft()
        while frame.expires <= now:
            self._listener.on_expired(station.index, frame, now)
            if not station.urgent and not station.queue:
                return
            frame = (station.urgent or station.queue).popleft()
        station.frame = frame
        frame.service_start = now
        self._listener.on_service(station.index, frame, now)
        if not station.contending:
            self._contention.join_with_frame(station, now, force_backoff)

    def _on_access(self, now: int) -> None:
        """A station's wait is over: it transmits, unless it only had to finish a backoff (9.2.5.2)."""
        station = self._contention.take_next()
        frame = station.frame
        if frame is None:
            self._contention.find_next()
            return
        frame.attempts += 1
        fade_db = self.medium.fade_db() if self._fade_per_exchange else None
        alone = not self.medium.emissions
        emission = self._begin(station, fade_db, now)
        alone = alone and self._contention.next_access > now + self.timing.turnaround
        if frame.receiver == EVERYONE:
            delay = delay_ns(self.medium.propagation.farthest(station.index))
            end = now + self.timing.broadcast(frame.msdu_bytes) + delay
            exchange = Exchange(station, station, frame, delay, fade_db, emission)
            self._at(end, self._on_broadcast_end, exchange)
            return
        receiver = self._stations[frame.receiver]
        delay = self.medium.propagation.delay_ns(station.index, receiver.index)
        exchange = Exchange(station, receiver, frame, delay, fade_db, emission)
        self._start(exchange, alone, now)

    def _start(self, exchange: Exchange, alone: bool, now: int) -> None:
        """Begin with RTS or data; an undisturbed exchange goes straight to the end of its data."""
        timing, frame = self.timing, exchange.frame
        rts_cts = frame.msdu_bytes > self._rts_threshold_bytes
        before_data = timing.rts + timing.cts + 2 * (timing.sifs + exchange.delay) if rts_cts else 0
        data_end = now + before_data + timing.data(frame.msdu_bytes) + exchange.delay
        if alone and self._take_shortcuts:
            end = data_end + timing.sifs + timing.ack + exchange.delay
            exchange.undisturbed = self._is_undisturbed(exchange, now, end)
        if not rts_cts or (exchange.undisturbed and self._is_cleared(exchange)):
            self._at(data_end, self._on_data_end, exchange)
        else:
            self._at(now + timing.rts + exchange.delay, self._on_rts_end, exchange)

    def _is_undisturbed(self, exchange: Exchange, now: int, end: int) -> bool:
        """Whether nobody can interfere with the exchange, and the receiver may respond (NAV)."""
        propagation, receiver = self.medium.propagation, exchange.receiver.index
        return (
            end <= self.events.horizon
            and propagation.is_sensed_by_all(exchange.sender.index)
            and propagation.is_sensed_by_all(receiver)
            and self.medium.reserved_until(receiver, now) <= now
        )

    def _is_cleared(self, exchange: Exchange) -> bool:
        """Judge RTS and CTS of an undisturbed exchange in advance; if one fails, they are played out."""
        rate_mbps = self.timing.basic_rate_mbps
        emission, receiver, sender = exchange.emission, exchange.receiver.index, exchange.sender.index
        rts = self.medium.receive(emission, receiver, rate_mbps, 8 * RTS_BYTES)
        exchange.judged.append(rts)
        if rts[0] is None:
            row = self.medium.propagation.mean_snr_row(receiver)
            response = Emission(receiver, row, exchange.fade_db)
            cts = self.medium.receive(response, sender, rate_mbps, 8 * ACK_BYTES)
            exchange.judged.append(cts)
            if cts[0] is None:
                exchange.judged.clear()
                return True
        exchange.undisturbed = False
        return False

    def _begin(self, station: Station, fade_db: float | None, now: int) -> Emission:
        emission = self.medium.begin(station.index, fade_db)
        self._contention.on_busy(emission, now)
        return emission

    def _end(self, emission: Emission, now: int, responder: StationIndex = EVERYONE) -> None:
        """An emission ends. responder: who transmits the next frame of the exchange after a SIFS."""
        self.medium.end(emission)
        if responder == EVERYONE:
            self._contention.on_idle(now)
        else:
            self._contention.on_idle(now, self.medium.propagation.mean_snr_row(responder))

    def _on_broadcast_end(self, exchange: Exchange, now: int) -> None:
        sender = exchange.sender
        self._end(exchange.emission, now)
        if not sender.gone:
            frame = self._finish(sender, now)
            self._listener.on_broadcast_done(sender.index, frame, exchange.emission, now)
            self._serve_next(sender, now)

    def _is_received(self, exchange: Exchange, at: Station, rate_mbps: float, size_bytes: int) -> bool:
        """Judge the current frame at one end of the exchange; the cause of a loss is kept."""
        frame = exchange.frame
        if exchange.sender.gone or exchange.receiver.gone:
            frame.cause = DeliveryStatus.RECEIVER_GONE
        elif exchange.judged:
            frame.cause, frame.sinr_db = exchange.judged.pop(0)
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
        received = self._is_received(exchange, receiver, timing.basic_rate_mbps, RTS_BYTES)
        if received and self.medium.reserved_until(receiver.index, now) > now:
            exchange.frame.cause = DeliveryStatus.RECEIVER_BUSY
            received = False
        reservation = self._reserve(exchange, now, 3, timing.cts + data + timing.ack)
        if received:
            self._at(now + timing.sifs, self._send_cts, exchange)
            self._end(exchange.emission, now, receiver.index)
            return
        self._end(exchange.emission, now)
        self._at(now - exchange.delay + timing.response_timeout, self._on_timeout, exchange)
        nav_reset = 2 * timing.sifs + timing.cts + 2 * timing.slot
        self._at(now + nav_reset, self._on_nav_reset, reservation)

    def _on_nav_reset(self, reservation: Reservation, now: int) -> None:
        self.medium.reset_nav(reservation)
        self._contention.on_nav_reset(now)

    def _send_cts(self, exchange: Exchange, now: int) -> None:
        if self._continue(exchange, exchange.receiver, now):
            self._at(now + self.timing.cts + exchange.delay, self._on_cts_end, exchange)

    def _on_cts_end(self, exchange: Exchange, now: int) -> None:
        timing, sender = self.timing, exchange.sender
        received = self._is_received(exchange, sender, timing.basic_rate_mbps, ACK_BYTES)
        self._reserve(exchange, now, 2, timing.data(exchange.frame.msdu_bytes) + timing.ack)
        if received:
            self._at(now + timing.sifs, self._send_data, exchange)
            self._end(exchange.emission, now, sender.index)
            return
        self._end(exchange.emission, now)
        rts_end = now - timing.cts - timing.sifs - 2 * exchange.delay
        self._at(max(now, rts_end + timing.response_timeout), self._on_timeout, exchange)

    def _send_data(self, exchange: Exchange, now: int) -> None:
        if self._continue(exchange, exchange.sender, now):
            end = now + self.timing.data(exchange.frame.msdu_bytes) + exchange.delay
            self._at(end, self._on_data_end, exchange)

    def _on_data_end(self, exchange: Exchange, now: int) -> None:
        timing, receiver, frame = self.timing, exchange.receiver, exchange.frame
        size_bytes = timing.mac_header_bytes + frame.msdu_bytes
        received = self._is_received(exchange, receiver, timing.rate_mbps, size_bytes)
        if not exchange.undisturbed or not received:
            self._reserve(exchange, now, 1, timing.ack)
        if not received:
            self._end(exchange.emission, now)
            self._at(now - exchange.delay + timing.response_timeout, self._on_timeout, exchange)
            return
        if exchange.undisturbed:
            self.medium.end(exchange.emission)
        else:
            self._at(now + timing.sifs, self._send_ack, exchange)
            self._end(exchange.emission, now, receiver.index)
        if not frame.received:
            frame.received = True
            self._listener.on_received(receiver.index, exchange.sender.index, frame, now)
        if exchange.undisturbed:
            exchange.emission = self._begin(receiver, exchange.fade_db, now)
            self._at(now + timing.sifs + timing.ack + exchange.delay, self._on_ack_end, exchange)

    def _send_ack(self, exchange: Exchange, now: int) -> None:
        if self._continue(exchange, exchange.receiver, now):
            self._at(now + self.timing.ack + exchange.delay, self._on_ack_end, exchange)

    def _on_ack_end(self, exchange: Exchange, now: int) -> None:
        timing, sender = self.timing, exchange.sender
        received = self._is_received(exchange, sender, timing.basic_rate_mbps, ACK_BYTES)
        self._end(exchange.emission, now)
        if not received:
            data_end = now - timing.ack - timing.sifs - 2 * exchange.delay
            self._at(max(now, data_end + timing.response_timeout), self._on_timeout, exchange)
        elif not sender.gone:
            frame = self._finish(sender, now)
            self._listener.on_acknowledged(sender.index, frame, now)
            self._serve_next(sender, now)

    def _continue(self, exchange: Exchange, transmitter: Station, now: int) -> bool:
        """The next frame of an exchange, a SIFS after the last; False when its transmitter has left."""
        if transmitter.gone:
            exchange.frame.cause = DeliveryStatus.RECEIVER_GONE
            self._at(now + self.timing.response_timeout, self._on_timeout, exchange)
            return False
        exchange.emission = self._begin(transmitter, exchange.fade_db, now)
        return True

    def _on_timeout(self, exchange: Exchange, now: int) -> None:
        """No response: another attempt after a longer backoff, or the end of this frame."""
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
        """The frame in service leaves the station; a backoff follows in any case (9.2.5.2)."""
        frame = station.frame
        assert frame is not None
        station.frame = None
        self._contention.join(station, 0, now)
        return frame

    def _serve_next(self, station: Station, now: int) -> None:
        if station.frame is None and (station.urgent or station.queue):
            self._serve(station, now, force_backoff=True)
