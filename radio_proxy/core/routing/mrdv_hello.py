"""Hellos of AODV (RFC 3561, 6.9): one neighbour tells another that there is a direct link.

A hello is a ROUTE REPLY of a robot for the route to itself. Here it is sent in two ways.

As an offer, to a neighbour that is reached over relays though it is heard well: beacons, and data that
is still to come over others, do what periodic hellos would. Differs: the offer is a unicast, so its
RTS, CTS and ACK prove both directions before any route is given up; who takes it and who hears it
acknowledged have a route of one hop.

As the RFC's broadcast, every `hello_s` if a scenario sets that: by robots that had to do with data
lately and have broadcast nothing else. A neighbour that sent some and is heard no more is lost.
"""

from collections.abc import Callable

from radio_proxy.core.addresses import BROADCAST, RobotId
from radio_proxy.core.routing.forwarding import BROADCAST_JITTER_NS
from radio_proxy.core.routing.interface import NicServices
from radio_proxy.core.routing.links import Links
from radio_proxy.core.routing.mrdv_packets import RREP_BYTES, Hello
from radio_proxy.core.routing.mrdv_table import ACTIVE_ROUTE_NS, RouteTable

OFFER_PERIOD_NS = 1_000_000_000
"""Least time between two offers to one neighbour: HELLO_INTERVAL (RFC 3561, section 10) [ns]."""

ALLOWED_HELLO_LOSS = 2
"""Periods of silence after which a neighbour that sent hellos is lost (RFC 3561, section 10)."""


class Hellos:
    """The hellos of one robot.

    period: of the broadcasts, 0 for none [ns]. sequence: the robot's own number now. on_lost: called
    with a neighbour that is heard no more.
    """

    def __init__(
        self,
        nic: NicServices,
        links: Links,
        table: RouteTable,
        sequence: Callable[[], int],
        on_lost: Callable[[RobotId, int], None],
        period: int,
        now: int,
    ) -> None:
        self._nic = nic
        self._links = links
        self._table = table
        self._sequence = sequence
        self._on_lost = on_lost
        self._period = period
        self._offered: dict[RobotId, int] = {}
        self._last_heard: dict[RobotId, int] = {}
        self._active_until = now
        self._last_broadcast = now - period
        if period:
            nic.at(now + round(nic.uniform() * period), self._on_period, None)

    def on_heard(self, neighbour: RobotId, now: int) -> None:
        """A frame came from a neighbour; offer it a direct route if it is reached over relays."""
        if neighbour in self._last_heard:
            self._last_heard[neighbour] = now
        if self._offered.get(neighbour, now) <= now and self._is_shorter(neighbour, now):
            self._offered[neighbour] = now + OFFER_PERIOD_NS
            jitter = round(self._nic.uniform() * BROADCAST_JITTER_NS)
            self._nic.at(now + jitter, self._offer, neighbour)

    def on_hello(self, hello: Hello, sender: RobotId, now: int) -> None:
        """A hello was received: the route to its sender is a direct one (6.9).

        One to everyone was heard by chance perhaps, so it replaces a route over relays only if the link
        is worthwhile.
        """
        if hello.receiver == BROADCAST:
            self._last_heard[sender] = now
            route = self._table.usable(sender, now)
            if route is not None and route.hops > 1 and not self._links.is_worthwhile(sender, now):
                return
        self._table.update_neighbour(sender, now)
        self._table.update(sender, sender, 1, hello.sequence, now + ACTIVE_ROUTE_NS, now)

    def on_acknowledged(self, hello: Hello, now: int) -> None:
        """A neighbour has taken an offer."""
        self._table.update_neighbour(hello.receiver, now)

    def on_data(self, now: int) -> None:
        """Data was sent, passed on or received: this robot is part of an active route."""
        self._active_until = now + ACTIVE_ROUTE_NS

    def _is_shorter(self, neighbour: RobotId, now: int) -> bool:
        """Whether the link to a neighbour is better than the route that there is."""
        route = self._table.usable(neighbour, now)
        return route is not None and route.hops > 1 and self._links.is_worthwhile(neighbour, now)

    def _offer(self, neighbour: RobotId, now: int) -> None:
        """Offer a direct route, unless the neighbour has done so meanwhile."""
        if self._is_shorter(neighbour, now):
            self._send(neighbour, now)

    def on_broadcast(self, now: int) -> None:
        """A routing packet was broadcast, which is as good as a hello (6.9)."""
        self._last_broadcast = now

    def _on_period(self, _: None, now: int) -> None:
        self._nic.at(now + self._period, self._on_period, None)
        silent_since = now - ALLOWED_HELLO_LOSS * self._period
        for neighbour in [i for i, heard in self._last_heard.items() if heard < silent_since]:
            del self._last_heard[neighbour]
            self._on_lost(neighbour, now)
        if now < self._active_until and now - self._last_broadcast >= self._period:
            self._send(BROADCAST, now)

    def _send(self, receiver: RobotId, now: int) -> None:
        hello = Hello(receiver, self._sequence())
        self._nic.send(hello, receiver, RREP_BYTES, "hello", now)
