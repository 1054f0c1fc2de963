"""Between routing and DCF: packets of robots become frames of stations.

What becomes of a frame is reported to the routing protocols of both of its ends.

What routing costs is counted as by J. Broch et al., "A performance comparison of multi-hop wireless ad
hoc network routing protocols", MobiCom 1998, 5.2 and 5.3: every hop of a routing packet once, IP header
included, and apart from them ("source_route") the bytes that a source route adds to each hop of a data
message. Repetitions, RTS, CTS and ACK are the link's own and not in it.
"""

from collections.abc import Iterable

from onehop.contracts.messages import DeliveryStatus
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.addresses import BROADCAST, EVERYONE, RobotId, StationIndex
from radio_proxy.core.airtime import dsss
from radio_proxy.core.contention import Frame
from radio_proxy.core.data_message import DataPacket
from radio_proxy.core.dcf import Dcf
from radio_proxy.core.deliveries import Deliveries
from radio_proxy.core.draws import Draws
from radio_proxy.core.eavesdropper import Eavesdropper
from radio_proxy.core.emission import Emission
from radio_proxy.core.error_rates import bit_error_rate
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.link_rules import link_rules
from radio_proxy.core.medium import Medium
from radio_proxy.core.path_loss import OWN_DB, SILENT_DB
from radio_proxy.core.propagation import Propagation
from radio_proxy.core.routing.interface import Router


class LinkLayer:
    """The links of a mission. robots: sorted ids, in the order of their stations.

    force_backoff: frames that are sent now draw a backoff even if the medium is idle. control_bytes:
    what routing has cost so far, by kind [B]. events: of the DCF, for the timers of routing too.
    """

    def __init__(
        self,
        robots: tuple[RobotId, ...],
        section: RadioSection,
        propagation: Propagation,
        draws: Draws,
        deliveries: Deliveries,
        eavesdropper: Eavesdropper | None = None,
    ) -> None:
        self.force_backoff = False
        self.control_bytes: dict[str, int] = {}
        self._robots = robots
        self._index = {robot: StationIndex(i) for i, robot in enumerate(robots)}
        self._routers: dict[RobotId, Router] = {}
        self._propagation = propagation
        self._threshold_db = propagation.budget.receive_threshold_db
        self._deliveries = deliveries
        self._eavesdropper = eavesdropper
        self._timing = dsss(section)
        rules = link_rules(section)
        self._medium = Medium(propagation, draws, rules)
        self._dcf = Dcf(len(robots), self._timing, self._medium, draws, self, rules)
        self.events = self._dcf.events

    def on_placed(self, now: int) -> None:
        """Robots moved and jams changed, so that the energy at a station did."""
        if self._medium.detects_energy:
            self._dcf.reassess(now)

    def attach(self, robot: RobotId, router: Router) -> None:
        """A robot's NIC comes up, with this routing protocol."""
        self._routers = dict(sorted([*self._routers.items(), (robot, router)]))

    def detach(self, robot: RobotId) -> list[DataPacket]:
        """A robot's NIC goes down: the data that it still had to send."""
        del self._routers[robot]
        frames = self._dcf.remove(self._index[robot])
        return [
            frame.packet.tried(frame.attempts)
            for frame in frames
            if isinstance(frame.packet, DataPacket)
        ]

    def send(
        self, robot: RobotId, packet: object, next_hop: RobotId, size_bytes: int, kind: str, now: int
    ) -> bool:
        """Queue a packet for one hop; what routing adds counts when it is queued."""
        receiver = EVERYONE if next_hop == BROADCAST else self._index[next_hop]
        expires = packet.message.expires if isinstance(packet, DataPacket) else NEVER
        frame = Frame(receiver, size_bytes, packet, kind != "", expires)
        if not self._dcf.enqueue(self._index[robot], frame, now, self.force_backoff):
            return False
        if isinstance(packet, DataPacket):
            kind, size_bytes = "source_route", size_bytes - packet.message.msdu_bytes
        if size_bytes:
            self.control_bytes[kind] = self.control_bytes.get(kind, 0) + size_bytes
        return True

    # What the DCF reports.

    def on_service(self, sender: StationIndex, frame: Frame, now: int) -> None:  # noqa: ARG002
        packet = frame.packet
        if isinstance(packet, DataPacket) and packet.message.first_service < 0:
            packet.message.begin_service(now)

    def on_expired(self, sender: StationIndex, frame: Frame, now: int) -> None:  # noqa: ARG002
        assert isinstance(frame.packet, DataPacket), "routing packets do not expire"
        self._deliveries.drop(frame.packet.tried(0), DeliveryStatus.EXPIRED)

    def on_data_ended(self, sender: StationIndex, frame: Frame, emission: Emission, now: int) -> None:  # noqa: ARG002
        if self._eavesdropper is not None:
            self._eavesdropper.on_frame(emission, (frame.cause, frame.sinr_db), self._routers, now)

    def on_received(self, receiver: StationIndex, sender: StationIndex, frame: Frame, now: int) -> None:
        packet = frame.packet
        holder, source = self._robots[receiver], self._robots[sender]
        router = self._routers[holder]
        router.on_heard(source, frame.sinr_db - self._threshold_db, now)
        if isinstance(packet, DataPacket):
            packet.message.copies += 1
            beyond = packet.named_beyond(holder)
            if beyond:
                self._overhear(frame, sender, beyond, now)
            self._note_link(packet, frame)
            packet = packet.moved(holder, frame.attempts)
        else:
            self._overhear(frame, sender, (robot for robot in self._routers if robot != holder), now)
        router.on_packet(packet, source, now)

    def _overhear(self, frame: Frame, sender: StationIndex, robots: Iterable[RobotId], now: int) -> None:
        """Who of these overhears a frame that has reached its receiver: each with a fading of its own.

        Differs: whatever else is sent meanwhile is left out, for it did not keep the receiver either.
        """
        source, row = self._robots[sender], self._propagation.snr_row(sender, now)
        judge = self._medium.receivers.judge_overheard
        bits = 8 * (self._timing.mac_header_bytes + frame.msdu_bytes)
        for robot in robots:
            router, index = self._routers.get(robot), self._index[robot]
            if router is None or not SILENT_DB < row[index] < OWN_DB:
                continue
            heard = judge(index, row[index], self._timing.rate_mbps, bits)
            if heard[0] is None:
                router.on_heard(source, heard[1] - self._threshold_db, now)
                router.on_overheard(frame.packet, source, now)

    def on_acknowledged(self, sender: StationIndex, frame: Frame, now: int) -> None:
        if isinstance(frame.packet, DataPacket):
            self._deliveries.release_copy(frame.packet.message)
        router = self._routers[self._robots[sender]]
        router.on_acknowledged(frame.packet, self._robots[frame.receiver], now)

    def on_undeliverable(self, sender: StationIndex, frame: Frame, now: int) -> None:
        packet = frame.packet
        next_hop = self._robots[frame.receiver]
        cause = self._cause(frame, next_hop)
        if isinstance(packet, DataPacket):
            self._note_link(packet, frame)
            packet = packet.tried(frame.attempts)
        self._routers[self._robots[sender]].on_undeliverable(packet, next_hop, cause, now)

    def _cause(self, frame: Frame, next_hop: RobotId) -> DeliveryStatus:
        """Why a hop failed: what its last attempt met, unless the next hop has left."""
        assert frame.cause is not None, "every attempt that failed has a cause"
        if frame.cause is not DeliveryStatus.RECEIVER_GONE and next_hop in self._routers:
            return frame.cause
        packet = frame.packet
        to_relay = isinstance(packet, DataPacket) and next_hop != packet.message.destination
        return DeliveryStatus.RELAY_GONE if to_relay else DeliveryStatus.RECEIVER_GONE

    def on_broadcast_done(
        self, sender: StationIndex, frame: Frame, emission: Emission, now: int
    ) -> None:
        packet = frame.packet
        rate_mbps = self._timing.basic_rate_mbps
        source = self._robots[sender]
        if not isinstance(packet, DataPacket):
            self._routers[source].on_broadcast_sent(packet, now)
        for robot, router in self._routers.items():
            if robot == source:
                continue
            cause, sinr_db = self._medium.receivers.judgement(emission, self._index[robot])
            if cause is None:
                router.on_heard(source, sinr_db - self._threshold_db, now)
            if isinstance(packet, DataPacket):
                packet.message.sinr_db = sinr_db
                packet.message.bit_error_rate = bit_error_rate(rate_mbps, sinr_db)
                copy = packet.tried(1) if cause else packet.moved(robot, 1)
                status = cause or DeliveryStatus.DELIVERED
                self._deliveries.record(copy, robot, status, -1 if cause else now)
            elif cause is None:
                router.on_packet(packet, source, now)
        if self._eavesdropper is not None:
            self._eavesdropper.on_frame(emission, None, self._routers, now)

    def _note_link(self, data: DataPacket, frame: Frame) -> None:
        data.message.sinr_db = frame.sinr_db
        data.message.bit_error_rate = bit_error_rate(self._timing.rate_mbps, frame.sinr_db)
