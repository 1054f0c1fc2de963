"""The routing table of AODV: one entry a destination, its sequence number, its precursors."""

from dataclasses import dataclass, field

from onehop.contracts.serial_numbers import following, newer
from radio_proxy.core.addresses import RobotId

MS = 1_000_000
"""Nanoseconds in a millisecond."""

ACTIVE_ROUTE_NS = 3000 * MS
"""ACTIVE_ROUTE_TIMEOUT: lifetime of a route without use (RFC 3561, section 10) [ns]."""

DELETE_PERIOD_NS = 15_000 * MS
"""DELETE_PERIOD: how long an invalid entry keeps its sequence number (5 * ACTIVE_ROUTE_TIMEOUT) [ns]."""


@dataclass(slots=True, eq=False)
class Route:
    """Route to one destination. expires: when it becomes invalid, or, invalid, when it is deleted [ns].

    sequence_known: the RFC's "valid sequence number" flag.
    """

    destination: RobotId
    next_hop: RobotId
    hops: int
    sequence: int
    sequence_known: bool
    expires: int
    valid: bool = True
    precursors: list[RobotId] = field(default_factory=list)

    def add_precursor(self, robot: RobotId) -> None:
        """Remember a neighbour that may send through here (RFC 3561, 6.2)."""
        if robot not in self.precursors:
            self.precursors.append(robot)


class RouteTable:
    """All routes of one robot; never more than one a destination."""

    def __init__(self) -> None:
        self._routes: dict[RobotId, Route] = {}

    def entry(self, destination: RobotId, now: int) -> Route | None:
        """The entry of a destination, valid or invalid, until DELETE_PERIOD is over."""
        route = self._routes.get(destination)
        if route is None:
            return None
        if route.valid and route.expires <= now:
            self._invalidate(route, route.sequence, route.expires)
        if not route.valid and route.expires <= now:
            del self._routes[destination]
            return None
        return route

    def usable(self, destination: RobotId, now: int) -> Route | None:
        """The valid route to a destination."""
        route = self.entry(destination, now)
        return route if route is not None and route.valid else None

    def update(
        self, destination: RobotId, next_hop: RobotId, hops: int, sequence: int, expires: int, now: int
    ) -> bool:
        """Take over a route with a sequence number if it is better (RFC 3561, 6.2 and 6.7).

        Better is: newer, or as new while ours is invalid or longer, or ours has no number. A valid route
        that is confirmed keeps its longer lifetime. Returns whether the table now leads that way.
        """
        route = self.entry(destination, now)
        if route is None:
            self._routes[destination] = Route(destination, next_hop, hops, sequence, True, expires)
            return True
        as_new = sequence == route.sequence
        if as_new and route.valid and (next_hop, hops) == (route.next_hop, route.hops):
            route.expires = max(route.expires, expires)
            route.sequence_known = True
            return True
        better = newer(sequence, route.sequence) or (as_new and (not route.valid or hops < route.hops))
        if route.sequence_known and not better:
            return False
        route.expires = max(route.expires, expires) if route.valid else expires
        route.next_hop, route.hops = next_hop, hops
        route.sequence, route.sequence_known = sequence, True
        route.valid = True
        return True

    def update_neighbour(self, neighbour: RobotId, now: int) -> None:
        """A packet came from a neighbour: there is a route of one hop to it (RFC 3561, 6.2).

        Differs: a sequence number that was known stays in force, because forgetting it would let an
        older route in, which may lead back here.
        """
        route = self.entry(neighbour, now)
        expires = now + ACTIVE_ROUTE_NS
        if route is None:
            self._routes[neighbour] = Route(neighbour, neighbour, 1, 0, False, expires)
            return
        route.expires = max(route.expires, expires) if route.valid else expires
        route.next_hop, route.hops, route.valid = neighbour, 1, True

    def refresh(self, destination: RobotId, now: int) -> None:
        """A route that carries data stays alive (RFC 3561, 6.2)."""
        route = self.usable(destination, now)
        if route is not None:
            route.expires = max(route.expires, now + ACTIVE_ROUTE_NS)

    def break_link(self, neighbour: RobotId, now: int) -> list[Route]:
        """The neighbour is out of reach: every route through it is invalid, one number newer (6.11)."""
        broken = self._through(neighbour, now)
        for route in broken:
            self._invalidate(
                route, following(route.sequence) if route.sequence_known else route.sequence, now
            )
        return broken

    def apply_rerr(
        self, neighbour: RobotId, lost: tuple[tuple[RobotId, int], ...], now: int
    ) -> list[Route]:
        """A neighbour lost (destination, sequence): routes to these through it become invalid (6.11)."""
        numbers = dict(lost)
        broken = [route for route in self._through(neighbour, now) if route.destination in numbers]
        for route in broken:
            self._invalidate(route, numbers[route.destination], now)
        return broken

    def destinations(self) -> tuple[RobotId, ...]:
        """Everything that has an entry, sorted."""
        return tuple(sorted(self._routes))

    def _through(self, neighbour: RobotId, now: int) -> list[Route]:
        found = (self.usable(destination, now) for destination in self.destinations())
        return [route for route in found if route is not None and route.next_hop == neighbour]

    def _invalidate(self, route: Route, sequence: int, now: int) -> None:
        route.valid = False
        route.sequence = sequence
        route.expires = now + DELETE_PERIOD_NS
