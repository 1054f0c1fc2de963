"""The exchanges of the distributed coordination function: RTS, CTS, data, ACK (802.11-1999, 9.2).

A broadcast is sent once, without RTS, ACK or repetition (9.2.7): beacons of two teams, and requests that
neighbours pass on, may collide and are then lost. That is the standard's way, and nothing above relies
on any single one: beacons come every period, requests are jittered and repeated.

An undisturbed exchange is taken in three events instead of eight: every station senses both of its ends,
no other emission is in progress, nobody is about to transmit or awaits a response for long, and it ends
before the horizon. Its frames are judged as ever; only the gaps of a SIFS, in which nobody may transmit,
are not played. With a receive threshold so low that bystanders may receive its frames with errors (EIFS)
all is played.
"""

from onehop.contracts.ideal_link import ACK_BYTES, RTS_BYTES
from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import EVERYONE, StationIndex
from radio_proxy.core.airtime import Timing, delay_ns
from radio_proxy.core.contention import Contention, Frame, Station
from radio_proxy.core.draws import Draws
from radio_proxy.core.emission import Emission
from radio_proxy.core.event_queue import EventQueue
from radio_proxy.core.exchange import Exchange, Listener
from radio_proxy.core.link_rules import LinkRules
from radio_proxy.core.medium import Medium
from radio_proxy.core.nav import Reservation
from radio_proxy.core.reception import PLCP
from radio_proxy.core.retries import Retries


class Dcf:
    """All stations of a mission on one medium. events: theirs, and the timers of the layers above."""

    def __init__(
        self,
        count: int,
        timing: Timing,
        medium: Medium,
        draws: Draws,
        listener: Listener,
        rules: LinkRules,
        take_shortcuts: bool = True,
    ) -> None:
        self.timing = timing
        self.medium = medium
        self._propagation = medium.propagation
        self._judge = medium.receivers.judgement
        self._listener = listener
        self._rules = rules
        self._retries = Retries(rules)
        self._take_shortcuts = take_shortcuts and medium.receivers.locks_are_certain
        self._stations = [Station(StationIndex(i)) for i in range(count)]
        self._latest_timeout = 0
        self._listening: dict[Emission, list[Exchange]] = {}
        self._contention = Contention(timing, medium, draws, rules)
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
        if waiting + (station.frame is not None) >= self._rules.queue_frames:
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

    def reassess(self, now: int) -> None:
        """Find out again for whom the medium is busy."""
        self._contention.reassess(now)

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
        timing, rules, medium = self.timing, self._rules, self.medium
        fade_db = medium.receivers.fade_db() if rules.fade_per_exchange else None
        alone = not medium.emissions and self._latest_timeout < now + PLCP
        source, destination = station.index, frame.receiver
        row = self._propagation.snr_row(source, now)
        to_everyone = destination == EVERYONE
        rts_cts = not to_everyone and frame.msdu_bytes > rules.rts_threshold_bytes
        bits = 8 * (RTS_BYTES if rts_cts else timing.mac_header_bytes + frame.msdu_bytes)
        rate_mbps = timing.basic_rate_mbps if rts_cts or to_everyone else timing.rate_mbps
        emission = Emission(source, destination, rate_mbps, bits, row, fade_db, now)
        medium.begin(emission)
        self._contention.on_busy(emission, now)
        if to_everyone:
            delay = delay_ns(self._propagation.farthest(source))
            exchange = Exchange(station, station, frame, delay, emission)
            end = now + timing.broadcast(frame.msdu_bytes) + delay
            self._at(end, self._on_broadcast_end, exchange)
            return
        delay = self._propagation.delay_ns(source, destination)
        exchange = Exchange(station, self._stations[destination], frame, delay, emission)
        alone = alone and self._contention.next_access > now + timing.turnaround
        self._start(exchange, rts_cts, alone, now)

    def _start(self, exchange: Exchange, rts_cts: bool, alone: bool, now: int) -> None:
        """Begin with RTS or data; an undisturbed exchange goes straight to the end of its data."""
        timing, frame = self.timing, exchange.frame
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
        propagation, receiver = self._propagation, exchange.receiver.index
        return (
            end <= self.events.horizon
            and propagation.is_sensed_by_all(exchange.sender.index)
            and propagation.is_sensed_by_all(receiver)
            and self.medium.nav.until(receiver, now) <= now
        )

    def _is_cleared(self, exchange: Exchange) -> bool:
        """Judge RTS and CTS of an undisturbed exchange in advance; if one fails, they are played out."""
        rts, judge = exchange.emission, self.medium.receivers.judge_alone
        receiver, sender, fade_db = rts.receiver, rts.source, rts.fade_db
        judged = judge(receiver, rts.row[receiver], fade_db)
        exchange.judged = (judged,)
        if judged[0] is None:
            mean_db = self._propagation.mean_snr_row(receiver)[sender]
            answer = judge(sender, mean_db, fade_db)
            exchange.judged = (judged, answer)
            if answer[0] is None:
                exchange.judged = ()
                self._on_cts(exchange)
                rts.rate_mbps = self.timing.rate_mbps
                rts.bits = 8 * (self.timing.mac_header_bytes + exchange.frame.msdu_bytes)
                return True
        exchange.undisturbed = False
        return False

    def _respond(
        self, exchange: Exchange, responder: Station, rate_mbps: float, size_bytes: int, now: int
    ) -> None:
        """The next frame of an exchange begins."""
        source, last = responder.index, exchange.emission
        row = self._propagation.snr_row(source, now)
        answer = Emission(source, last.source, rate_mbps, 8 * size_bytes, row, last.fade_db, now)
        exchange.emission = answer
        self.medium.begin(answer)
        self._contention.on_busy(answer, now)

    def _end(self, emission: Emission, now: int) -> None:
        """An emission ends; `on_idle` must follow when it has been judged."""
        errors = self.medium.end(emission, now)
        if errors or self._contention.minds_errors:
            erring = [self._stations[index] for index in errors]
            self._contention.on_frame_end(emission, erring, now)
        if self._listening:
            for exchange in self._listening.pop(emission, ()):
                self._on_timeout(exchange, now)

    def _await_response(self, responder: Station, now: int) -> None:
        """A frame has ended, and its addressee transmits the next one after a SIFS."""
        response = self._propagation.snr_row(responder.index, now + self.timing.sifs)
        self._contention.on_idle(now, response)

    def _on_broadcast_end(self, exchange: Exchange, now: int) -> None:
        sender = exchange.sender
        self._end(exchange.emission, now)
        self._contention.on_idle(now)
        if not sender.gone:
            self._retries.on_broadcast(sender)
            frame = self._finish(sender, now)
            self._listener.on_broadcast_done(sender.index, frame, exchange.emission, now)
            self._serve_next(sender, now)

    def _is_received(self, exchange: Exchange, at: Station) -> bool:
        """Judge the frame that has ended at one end of the exchange; the cause of a loss is kept."""
        frame = exchange.frame
        if exchange.sender.gone or exchange.receiver.gone:
            frame.cause = DeliveryStatus.RECEIVER_GONE
        elif exchange.judged:
            (frame.cause, frame.sinr_db), *rest = exchange.judged
            exchange.judged = tuple(rest)
        else:
            frame.cause, frame.sinr_db = self._judge(exchange.emission, at.index)
        return frame.cause is None

    def _reserve(self, exchange: Exchange, now: int, frames: int, airtime: int) -> Reservation | None:
        """The duration field: so many frames of so much airtime are still to come in this exchange."""
        until = now + frames * (self.timing.sifs + exchange.delay) + airtime
        return self.medium.nav.reserve(exchange.emission, until, now)

    def _on_rts_end(self, exchange: Exchange, now: int) -> None:
        timing, receiver = self.timing, exchange.receiver
        self._end(exchange.emission, now)
        received = self._is_received(exchange, receiver)
        if received and self.medium.nav.until(receiver.index, now) > now:
            exchange.frame.cause = DeliveryStatus.RECEIVER_BUSY
            received = False
        data = timing.data(exchange.frame.msdu_bytes)
        exchange.reservation = self._reserve(exchange, now, 3, timing.cts + data + timing.ack)
        if received:
            self._at(now + timing.sifs, self._send_cts, exchange)
            self._await_response(receiver, now)
            return
        self._contention.on_idle(now)
        self._await(exchange, now - exchange.delay + timing.response_timeout)
        if exchange.reservation is not None:
            self._watch_nav(exchange.reservation, now)

    def _watch_nav(self, reservation: Reservation, rts_end: int) -> None:
        """A bystander of an RTS that no data will follow resets its NAV (9.2.5.4)."""
        timing = self.timing
        nav_timeout = 2 * timing.sifs + timing.cts + 2 * timing.slot
        if self._rules.as_ns3:
            nav_timeout += timing.preamble
        self.medium.nav.watch(reservation)
        self._at(rts_end + nav_timeout, self._on_nav_timeout, reservation)

    def _on_nav_timeout(self, reservation: Reservation, now: int) -> None:
        self.medium.nav.reset(reservation, now)
        self._contention.on_nav_reset(now)

    def _send_cts(self, exchange: Exchange, now: int) -> None:
        timing = self.timing
        if self._continue(exchange, exchange.receiver, timing.basic_rate_mbps, ACK_BYTES, now):
            self._at(now + timing.cts + exchange.delay, self._on_cts_end, exchange)

    def _on_cts_end(self, exchange: Exchange, now: int) -> None:
        timing, sender = self.timing, exchange.sender
        self._end(exchange.emission, now)
        received = self._is_received(exchange, sender)
        self._reserve(exchange, now, 2, timing.data(exchange.frame.msdu_bytes) + timing.ack)
        if received:
            self._on_cts(exchange)
            self._at(now + timing.sifs, self._send_data, exchange)
            self._await_response(sender, now)
            return
        self._contention.on_idle(now)
        rts_end = now - timing.cts - timing.sifs - 2 * exchange.delay
        self._await(exchange, max(now, rts_end + timing.response_timeout))
        if exchange.reservation is not None:
            self._watch_nav(exchange.reservation, rts_end + exchange.delay)

    def _on_cts(self, exchange: Exchange) -> None:
        exchange.after_cts = True
        self._retries.on_cts(exchange.frame)

    def _send_data(self, exchange: Exchange, now: int) -> None:
        timing, msdu_bytes = self.timing, exchange.frame.msdu_bytes
        size = timing.mac_header_bytes + msdu_bytes
        if self._continue(exchange, exchange.sender, timing.rate_mbps, size, now):
            self._at(now + timing.data(msdu_bytes) + exchange.delay, self._on_data_end, exchange)

    def _on_data_end(self, exchange: Exchange, now: int) -> None:
        timing, receiver, frame = self.timing, exchange.receiver, exchange.frame
        self._end(exchange.emission, now)
        received = self._is_received(exchange, receiver)
        self._listener.on_data_ended(exchange.sender.index, frame, exchange.emission, now)
        if not exchange.undisturbed or not received:
            self._reserve(exchange, now, 1, timing.ack)
        if not received:
            self._contention.on_idle(now)
            self._await(exchange, now - exchange.delay + timing.response_timeout)
            return
        if not exchange.undisturbed:
            self._at(now + timing.sifs, self._send_ack, exchange)
            self._await_response(receiver, now)
        if not frame.received:
            frame.received = True
            self._listener.on_received(receiver.index, exchange.sender.index, frame, now)
        if exchange.undisturbed:
            self._respond(exchange, receiver, timing.basic_rate_mbps, ACK_BYTES, now)
            self._at(now + timing.sifs + timing.ack + exchange.delay, self._on_ack_end, exchange)

    def _send_ack(self, exchange: Exchange, now: int) -> None:
        timing = self.timing
        if self._continue(exchange, exchange.receiver, timing.basic_rate_mbps, ACK_BYTES, now):
            self._at(now + timing.ack + exchange.delay, self._on_ack_end, exchange)

    def _on_ack_end(self, exchange: Exchange, now: int) -> None:
        timing, sender = self.timing, exchange.sender
        self._end(exchange.emission, now)
        received = self._is_received(exchange, sender)
        self._contention.on_idle(now)
        if not received:
            data_end = now - timing.ack - timing.sifs - 2 * exchange.delay
            self._await(exchange, max(now, data_end + timing.response_timeout))
        elif not sender.gone:
            sender.failures = 0
            frame = self._finish(sender, now)
            self._listener.on_acknowledged(sender.index, frame, now)
            self._serve_next(sender, now)

    def _continue(
        self, exchange: Exchange, transmitter: Station, rate_mbps: float, size_bytes: int, now: int
    ) -> bool:
        """The next frame of an exchange, a SIFS after the last; False when its transmitter has left."""
        if transmitter.gone:
            exchange.frame.cause = DeliveryStatus.RECEIVER_GONE
            self._await(exchange, now + self.timing.response_timeout)
            return False
        self._respond(exchange, transmitter, rate_mbps, size_bytes, now)
        return True

    def _await(self, exchange: Exchange, until: int) -> None:
        """The response did not come, which its sender knows only when its timer expires."""
        self._latest_timeout = max(self._latest_timeout, until)
        self._at(until, self._on_timeout, exchange)

    def _on_timeout(self, exchange: Exchange, now: int) -> None:
        """No response: another attempt after a longer backoff, or the end of this frame.

        A sender to which PHY-RXSTART was indicated waits for the end of that frame (9.2.5.7, 9.2.8).
        """
        sender, frame, medium = exchange.sender, exchange.frame, self.medium
        if medium.emissions and not sender.gone:
            heard = medium.receivers.receiving(sender.index, medium.emissions, now)
            if heard is not None:
                self._listening.setdefault(heard, []).append(exchange)
                return
        if sender.gone:
            return
        if not self._retries.on_failure(sender, frame, exchange.after_cts):
            self._contention.join(sender, now)
            return
        self._finish(sender, now)
        self._listener.on_undeliverable(sender.index, frame, now)
        self._serve_next(sender, now)

    def _finish(self, station: Station, now: int) -> Frame:
        """The frame in service leaves the station; a backoff follows in any case (9.2.5.2)."""
        frame = station.frame
        assert frame is not None
        station.frame = None
        self._contention.join(station, now)
        return frame

    def _serve_next(self, station: Station, now: int) -> None:
        if station.frame is None and (station.urgent or station.queue):
            self._serve(station, now, force_backoff=True)
