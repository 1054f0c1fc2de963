"""MRSR: DSR (RFC 4728) whose ROUTE REQUESTs are passed on with a probability (thesis 3.7.2).

Left out, as the RFC allows: flow state, automatic route shortening, piggybacking. Route maintenance is
the link layer's acknowledgement (8.3.1); its seven attempts contain MaxMaintRexmt's two.

Differs: the probability holds for the first propagating request of a discovery; all later ones carry the
flag for normal forwarding. At the origin a message is searched for twice at most, and its time in the
send buffer counts from when it was handed over. A robot that waits to reply out of its cache listens for
others' replies, not for the origin's first data (8.2.5), and routes are learnt from others' replies and
errors but not from their data (3.3.1), because control packets are the only frames of others that a card
hands up here. A target answers the copies of a request that came no farther than the first
one, because in one cell every neighbour passes one on.
"""

from dataclasses import dataclass, field, replace

from onehop.contracts.messages import BROADCAST, DeliveryStatus
from radio_proxy.core.data_message import SEARCHES, DataPacket
from radio_proxy.core.routing.forwarding import BROADCAST_JITTER_NS, forwarding_probability, gamma
from radio_proxy.core.routing.interface import Host
from radio_proxy.core.routing.mrsr_cache import RouteCache
from radio_proxy.core.routing.mrsr_packets import (
    Rerr,
    Rrep,
    Rreq,
    after,
    source_route_bytes,
    without_loops,
)

MS = 1_000_000
NONPROPAGATING_NS = 30 * MS
REQUEST_PERIOD_NS = 500 * MS
MAX_REQUEST_PERIOD_NS = 10_000 * MS
MAX_REQUESTS = 16
REQUEST_IDS = 16
HOP_LIMIT = 255
SEND_BUFFER = 64
SEND_BUFFER_TIMEOUT_NS = 30_000 * MS
MAX_SALVAGE = 15
BLACKLIST_NS = 5000 * MS
"""Timers and limits of RFC 4728, section 9 (the blacklist's is left to the implementation there)."""


@dataclass(slots=True, eq=False)
class RouteDiscovery:
    """A discovery under way. sent: requests so far; number, patience [ns]: of the last one."""

    target: int
    sent: int = 0
    number: int = 0
    patience: int = 0
    waiting: list[DataPacket] = field(default_factory=list)


class MrsrRouter:
    """DSR on one robot."""

    def __init__(self, host: Host, gamma_distance: float) -> None:
        self.cache = RouteCache(host.robot)
        self._host = host
        self._me = host.robot
        self._gamma_distance = gamma_distance
        self._number = host.incarnation << 16
        self._searches: dict[int, RouteDiscovery] = {}
        self.buffered = 0
        self._seen: dict[int, dict[int, int]] = {}
        self._blacklist: dict[int, int] = {}
        self._pending: dict[tuple[int, int], int] = {}

    def submit(self, data: DataPacket, now: int) -> None:
        if data.message.destination in self._searches or not self._send_along_cache(data, now):
            self._wait(data, now)

    def abandon(self) -> list[DataPacket]:
        waiting = [data for target in sorted(self._searches) for data in self._searches[target].waiting]
        self._searches.clear()
        return waiting

    def remembered_requests(self) -> int:
        """How many requests of others are remembered (at most 16 a robot, RFC 4728, 4.3)."""
        return sum(len(seen) for seen in self._seen.values())

    def on_packet(self, packet: object, sender: int, now: int) -> None:
        if isinstance(packet, DataPacket):
            self._on_data(packet, now)
        elif isinstance(packet, Rreq):
            self._on_rreq(packet, sender, now)
        elif isinstance(packet, Rrep):
            self._on_rrep(packet, now)
        elif isinstance(packet, Rerr):
            self.cache.forget_link(packet.a, packet.b)
            if packet.back[-1] != self._me:
                self._host.send(packet, after(packet.back, self._me), packet.size_bytes, "rerr", now)

    def on_overheard(self, packet: object, sender: int, now: int) -> None:
        """Others' replies and errors teach as one's own do (RFC 4728, 3.3.1).

        A reply that is as short as the one that waits here makes that one needless (8.2.5).
        """
        if isinstance(packet, Rrep):
            mine = self._pending.get((packet.found[0], packet.number))
            if mine is not None and len(packet.found) <= mine:
                del self._pending[packet.found[0], packet.number]
            here = packet.found.index(sender)
            self.cache.add((self._me, *packet.found[here:]), now)
            self.cache.add((self._me, *packet.found[here::-1]), now)
            self._flush(now)
        elif isinstance(packet, Rerr):
            self.cache.forget_link(packet.a, packet.b)

    def on_broadcast(self, packet: object, now: int) -> None:
        """The patience with a request counts from when it is on the air."""
        if isinstance(packet, Rreq) and packet.origin == self._me:
            search = self._searches.get(packet.target)
            if search is not None and search.number == packet.number:
                self._host.at(now + search.patience, self._ask, search)

    def on_acknowledged(self, packet: object, next_hop: int, now: int) -> None:
        """A confirmed link needs no mark: a path holds until it fails or is too old."""

    def on_undeliverable(self, packet: object, next_hop: int, cause: DeliveryStatus, now: int) -> None:
        """The link is broken: forget it, tell the source, salvage (RFC 4728, 8.3.4 and 8.3.6)."""
        self.cache.forget_link(self._me, next_hop)
        if isinstance(packet, Rrep):
            self._blacklist[next_hop] = now + BLACKLIST_NS
        if not isinstance(packet, DataPacket):
            return
        at_origin = packet.message.source == self._me
        if not at_origin:
            back = without_loops(packet.path)[::-1]
            error = Rerr(self._me, next_hop, back)
            if len(back) > 1:
                self._host.send(error, back[1], error.size_bytes, "rerr", now)
        again = replace(packet, attempts=packet.attempts[:-1], salvaged=packet.salvaged + 1)
        if again.salvaged <= MAX_SALVAGE and self._send_along_cache(again, now):
            return
        if at_origin and packet.message.searches < SEARCHES:
            self._wait(again, now)
        else:
            self._host.drop(packet, cause)

    # DataPacket.

    def _send_along_cache(self, data: DataPacket, now: int) -> bool:
        """Give a message a source route out of the cache; False when there is none."""
        route = self.cache.find(data.message.destination, now)
        if route is None:
            return False
        self._send_on(replace(data, route=route), now)
        return True

    def _send_on(self, data: DataPacket, now: int) -> None:
        size = data.message.msdu_bytes + source_route_bytes(data.route)
        if not self._host.send(data, after(data.route, self._me), size, "", now):
            self._host.drop(data, DeliveryStatus.QUEUE_FULL)

    def _on_data(self, data: DataPacket, now: int) -> None:
        self._learn(data.route, now)
        if data.message.destination == self._me:
            self._host.deliver(data, now)
        else:
            self._send_on(data, now)

    def _learn(self, route: tuple[int, ...], now: int) -> None:
        """Cache both directions of a route that lists this robot (RFC 4728, 8.1.4)."""
        if self._me in route:
            here = route.index(self._me)
            if here + 1 < len(route):
                self.cache.add(route[here:], now)
            self.cache.add(route[here::-1], now)
            self._flush(now)

    # Discovery by the origin.

    def _wait(self, data: DataPacket, now: int) -> None:
        if self.buffered >= SEND_BUFFER:
            self._host.drop(data, DeliveryStatus.QUEUE_FULL)
            return
        self.buffered += 1
        data.message.begin_search(now)
        deadline = data.message.offered + SEND_BUFFER_TIMEOUT_NS
        self._host.at(max(now, deadline), self._on_waited_too_long, data)
        target = data.message.destination
        search = self._searches.get(target)
        if search is not None:
            search.waiting.append(data)
            return
        search = self._searches[target] = RouteDiscovery(target, waiting=[data])
        self._ask(search, now)

    def _ask(self, search: RouteDiscovery, now: int) -> None:
        """The next request: the neighbours first, then the net, ever more rarely (RFC 4728, 8.2.1)."""
        if self._searches.get(search.target) is not search:
            return
        if search.sent > MAX_REQUESTS:
            self._give_up(list(search.waiting), now)
            return
        self._number += 1
        first = search.sent == 0
        request = Rreq(
            number=self._number,
            target=search.target,
            route=(self._me,),
            ttl=1 if first else HOP_LIMIT,
            normal=search.sent > 1,
        )
        period = REQUEST_PERIOD_NS << max(0, search.sent - 1)
        search.sent += 1
        search.number = self._number
        search.patience = NONPROPAGATING_NS if first else min(period, MAX_REQUEST_PERIOD_NS)
        if not self._host.send(request, BROADCAST, request.size_bytes, "rreq", now):
            self._host.at(now + search.patience, self._ask, search)

    def _on_waited_too_long(self, data: DataPacket, now: int) -> None:
        search = self._searches.get(data.message.destination)
        if search is not None and data in search.waiting:
            self._give_up([data], now)

    def _give_up(self, waiting: list[DataPacket], now: int) -> None:
        for data in waiting:
            self._take_out(data, now)
            self._host.drop(data, DeliveryStatus.NO_ROUTE)

    def _take_out(self, data: DataPacket, now: int) -> None:
        """A message leaves the send buffer; with the last one its discovery ends."""
        search = self._searches[data.message.destination]
        search.waiting.remove(data)
        if not search.waiting:
            del self._searches[search.target]
        self.buffered -= 1
        data.message.end_search(now)

    def _flush(self, now: int) -> None:
        """Send whatever waited for a route that the cache has now (RFC 4728, 8.2.6)."""
        if not self._searches:
            return
        for target in sorted(self._searches):
            if self.cache.find(target, now) is not None:
                found = tuple(self._searches[target].waiting)
                for data in found:
                    self._take_out(data, now)
                for data in found:
                    self.submit(data, now)

    # Requests and replies of others.

    def _on_rreq(self, request: Rreq, sender: int, now: int) -> None:
        if self._me in request.route or self._blacklist.get(sender, now) > now:
            return
        route = (*request.route, self._me)
        self._learn(route, now)
        first_length = self._first_length(request, len(route))
        if request.target == self._me:
            if not first_length or len(route) <= first_length:
                delay = round(self._host.uniform() * BROADCAST_JITTER_NS)
                self._host.at(now + delay, self._send_rrep, Rrep(request.number, route, route[::-1]))
            return
        if first_length:
            return
        cached = self.cache.find(request.target, now)
        if cached is not None and not set(request.route) & set(cached):
            reply = Rrep(request.number, (*request.route, *cached), route[::-1])
            self._pending[request.origin, request.number] = len(reply.found)
            wait = BROADCAST_JITTER_NS * (len(reply.found) - 2 + self._host.uniform())
            self._host.at(now + round(wait), self._send_unless_needless, reply)
        elif request.ttl > 1:
            self._pass_on(replace(request, route=route, ttl=request.ttl - 1), now)

    def _first_length(self, request: Rreq, length: int) -> int:
        """Length of the route by which this request came first; 0 when it has not come before."""
        seen = self._seen.setdefault(request.origin, {})
        first = seen.setdefault(request.number, 0)
        if not first:
            seen[request.number] = length
        if len(seen) > REQUEST_IDS:
            del seen[next(iter(seen))]
        return first

    def _pass_on(self, request: Rreq, now: int) -> None:
        if not request.normal:
            weight = gamma(self._host.remaining_distance(), self._gamma_distance)
            if self._host.uniform() >= forwarding_probability(self._host.speed(), weight):
                return
        self._host.at(now + round(self._host.uniform() * BROADCAST_JITTER_NS), self._send_rreq, request)

    def _send_rreq(self, request: Rreq, now: int) -> None:
        self._host.send(request, BROADCAST, request.size_bytes, "rreq", now)

    def _send_unless_needless(self, reply: Rrep, now: int) -> None:
        if self._pending.pop((reply.found[0], reply.number), None) is not None:
            self._send_rrep(reply, now)

    def _send_rrep(self, reply: Rrep, now: int) -> None:
        self._host.send(reply, after(reply.back, self._me), reply.size_bytes, "rrep", now)

    def _on_rrep(self, reply: Rrep, now: int) -> None:
        self._learn(reply.found, now)
        if reply.back[-1] != self._me:
            self._send_rrep(reply, now)
