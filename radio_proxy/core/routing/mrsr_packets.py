"""Control packets of DSR and what its headers add to data (RFC 4728, section 6; 20 B of IP)."""

from dataclasses import dataclass

from radio_proxy.core.addresses import RobotId

IP_BYTES = 20
"""IP header, which carries DSR [B]."""

FIXED_BYTES = 4
"""Fixed portion of the DSR options header (6.1) [B]."""

RERR_OPTION_BYTES = 16
"""ROUTE ERROR option with one unreachable robot (6.4) [B]."""


def source_route_bytes(route: tuple[RobotId, ...]) -> int:
    """What a source route adds to a message: the fixed header and the route, 4 B a robot [B].

    Differs: RFC 4728 6.7 lists the robots between source and destination, here both ends are listed too,
    because ns-3 3.44, which the times of the tests were measured with, does so.
    """
    return FIXED_BYTES + 4 + 4 * len(route)


@dataclass(frozen=True, slots=True)
class Rreq:
    """ROUTE REQUEST. route: origin and everyone who passed it on. normal: without MRSR's probability."""

    number: int
    target: RobotId
    route: tuple[RobotId, ...]
    ttl: int
    normal: bool

    @property
    def origin(self) -> RobotId:
        return self.route[0]

    @property
    def size_bytes(self) -> int:
        return IP_BYTES + FIXED_BYTES + 8 + 4 * (len(self.route) - 1)


@dataclass(frozen=True, slots=True)
class Rrep:
    """ROUTE REPLY: `found` leads from origin to target, `back` from the replier to the origin.

    number: of the request that it replies to, 0 if nobody asked (3.4.3).
    """

    number: int
    found: tuple[RobotId, ...]
    back: tuple[RobotId, ...]

    @property
    def size_bytes(self) -> int:
        return IP_BYTES + source_route_bytes(self.back) + 3 + 4 * (len(self.found) - 1)


@dataclass(frozen=True, slots=True)
class Rerr:
    """ROUTE ERROR: the link a-b is broken; `back` leads from its detector to the source of the data."""

    a: RobotId
    b: RobotId
    back: tuple[RobotId, ...]

    @property
    def size_bytes(self) -> int:
        return IP_BYTES + source_route_bytes(self.back) + RERR_OPTION_BYTES


def after(route: tuple[RobotId, ...], robot: RobotId) -> RobotId:
    """Who comes after a robot on a route that lists it and does not end there."""
    return route[route.index(robot) + 1]


def without_loops(path: tuple[RobotId, ...]) -> tuple[RobotId, ...]:
    """The same path with every detour that comes back to a robot cut out."""
    straight: list[RobotId] = []
    for robot in path:
        if robot in straight:
            del straight[straight.index(robot) + 1 :]
        else:
            straight.append(robot)
    return tuple(straight)
