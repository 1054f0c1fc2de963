"""The radio of a mission: `Radio.carry(truth)` moves every message through one tick (architecture.md).

Here messages meet robots: who is present, what they offer, what reaches them, and what is on record
about it. The link lies in dcf.py and medium.py, the routing in routing/.

What routing costs is counted as by J. Broch et al., "A performance comparison of multi-hop wireless ad
hoc network routing protocols", MobiCom 1998, 5.2 and 5.3: every hop of a routing packet once, IP header
included, and apart from them ("source_route") the bytes that a source route adds to each hop of a data
message. Repetitions, RTS, CTS and ACK are the link's business and not in it.
"""

from collections.abc import Callable
from typing import Any

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.messages import (
    BROADCAST,
    Carriage,
    DeliveryStatus,
    Inbox,
    Presence,
    RadioRecord,
    Reception,
    Transmission,
    TransmitRequest,
    Truth,
    Verdict,
)
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.randomness import generator
from radio_proxy.core.airtime import dsss
from radio_proxy.core.contention import EVERYONE, Frame
from radio_proxy.core.data_message import DataMessage, DataPacket
from radio_proxy.core.dcf import Dcf
from radio_proxy.core.draws import Draws
from radio_proxy.core.error_rates import bit_error_rate
from radio_proxy.core.medium import Emission, Medium
from radio_proxy.core.propagation import OWN_DB, Field, link_budget
from radio_proxy.core.routing.direct import DirectRouter
from radio_proxy.core.routing.interface import Router
from radio_proxy.core.routing.mrdv import MrdvRouter
from radio_proxy.core.routing.mrsr import MrsrRouter


class Nic:
    """The network card of one incarnation of one robot, as its routing protocol sees it."""

    def __init__(self, radio: "Radio", presence: Presence, section: RadioSection, now: int) -> None:
        self.robot = presence.robot
        self.incarnation = presence.incarnation
        self.gone = False
        self._radio = radio
        self.router = self._make_router(section, now)

    def _make_router(self, section: RadioSection, now: int) -> Router:
        if section.routing == "mrsr":
            return MrsrRouter(self, section.gamma_distance)
        if section.routing == "mrdv":
            return MrdvRouter(self, section.gamma_distance, now)
        return DirectRouter(self)

    def send(self, packet: object, next_hop: int, size_bytes: int, kind: str, now: int) -> bool:
        return self._radio.send(self.robot, packet, next_hop, size_bytes, kind, now)

    def deliver(self, data: DataPacket, now: int) -> None:
        self._radio.deliver(data, now)

    def drop(self, data: DataPacket, status: DeliveryStatus) -> None:
        self._radio.drop(data, status)

    def at(self, time_ns: int, event: Callable[[Any, int], None], argument: Any) -> None:
        def unless_gone(given: Any, now: int) -> None:
            if not self.gone:
                event(given, now)

        self._radio.at(time_ns, unless_gone, argument)

    def uniform(self) -> float:
        return self._radio.uniform()

    def speed(self) -> float:
        return self._radio.offer_of(self.robot).speed

    def remaining_distance(self) -> float:
        return self._radio.offer_of(self.robot).remaining_distance


class Radio:
    """Everything between the outboxes of one tick and the inboxes of the next."""

    def __init__(self, briefing: RadioBriefing) -> None:
        section = briefing.radio
        self._period = briefing.period_ns
        self._section = section
        self._robots = tuple(sorted(briefing.robots))
        self._index = {robot: i for i, robot in enumerate(self._robots)}
        self._draws = Draws(generator(briefing.seed, "radio"))
        self._field = Field(link_budget(section), self._robots, briefing.walls)
        self._timing = dsss(section)
        self._dcf = Dcf(
            len(self._robots),
            self._timing,
            Medium(self._field, self._draws),
            self._draws,
            self,
            retry_limit=section.retry_limit,
            queue_frames=section.queue_frames,
            rts_threshold_bytes=section.rts_threshold_bytes,
            fade_per_exchange=section.fading == "exchange",
        )
        self._cards: dict[int, Nic] = {}
        self._incarnations: tuple[tuple[int, int], ...] = ()
        self._offers: tuple[TransmitRequest, ...] = ()
        self._crowded = False
        self._numbers = dict.fromkeys(self._robots, 0)
        self._verdicts: list[Verdict] = []
        self._arrivals: list[tuple[int, int, int, int, Reception]] = []
        self._control_bytes: dict[str, int] = {}
        self._reported_bytes: dict[str, int] = {}

    def carry(self, truth: Truth) -> Carriage:
        """What reaches whom in the tick that ends at truth.time_ns, and what became of the rest."""
        start = truth.time_ns - self._period
        self._welcome(truth, start)
        self._field.update(truth.present, truth.cuts, truth.jams)
        self._offers = truth.transmit_requests
        talking = [offer for offer in truth.transmit_requests if offer.outbox]
        self._crowded = len(talking) > 1
        for offer in talking:
            for transmission in offer.outbox:
                self._submit(offer.robot, transmission, start)
        self._crowded = False
        self._dcf.run(truth.time_ns)
        return self._hand_out(truth)

    def _hand_out(self, truth: Truth) -> Carriage:
        tick, time_ns = truth.tick, truth.time_ns
        inboxes = {presence.robot: Inbox(tick, time_ns, ()) for presence in truth.present}
        if self._arrivals:
            self._arrivals.sort(key=lambda arrival: arrival[:4])
            got: dict[int, list[Reception]] = {}
            for _, _, _, robot, reception in self._arrivals:
                got.setdefault(robot, []).append(reception)
            self._arrivals = []
            for robot in sorted(got):
                inboxes[robot] = Inbox(tick, time_ns, tuple(got[robot]))
        verdicts = tuple(self._verdicts)
        self._verdicts = []
        if self._control_bytes != self._reported_bytes:
            self._reported_bytes = dict(sorted(self._control_bytes.items()))
        return Carriage(inboxes, RadioRecord(tick, time_ns, verdicts, self._reported_bytes))

    def _welcome(self, truth: Truth, now: int) -> None:
        """Cards of robots that left (or came back as another process) die; new ones start empty."""
        incarnations = tuple([(p.robot, p.incarnation) for p in truth.present])
        if incarnations == self._incarnations:
            return
        before, after = dict(self._incarnations), dict(incarnations)
        self._incarnations = incarnations
        left = [robot for robot in sorted(before) if after.get(robot) != before[robot]]
        died = [self._cards.pop(robot) for robot in left]
        for card in died:
            card.gone = True
            for data in card.router.abandon():
                self._drop_of_gone(card.robot, data)
        for robot in left:
            for frame in self._dcf.remove(self._index[robot]):
                if isinstance(frame.packet, DataPacket):
                    self._drop_of_gone(robot, frame.packet.tried(frame.attempts))
        for presence in truth.present:
            if before.get(presence.robot) != presence.incarnation:
                self._cards[presence.robot] = Nic(self, presence, self._section, now)

    def _drop_of_gone(self, robot: int, data: DataPacket) -> None:
        """A robot left with a copy of a message."""
        at_source = robot == data.message.source
        self.drop(data, DeliveryStatus.SENDER_GONE if at_source else DeliveryStatus.RELAY_GONE)

    def _submit(self, robot: int, transmission: Transmission, now: int) -> None:
        self._numbers[robot] += 1
        destination = transmission.destination
        size = max(transmission.msdu_bytes, len(transmission.payload))
        message = DataMessage(self._numbers[robot], robot, destination, transmission.payload, size, now)
        data = DataPacket(message, (robot,))
        if destination == BROADCAST:
            if not self.send(robot, data, BROADCAST, size, "", now):
                self.drop(data, DeliveryStatus.QUEUE_FULL)
        elif destination == robot:
            self.drop(data, DeliveryStatus.NO_ROUTE)
        elif destination not in self._index:
            self.drop(data, DeliveryStatus.RECEIVER_GONE)
        else:
            self._cards[robot].router.submit(data, now)

    # What cards ask for.

    def send(
        self, robot: int, packet: object, next_hop: int, size_bytes: int, kind: str, now: int
    ) -> bool:
        """Queue a packet for one hop; what routing adds to the air counts when it is queued."""
        receiver = EVERYONE if next_hop == BROADCAST else self._index[next_hop]
        frame = Frame(receiver, size_bytes, packet, urgent=kind != "")
        if not self._dcf.enqueue(self._index[robot], frame, now, self._crowded):
            return False
        if isinstance(packet, DataPacket):
            kind, size_bytes = "source_route", size_bytes - packet.message.msdu_bytes
        if size_bytes:
            self._control_bytes[kind] = self._control_bytes.get(kind, 0) + size_bytes
        return True

    def deliver(self, data: DataPacket, now: int) -> None:
        """A message reached its destination; a second copy of it is dropped."""
        message = data.message
        if not message.settled:
            message.settled = True
            self._settle(data, message.destination, DeliveryStatus.DELIVERED, now)
        self._release(message)

    def drop(self, data: DataPacket, status: DeliveryStatus) -> None:
        """One copy of a message is given up.

        A hop whose ACKs were all lost leaves two copies; what came of the one beyond it is on record.
        """
        loss = data.message.loss
        if loss is None or len(data.path) >= len(loss[0].path):
            data.message.loss = (data, status)
        self._release(data.message)

    def _release(self, message: DataMessage) -> None:
        """A robot holds a message no more; when it was the last one, the message is lost."""
        message.copies -= 1
        if message.settled or message.copies > 0:
            return
        message.settled = True
        assert message.loss is not None
        data, status = message.loss
        if message.destination == BROADCAST:
            for robot in sorted(self._cards):
                if robot != message.source:
                    self._settle(data, robot, status, -1)
            return
        if status is not DeliveryStatus.SENDER_GONE and message.destination not in self._cards:
            status = DeliveryStatus.RECEIVER_GONE
        self._settle(data, message.destination, status, -1)

    def _settle(self, data: DataPacket, receiver: int, status: DeliveryStatus, arrival: int) -> None:
        message = data.message
        verdict = message.verdict(data, receiver, status, arrival)
        self._verdicts.append(verdict)
        if status is DeliveryStatus.DELIVERED:
            reception = Reception(
                source=message.source,
                payload=message.payload,
                service_start_ns=verdict.service_start_ns,
                arrival_ns=arrival,
                hops=len(data.path) - 1,
                attempts=sum(data.attempts),
                snr_db=message.sinr_db,
                bit_error_rate=message.bit_error_rate,
                msdu_bytes=message.msdu_bytes,
            )
            self._arrivals.append((arrival, message.source, message.number, receiver, reception))

    def at(self, time_ns: int, event: Callable[[Any, int], None], argument: Any) -> None:
        """A timer of a routing protocol."""
        self._dcf.at(time_ns, event, argument)

    def uniform(self) -> float:
        """A draw of the radio's stream."""
        return self._draws.uniform()

    def offer_of(self, robot: int) -> TransmitRequest:
        """The robot's last word about its speed and distance; at rest when it has said nothing yet."""
        for offer in self._offers:
            if offer.robot == robot:
                return offer
        return TransmitRequest(robot, 0.0, 0.0, ())

    # What the link layer reports.

    def on_service(self, sender: int, frame: Frame, now: int) -> None:  # noqa: ARG002
        packet = frame.packet
        if isinstance(packet, DataPacket) and packet.message.first_service < 0:
            packet.message.first_service = now
            packet.message.discovery_time_before_service = packet.message.discovery_time

    def on_received(self, receiver: int, sender: int, frame: Frame, now: int) -> None:
        packet = frame.packet
        holder = self._robots[receiver]
        if isinstance(packet, DataPacket):
            packet.message.copies += 1
            self._note_link(packet, frame)
            packet = packet.moved(holder, frame.attempts)
        else:
            self._overhear(packet, sender, holder, now)
        self._cards[holder].router.on_packet(packet, self._robots[sender], now)

    def _overhear(self, packet: object, sender: int, holder: int, now: int) -> None:
        """Control packets are heard by everyone whose mean SNR allows it."""
        row, source = self._field.row(sender), self._robots[sender]
        threshold_db = self._field.budget.receive_threshold_db
        for robot in sorted(self._cards):
            if robot != holder and threshold_db <= row[self._index[robot]] < OWN_DB:
                self._cards[robot].router.on_overheard(packet, source, now)

    def on_acknowledged(self, sender: int, frame: Frame, now: int) -> None:
        robot = self._robots[sender]
        if isinstance(frame.packet, DataPacket):
            self._release(frame.packet.message)
        self._cards[robot].router.on_acknowledged(frame.packet, self._robots[frame.receiver], now)

    def on_undeliverable(self, sender: int, frame: Frame, now: int) -> None:
        robot = self._robots[sender]
        packet = frame.packet
        if isinstance(packet, DataPacket):
            self._note_link(packet, frame)
            packet = packet.tried(frame.attempts)
        next_hop = self._robots[frame.receiver]
        cause = self._cause(frame, packet, next_hop)
        self._cards[robot].router.on_undeliverable(packet, next_hop, cause, now)

    def _cause(self, frame: Frame, packet: object, next_hop: int) -> DeliveryStatus:
        """Why a hop failed: what its last attempt met, unless the next hop has left."""
        assert frame.cause is not None
        if frame.cause is not DeliveryStatus.RECEIVER_GONE and next_hop in self._cards:
            return frame.cause
        is_relay = isinstance(packet, DataPacket) and next_hop != packet.message.destination
        return DeliveryStatus.RELAY_GONE if is_relay else DeliveryStatus.RECEIVER_GONE

    def on_broadcast_done(self, sender: int, frame: Frame, emission: Emission, now: int) -> None:
        packet = frame.packet
        bits = 8 * (self._timing.mac_header_bytes + frame.msdu_bytes)
        rate_mbps = self._timing.basic_rate_mbps
        source = self._robots[sender]
        if not isinstance(packet, DataPacket):
            self._cards[source].router.on_broadcast_sent(packet, now)
        for robot in sorted(self._cards):
            if robot == source:
                continue
            cause, sinr_db = self._dcf.medium.receive(emission, self._index[robot], rate_mbps, bits)
            if isinstance(packet, DataPacket):
                packet.message.sinr_db = sinr_db
                packet.message.bit_error_rate = bit_error_rate(rate_mbps, sinr_db)
                copy = packet.tried(1) if cause else packet.moved(robot, 1)
                self._settle(copy, robot, cause or DeliveryStatus.DELIVERED, -1 if cause else now)
            elif cause is None:
                self._cards[robot].router.on_packet(packet, source, now)

    def _note_link(self, data: DataPacket, frame: Frame) -> None:
        data.message.sinr_db = frame.sinr_db
        data.message.bit_error_rate = bit_error_rate(self._timing.rate_mbps, frame.sinr_db)
