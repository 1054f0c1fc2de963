"""MRSR: DSR (RFC 4728) whose ROUTE REQUESTs are passed on with a probability (thesis 3.7.2).

Left out, as the RFC allows: flow state, piggybacking. Route maintenance is the link layer's
acknowledgement (8.3.1): a packet that it gives up is handed to it again (links.py).

Differs: the probability holds for the first propagating request of a discovery; all later ones carry
the flag for normal forwarding. The source discovers a route for a message twice at most, and its time
in the send buffer counts from when it was handed over. A robot that waits to reply out of its cache
listens for others' replies, not for the origin's first data (8.2.5), and routes are learnt from others'
replies and errors but not from their data (3.3.1), because a NIC hands up others' data here only to
those that it is still to come to. A link on which something was overheard is taken for one if it is
worthwhile (links.py); 3.3.1 and 3.4.3 leave that open. A target replies to the copies of a request that
came no farther than the first one, because in one cell every neighbour passes one on.
"""

from dataclasses import dataclass, field, replace

from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import BROADCAST, RobotId
from radio_proxy.core.data_message import MAX_DISCOVERIES, DataPacket
from radio_proxy.core.routing.forwarding import BROADCAST_JITTER_NS, forwarding_probability, gamma
from radio_proxy.core.routing.interface import NicServices
from radio_proxy.core.routing.links import Links
from radio_proxy.core.routing.mrsr_cache import RouteCache
from radio_proxy.core.routing.mrsr_packets import (
    Rerr,
    Rrep,
    Rreq,
    after,
    source_route_bytes,
    without_loops,
)
from radio_proxy.core.routing.mrsr_shortening import GratuitousReplies

MS = 1_000_000
"""Nanoseconds in a millisecond."""

# Timers and limits of RFC 4728, section 9.

NONPROPAGATING_NS = 30 * MS
"""NonpropRequestTimeout: how long the request to the neighbours alone waits for its reply [ns]."""

REQUEST_PERIOD_NS = 500 * MS
"""RequestPeriod: the same of the first request through the whole network; it doubles then [ns]."""

MAX_REQUEST_PERIOD_NS = 10_000 * MS
"""MaxRequestPeriod: up to which it doubles [ns]."""

MAX_REQUESTS = 16
"""MaxRequestRexmt: repetitions of a request in one discovery."""

REQUEST_IDS = 16
"""RequestTableIds: requests of one robot that are remembered."""

HOP_LIMIT = 255
"""DiscoveryHopLimit of a request through the whole network [hops]."""

SEND_BUFFER = 64
"""Messages that wait for routes; the newest is dropped when it is full (4.2 leaves the size open)."""

SEND_BUFFER_TIMEOUT_NS = 30_000 * MS
"""SendBufferTimeout [ns]."""

MAX_SALVAGE = 15
"""MaxSalvageCount: how often one message is sent along another route by a robot on its way."""

BLACKLIST_NS = 5000 * MS
"""How long a neighbour that acknowledges no replies stays on the blacklist (4.6 leaves it open) [ns]."""


@dataclass(slots=True, eq=False)
class RouteDiscovery:
    """A discovery under way. sent: requests so far; number, timeout [ns]: of the last one."""

    target: RobotId
    sent: int = 0
    number: int = 0
    timeout: int = 0
    waiting: list[DataPacket] = field(default_factory=list)


class MrsrRouter:
    """DSR on one robot."""

    def __init__(self, nic: NicServices, gamma_distance: float) -> None:
        self.cache = RouteCache(nic.robot)
        self._nic = nic
        self._me = nic.robot
        self._links = Links()
        self._gratuitous = GratuitousReplies(nic.robot)
        self._gamma_distance = gamma_distance
        self._number = nic.incarnation << 16
        self._discoveries: dict[RobotId, RouteDiscovery] = {}
        self.buffered = 0
        self._seen: dict[RobotId, dict[int, int]] = {}
        self._blacklist: dict[RobotId, int] = {}
        self._pending_replies: dict[tuple[RobotId, int], int] = {}

    def submit(self, data: DataPacket, now: int) -> None:
        if data.message.destination in self._discoveries or not self._send_along_cache(data, now):
            self._buffer(data, now)

    def abandon(self) -> list[DataPacket]:
        waiting = [
            data for target in sorted(self._discoveries) for data in self._discoveries[target].waiting
        ]
        self._discoveries.clear()
        return waiting

    def remembered_requests(self) -> int:
        """How many requests of others are remembered (at most 16 a robot, RFC 4728, 4.3)."""
        return sum(len(seen) for seen in self._seen.values())

    def on_packet(self, packet: object, sender: RobotId, now: int) -> None:
        if isinstance(packet, DataPacket):
            self._on_data(packet, now)
        elif isinstance(packet, Rreq):
            self._on_rreq(packet, sender, now)
        elif isinstance(packet, Rrep):
            self._on_rrep(packet, now)
        elif isinstance(packet, Rerr):
            self.cache.remove_link(packet.a, packet.b)
            if packet.back[-1] != self._me:
                self._send_rerr(packet, now)

    def on_heard(self, neighbour: RobotId, margin_db: float, now: int) -> None:
        self._links.on_heard(neighbour, margin_db, now)

    def on_overheard(self, packet: object, sender: RobotId, now: int) -> None:
        """Others' replies and errors teach as one's own do (RFC 4728, 3.3.1); data shortens routes.

        A reply that is as short as the one that waits here makes that one needless (8.2.5).
        """
        if isinstance(packet, Rerr):
            self.cache.remove_link(packet.a, packet.b)
            return
        if isinstance(packet, Rrep):
            mine = self._pending_replies.get((packet.found[0], packet.number))
            if mine is not None and len(packet.found) <= mine:
                del self._pending_replies[packet.found[0], packet.number]
        if not self._links.is_worthwhile(sender, now):
            return
        if isinstance(packet, Rrep):
            here = packet.found.index(sender)
            self.cache.add((self._me, *packet.found[here:]), now)
            self.cache.add((self._me, *packet.found[here::-1]), now)
            self._send_buffered(now)
        elif isinstance(packet, DataPacket):
            reply = self._gratuitous.reply_to(packet, sender, now)
            if reply is not None:
                self._send_rrep(reply, now)

    def on_broadcast_sent(self, packet: object, now: int) -> None:
        """The timeout of a request counts from its transmission."""
        if isinstance(packet, Rreq) and packet.origin == self._me:
            discovery = self._discoveries.get(packet.target)
            if discovery is not None and discovery.number == packet.number:
                self._nic.at(now + discovery.timeout, self._request_route, discovery)

    def on_acknowledged(self, packet: object, next_hop: RobotId, now: int) -> None:
        """The link holds; a reply has come a hop of the way that it takes (RFC 4728, 8.1.4)."""
        self._links.on_acknowledged(next_hop)
        if isinstance(packet, Rrep):
            self._cache_route(packet.back, now)

    def on_undeliverable(
        self, packet: object, next_hop: RobotId, cause: DeliveryStatus, now: int
    ) -> None:
        """A link that is broken is forgotten, its source told, its data salvaged (RFC 4728, 8.3)."""
        again = self._links.on_given_up(packet, next_hop)
        if isinstance(again, DataPacket):
            self._send_on(again, now)
        elif isinstance(again, Rrep):
            self._send_rrep(again, now)
        elif isinstance(again, Rerr):
            self._send_rerr(again, now)
        else:
            self._on_broken(packet, next_hop, cause, now)

    def _on_broken(self, packet: object, next_hop: RobotId, cause: DeliveryStatus, now: int) -> None:
        """Forget the link, tell the source, salvage (RFC 4728, 8.3.4 and 8.3.6)."""
        self.cache.remove_link(self._me, next_hop)
        if isinstance(packet, Rrep):
            self._blacklist[next_hop] = now + BLACKLIST_NS
        if not isinstance(packet, DataPacket):
            return
        at_origin = packet.message.source == self._me
        if not at_origin:
            back = without_loops(packet.path)[::-1]
            if len(back) > 1:
                self._send_rerr(Rerr(self._me, next_hop, back), now)
        again = packet.salvage()
        if again.salvaged <= MAX_SALVAGE and self._send_along_cache(again, now):
            return
        if at_origin and packet.message.discoveries < MAX_DISCOVERIES:
            self._buffer(again, now)
        else:
            self._nic.drop(packet, cause)

    def _send_rerr(self, error: Rerr, now: int) -> None:
        self._nic.send(error, after(error.back, self._me), error.size_bytes, "rerr", now)

    # DataPacket.

    def _send_along_cache(self, data: DataPacket, now: int) -> bool:
        """Give a message a source route out of the cache; False when there is none."""
        route = self.cache.find(data.message.destination, now)
        if route is None:
            return False
        self._send_on(data.along(route), now)
        return True

    def _send_on(self, data: DataPacket, now: int) -> None:
        size = data.message.msdu_bytes + source_route_bytes(data.route)
        if not self._nic.send(data, after(data.route, self._me), size, "", now):
            self._nic.drop(data, DeliveryStatus.QUEUE_FULL)

    def _on_data(self, data: DataPacket, now: int) -> None:
        self._cache_route(data.route, now)
        if data.message.destination == self._me:
            self._nic.deliver(data, now)
        else:
            self._send_on(data, now)

    def _cache_route(self, route: tuple[RobotId, ...], now: int) -> None:
        """Cache both directions of a route that lists this robot (RFC 4728, 8.1.4)."""
        if self._me in route:
            here = route.index(self._me)
            if here + 1 < len(route):
                self.cache.add(route[here:], now)
            self.cache.add(route[here::-1], now)
            self._send_buffered(now)

    # Discovery by the origin.

    def _buffer(self, data: DataPacket, now: int) -> None:
        if data.message.expires <= now:
            self._nic.drop(data, DeliveryStatus.EXPIRED)
            return
        if self.buffered >= SEND_BUFFER:
            self._nic.drop(data, DeliveryStatus.QUEUE_FULL)
            return
        self.buffered += 1
        data.message.begin_discovery(now)
        deadline = max(now, data.message.offered + SEND_BUFFER_TIMEOUT_NS)
        self._nic.at(min(deadline, data.message.expires), self._on_buffer_timeout, data)
        target = data.message.destination
        discovery = self._discoveries.get(target)
        if discovery is not None:
            discovery.waiting.append(data)
            return
        discovery = self._discoveries[target] = RouteDiscovery(target, waiting=[data])
        self._request_route(discovery, now)

    def _request_route(self, discovery: RouteDiscovery, now: int) -> None:
        """The next request: to the neighbours, then to all, ever more rarely (RFC 4728, 8.2.1)."""
        if self._discoveries.get(discovery.target) is not discovery:
            return
        if not discovery.waiting or discovery.sent > MAX_REQUESTS:
            for data in self._end_discovery(discovery, now):
                self._nic.drop(data, DeliveryStatus.NO_ROUTE)
            return
        self._number += 1
        first = discovery.sent == 0
        request = Rreq(
            number=self._number,
            target=discovery.target,
            route=(self._me,),
            ttl=1 if first else HOP_LIMIT,
            normal=discovery.sent > 1,
        )
        period = REQUEST_PERIOD_NS << max(0, discovery.sent - 1)
        discovery.sent += 1
        discovery.number = self._number
        discovery.timeout = NONPROPAGATING_NS if first else min(period, MAX_REQUEST_PERIOD_NS)
        if not self._nic.send(request, BROADCAST, request.size_bytes, "rreq", now):
            self._nic.at(now + discovery.timeout, self._request_route, discovery)

    def _on_buffer_timeout(self, data: DataPacket, now: int) -> None:
        """A message has waited long enough; others may come before the next request of its discovery."""
        discovery = self._discoveries.get(data.message.destination)
        if discovery is None or data not in discovery.waiting:
            return
        self._unbuffer(data, discovery, now)
        expired = data.message.expires <= now
        self._nic.drop(data, DeliveryStatus.EXPIRED if expired else DeliveryStatus.NO_ROUTE)

    def _end_discovery(self, discovery: RouteDiscovery, now: int) -> tuple[DataPacket, ...]:
        del self._discoveries[discovery.target]
        waited = tuple(discovery.waiting)
        for data in waited:
            self._unbuffer(data, discovery, now)
        return waited

    def _unbuffer(self, data: DataPacket, discovery: RouteDiscovery, now: int) -> None:
        discovery.waiting.remove(data)
        self.buffered -= 1
        data.message.end_discovery(now)

    def _send_buffered(self, now: int) -> None:
        """Send whatever waited for a route that the cache has now (RFC 4728, 8.2.6)."""
        if not self._discoveries:
            return
        for target in sorted(self._discoveries):
            if self.cache.find(target, now) is not None:
                for data in self._end_discovery(self._discoveries[target], now):
                    self.submit(data, now)

    # Requests and replies of others.

    def _on_rreq(self, request: Rreq, sender: RobotId, now: int) -> None:
        if self._me in request.route or self._blacklist.get(sender, now) > now:
            return
        route = (*request.route, self._me)
        self._cache_route(route, now)
        first_length = self._first_length(request, len(route))
        if request.target == self._me:
            if not first_length or len(route) <= first_length:
                delay = round(self._nic.uniform() * BROADCAST_JITTER_NS)
                self._nic.at(now + delay, self._send_rrep, Rrep(request.number, route, route[::-1]))
            return
        if first_length:
            return
        cached = self.cache.find(request.target, now)
        if cached is not None and not set(request.route) & set(cached):
            reply = Rrep(request.number, (*request.route, *cached), route[::-1])
            self._pending_replies[request.origin, request.number] = len(reply.found)
            wait = BROADCAST_JITTER_NS * (len(reply.found) - 2 + self._nic.uniform())
            self._nic.at(now + round(wait), self._send_unless_cancelled, reply)
        elif request.ttl > 1:
            self._forward_rreq(replace(request, route=route, ttl=request.ttl - 1), now)

    def _first_length(self, request: Rreq, length: int) -> int:
        """Length of the route by which this request came first; 0 when it has not come before."""
        seen = self._seen.setdefault(request.origin, {})
        first = seen.setdefault(request.number, 0)
        if not first:
            seen[request.number] = length
        if len(seen) > REQUEST_IDS:
            del seen[next(iter(seen))]
        return first

    def _forward_rreq(self, request: Rreq, now: int) -> None:
        if not request.normal:
            weight = gamma(self._nic.remaining_distance(), self._gamma_distance)
            if self._nic.uniform() >= forwarding_probability(self._nic.speed(), weight):
                return
        self._nic.at(now + round(self._nic.uniform() * BROADCAST_JITTER_NS), self._send_rreq, request)

    def _send_rreq(self, request: Rreq, now: int) -> None:
        self._nic.send(request, BROADCAST, request.size_bytes, "rreq", now)

    def _send_unless_cancelled(self, reply: Rrep, now: int) -> None:
        if self._pending_replies.pop((reply.found[0], reply.number), None) is not None:
            self._send_rrep(reply, now)

    def _send_rrep(self, reply: Rrep, now: int) -> None:
        self._nic.send(reply, after(reply.back, self._me), reply.size_bytes, "rrep", now)

    def _on_rrep(self, reply: Rrep, now: int) -> None:
        self._cache_route(reply.found, now)
        if reply.back[-1] != self._me:
            self._send_rrep(reply, now)
