"""MRDV: AODV (RFC 3561) whose ROUTE REQUESTs are passed on with a probability (thesis 3.7.2).

Left out, as the RFC allows: local repair (6.12), RREP-ACK (6.8: the link layer acknowledges every
unicast RREP). Hellos (6.9) are in mrdv_hello.py.

Differs: the probability holds during the expanding ring search alone; requests through the whole
network are normal ones, because waiting for three of them (20 s) before the normal discovery would
outlast the team. After a restart a robot lets the destination alone reply (6.3, flag D) for
DELETE_PERIOD instead of keeping silent so long (6.13). Requests are jittered before they are passed on
or repeated (as RFC 4728 does), and one that comes over a link that is not worthwhile (links.py) waits
for a copy over a better one: a route has to stand, and the fewest hops are the longest ones. For the
same reason such a link does not take the place of a route over relays (6.2).
"""

from dataclasses import dataclass, field, replace

from onehop.contracts.messages import DeliveryStatus
from onehop.contracts.serial_numbers import following, newer, newest
from radio_proxy.core.addresses import BROADCAST, RobotId
from radio_proxy.core.data_message import MAX_DISCOVERIES, DataPacket
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.routing.forwarding import BROADCAST_JITTER_NS, forwarding_probability, gamma
from radio_proxy.core.routing.interface import NicServices
from radio_proxy.core.routing.links import Links
from radio_proxy.core.routing.mrdv_hello import Hellos
from radio_proxy.core.routing.mrdv_limits import (
    BUFFER_MESSAGES,
    MY_ROUTE_NS,
    NET_DIAMETER,
    NET_TRAVERSAL_NS,
    NODE_TRAVERSAL_NS,
    RREQ_RETRIES,
    TIMEOUT_BUFFER,
    TTL_INCREMENT,
    TTL_START,
    TTL_THRESHOLD,
    WEAK_REQUEST_WAIT_NS,
    RateLimit,
    SeenRequests,
)
from radio_proxy.core.routing.mrdv_packets import (
    RREP_BYTES,
    RREQ_BYTES,
    Hello,
    Rerr,
    Rrep,
    Rreq,
    rerr_bytes,
)
from radio_proxy.core.routing.mrdv_table import ACTIVE_ROUTE_NS, DELETE_PERIOD_NS, Route, RouteTable


@dataclass(slots=True, eq=False)
class RouteDiscovery:
    """A discovery under way. network_wide: requests through the whole network so far.

    number: of the last request.
    """

    destination: RobotId
    ttl: int
    network_wide: int = 0
    number: int = 0
    waiting: list[DataPacket] = field(default_factory=list)


class MrdvRouter:
    """AODV on one robot. hello_period: of its broadcast hellos, 0 for none [ns]."""

    def __init__(self, nic: NicServices, gamma_distance: float, now: int, hello_period: int = 0) -> None:
        self.table = RouteTable()
        self._nic = nic
        self._me = nic.robot
        self._links = Links()
        self._gamma_distance = gamma_distance
        self._sequence = nic.incarnation << 16
        self._number = nic.incarnation << 16
        self._reboot_hold_until = now + DELETE_PERIOD_NS if nic.incarnation else now
        self._discoveries: dict[RobotId, RouteDiscovery] = {}
        self.buffered = 0
        self._seen = SeenRequests()
        self._requests = RateLimit()
        self._errors = RateLimit()
        self._blacklist: dict[RobotId, int] = {}
        self._hellos = Hellos(
            nic, self._links, self.table, lambda: self._sequence, self._on_lost, hello_period, now
        )

    def submit(self, data: DataPacket, now: int) -> None:
        if data.message.destination in self._discoveries or not self._forward_data(data, now):
            self._buffer(data, now)

    def abandon(self) -> list[DataPacket]:
        waiting = [data for to in sorted(self._discoveries) for data in self._discoveries[to].waiting]
        self._discoveries.clear()
        return waiting

    def on_packet(self, packet: object, sender: RobotId, now: int) -> None:
        if isinstance(packet, DataPacket):
            self._on_data(packet, sender, now)
        elif isinstance(packet, Rreq):
            self._on_rreq(packet, sender, now)
        elif isinstance(packet, Rrep):
            self._on_rrep(packet, sender, now)
        elif isinstance(packet, Hello):
            self._hellos.on_hello(packet, sender, now)
        elif isinstance(packet, Rerr):
            self._report_broken(self.table.apply_rerr(sender, packet.lost, now), now)
        self._send_buffered(sender, now)

    def on_heard(self, neighbour: RobotId, margin_db: float, now: int) -> None:
        self._links.on_heard(neighbour, margin_db, now)
        self._hellos.on_heard(neighbour, now)

    def on_overheard(self, packet: object, sender: RobotId, now: int) -> None:
        """Others' packets say nothing that this protocol uses but that they were heard."""

    def on_broadcast_sent(self, packet: object, now: int) -> None:
        """The timeout of a request counts from its origination (RFC 3561, 6.3)."""
        if not isinstance(packet, Hello):
            self._hellos.on_broadcast(now)

    def on_acknowledged(self, packet: object, next_hop: RobotId, now: int) -> None:
        self._links.on_acknowledged(next_hop)
        if isinstance(packet, Hello):
            self._hellos.on_acknowledged(packet, now)
        self.table.refresh(next_hop, now)

    def on_undeliverable(
        self, packet: object, next_hop: RobotId, cause: DeliveryStatus, now: int
    ) -> None:
        """Link-layer feedback (RFC 3561, 6.10); what a link gave up is handed to it again at first."""
        again = self._links.on_given_up(packet, next_hop)
        if again is None:
            self._on_broken(packet, next_hop, cause, now)
        elif isinstance(again, DataPacket):
            if not self._forward_data(again, now):
                self._find_another_route(packet, cause, now)
        elif isinstance(again, Rrep):
            self._nic.send(again, next_hop, RREP_BYTES, "rrep", now)
        elif isinstance(again, Rerr):
            self._nic.send(again, next_hop, rerr_bytes(len(again.lost)), "rerr", now)

    def _on_broken(self, packet: object, next_hop: RobotId, cause: DeliveryStatus, now: int) -> None:
        """The neighbour is gone (RFC 3561, 6.11 case i)."""
        self._on_lost(next_hop, now)
        if isinstance(packet, Rrep):
            self._blacklist[next_hop] = now + RREQ_RETRIES * NET_TRAVERSAL_NS
        self._find_another_route(packet, cause, now)

    def _find_another_route(self, packet: object, cause: DeliveryStatus, now: int) -> None:
        """The source looks for another route once; who has no other gives its data up."""
        if not isinstance(packet, DataPacket):
            return
        if packet.message.source == self._me and packet.message.discoveries < MAX_DISCOVERIES:
            self.submit(packet.afresh(), now)
        else:
            self._nic.drop(packet, cause)

    def _on_lost(self, neighbour: RobotId, now: int) -> None:
        self._report_broken(self.table.break_link(neighbour, now), now)

    # DataPacket.

    def _on_data(self, data: DataPacket, sender: RobotId, now: int) -> None:
        self._hellos.on_data(now)
        self.table.update_neighbour(sender, now)
        self.table.refresh(data.message.source, now)
        if data.message.destination == self._me:
            self._nic.deliver(data, now)
        elif not self._forward_data(data, now):
            route = self.table.entry(data.message.destination, now)
            sequence = route.sequence if route is not None else 0
            self._send_rerr(((data.message.destination, sequence),), (sender,), now)
            self._nic.drop(data, DeliveryStatus.NO_ROUTE)

    def _forward_data(self, data: DataPacket, now: int) -> bool:
        """Send a message along its route; False when there is none."""
        message = data.message
        route = self.table.usable(message.destination, now)
        if route is None or len(data.path) > NET_DIAMETER:
            return False
        self._hellos.on_data(now)
        self.table.refresh(message.destination, now)
        self.table.refresh(route.next_hop, now)
        if not self._nic.send(data, route.next_hop, message.msdu_bytes, "", now):
            self._nic.drop(data, DeliveryStatus.QUEUE_FULL)
        return True

    def _update_neighbour(self, neighbour: RobotId, now: int) -> None:
        """A packet came from a neighbour (RFC 3561, 6.2)."""
        route = self.table.usable(neighbour, now)
        if route is None or route.hops == 1 or self._links.is_worthwhile(neighbour, now):
            self.table.update_neighbour(neighbour, now)

    # Discovery by the origin.

    def _buffer(self, data: DataPacket, now: int) -> None:
        if data.message.expires <= now:
            self._nic.drop(data, DeliveryStatus.EXPIRED)
            return
        if self.buffered >= BUFFER_MESSAGES:
            self._nic.drop(data, DeliveryStatus.QUEUE_FULL)
            return
        self.buffered += 1
        if data.message.expires != NEVER:
            self._nic.at(data.message.expires, self._on_expired, data)
        destination = data.message.destination
        data.message.begin_discovery(now)
        discovery = self._discoveries.get(destination)
        if discovery is not None:
            discovery.waiting.append(data)
            return
        known = self.table.entry(destination, now)
        ttl = TTL_START if known is None else min(known.hops + TTL_INCREMENT, TTL_THRESHOLD)
        discovery = self._discoveries[destination] = RouteDiscovery(destination, ttl, waiting=[data])
        self._request_route(discovery, now)

    def _request_route(self, discovery: RouteDiscovery, now: int) -> None:
        """Send the discovery's next request, or wait for the rate limit (RFC 3561, 6.3 and 6.4)."""
        if self._discoveries.get(discovery.destination) is not discovery:
            return
        if not discovery.waiting:
            self._end_discovery(discovery, now)
            return
        wait_until = self._requests.next_allowed(now)
        if wait_until > now:
            self._nic.at(wait_until, self._request_route, discovery)
            return
        self._number += 1
        discovery.number = self._number
        self._sequence = following(self._sequence)
        known = self.table.entry(discovery.destination, now)
        request = Rreq(
            origin=self._me,
            origin_sequence=self._sequence,
            number=self._number,
            destination=discovery.destination,
            sequence=known.sequence if known is not None and known.sequence_known else None,
            hops=0,
            ttl=discovery.ttl,
            normal=discovery.ttl > TTL_THRESHOLD,
            destination_only=now < self._reboot_hold_until,
        )
        self._seen.is_new(request, now)
        self._nic.send(request, BROADCAST, RREQ_BYTES, "rreq", now)
        if discovery.ttl > TTL_THRESHOLD:
            timeout = NET_TRAVERSAL_NS << discovery.network_wide
            discovery.network_wide += 1
        else:
            timeout = 2 * NODE_TRAVERSAL_NS * (discovery.ttl + TIMEOUT_BUFFER)
        self._nic.at(now + timeout, self._on_no_reply, (discovery, discovery.number))

    def _on_expired(self, data: DataPacket, now: int) -> None:
        """A message is of no use any more. Its discovery goes on if others come before the next
        request."""
        discovery = self._discoveries.get(data.message.destination)
        if discovery is not None and data in discovery.waiting:
            discovery.waiting.remove(data)
            self.buffered -= 1
            data.message.end_discovery(now)
            self._nic.drop(data, DeliveryStatus.EXPIRED)

    def _on_no_reply(self, requested: tuple[RouteDiscovery, int], now: int) -> None:
        discovery, number = requested
        if self._discoveries.get(discovery.destination) is not discovery or discovery.number != number:
            return
        if discovery.network_wide > RREQ_RETRIES:
            for data in self._end_discovery(discovery, now):
                self._nic.drop(data, DeliveryStatus.NO_ROUTE)
            return
        discovery.ttl += TTL_INCREMENT
        if discovery.ttl > TTL_THRESHOLD:
            discovery.ttl = NET_DIAMETER
        jitter = round(self._nic.uniform() * BROADCAST_JITTER_NS)
        self._nic.at(now + jitter, self._request_route, discovery)

    def _end_discovery(self, discovery: RouteDiscovery, now: int) -> list[DataPacket]:
        del self._discoveries[discovery.destination]
        self.buffered -= len(discovery.waiting)
        for data in discovery.waiting:
            data.message.end_discovery(now)
        return discovery.waiting

    # Requests, replies and errors of others.

    def _on_rreq(self, request: Rreq, sender: RobotId, now: int) -> None:
        if request.origin == self._me or self._blacklist.get(sender, now) > now:
            return
        if self._links.is_worthwhile(sender, now):
            self._take_rreq((request, sender), now)
        else:
            self._nic.at(now + WEAK_REQUEST_WAIT_NS, self._take_rreq, (request, sender))

    def _take_rreq(self, received: tuple[Rreq, RobotId], now: int) -> None:
        """Process a request whose time has come (RFC 3561, 6.5)."""
        request, sender = received
        self._update_neighbour(sender, now)
        if not self._seen.is_new(request, now):
            return
        hops = request.hops + 1
        lifetime = 2 * NET_TRAVERSAL_NS - 2 * hops * NODE_TRAVERSAL_NS
        self.table.update(request.origin, sender, hops, request.origin_sequence, now + lifetime, now)
        if request.destination == self._me:
            if request.sequence is not None:
                self._sequence = newest(self._sequence, request.sequence)
            self._reply(Rrep(request.origin, self._me, self._sequence, 0, MY_ROUTE_NS), now)
            self._send_buffered(request.origin, now)
            return
        route = self.table.usable(request.destination, now)
        if route is not None and self._may_reply_from_table(request, route, now):
            self._reply_from_table(request, route, sender, now)
        elif request.ttl > 1:
            self._forward_rreq(request, hops, now)
        self._send_buffered(request.origin, now)

    def _may_reply_from_table(self, request: Rreq, route: Route, now: int) -> bool:
        """Whether a route in the table is fresh enough to reply with (RFC 3561, 6.6)."""
        if request.destination_only or now < self._reboot_hold_until or not route.sequence_known:
            return False
        return request.sequence is None or not newer(request.sequence, route.sequence)

    def _reply_from_table(self, request: Rreq, route: Route, sender: RobotId, now: int) -> None:
        """Reply for the destination, with a gratuitous one for itself (RFC 3561, 6.6.2 and 6.6.3)."""
        route.add_precursor(sender)
        back = self.table.usable(request.origin, now)
        if back is not None:
            back.add_precursor(route.next_hop)
            known = Rrep(route.destination, request.origin, back.sequence, back.hops, back.expires - now)
            self._nic.send(known, route.next_hop, RREP_BYTES, "rrep", now)
        lifetime = route.expires - now
        self._reply(Rrep(request.origin, route.destination, route.sequence, route.hops, lifetime), now)

    def _forward_rreq(self, request: Rreq, hops: int, now: int) -> None:
        if not request.normal:
            weight = gamma(self._nic.remaining_distance(), self._gamma_distance)
            if self._nic.uniform() >= forwarding_probability(self._nic.speed(), weight):
                return
        sequence = request.sequence
        known = self.table.entry(request.destination, now)
        if known is not None and known.sequence_known:
            sequence = known.sequence if sequence is None else newest(sequence, known.sequence)
        onward = replace(
            request,
            hops=hops,
            ttl=request.ttl - 1,
            sequence=sequence,
            destination_only=request.destination_only or now < self._reboot_hold_until,
        )
        jitter = round(self._nic.uniform() * BROADCAST_JITTER_NS)
        self._nic.at(now + jitter, self._send_rreq, onward)

    def _send_rreq(self, request: Rreq, now: int) -> None:
        self._nic.send(request, BROADCAST, RREQ_BYTES, "rreq", now)

    def _reply(self, reply: Rrep, now: int) -> None:
        """Send a reply one hop back towards the origin of its request."""
        back = self.table.usable(reply.origin, now)
        if back is not None:
            self._nic.send(reply, back.next_hop, RREP_BYTES, "rrep", now)

    def _on_rrep(self, reply: Rrep, sender: RobotId, now: int) -> None:
        self.table.update_neighbour(sender, now)
        hops = reply.hops + 1
        taken = reply.destination != self._me and self.table.update(
            reply.destination, sender, hops, reply.sequence, now + reply.lifetime, now
        )
        if taken and reply.origin != self._me:
            forward = self.table.usable(reply.destination, now)
            back = self.table.usable(reply.origin, now)
            if forward is not None and back is not None:
                forward.add_precursor(back.next_hop)
                back.add_precursor(forward.next_hop)
                back.expires = max(back.expires, now + ACTIVE_ROUTE_NS)
                self._nic.send(replace(reply, hops=hops), back.next_hop, RREP_BYTES, "rrep", now)
        self._send_buffered(reply.destination, now)

    def _send_buffered(self, destination: RobotId, now: int) -> None:
        """Send the messages that waited for a route that is there now."""
        discovery = self._discoveries.get(destination)
        if discovery is not None and self.table.usable(destination, now) is not None:
            for data in self._end_discovery(discovery, now):
                self.submit(data, now)

    def _report_broken(self, broken: list[Route], now: int) -> None:
        """Send an error to the precursors of routes that broke (RFC 3561, 6.11)."""
        in_use = [route for route in broken if route.precursors]
        precursors = tuple(sorted({robot for route in in_use for robot in route.precursors}))
        if in_use:
            self._send_rerr(tuple((r.destination, r.sequence) for r in in_use), precursors, now)
        for route in broken:
            route.precursors.clear()

    def _send_rerr(
        self, lost: tuple[tuple[RobotId, int], ...], receivers: tuple[RobotId, ...], now: int
    ) -> None:
        if self._errors.next_allowed(now) > now:
            return
        target = receivers[0] if len(receivers) == 1 else BROADCAST
        self._nic.send(Rerr(lost), target, rerr_bytes(len(lost)), "rerr", now)
