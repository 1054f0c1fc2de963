"""Control packets of AODV with their sizes (RFC 3561, section 5; 28 B of IP and UDP)."""

from dataclasses import dataclass

from radio_proxy.core.addresses import RobotId

IP_UDP_BYTES = 28
"""Headers of IP (20 B) and UDP (8 B), which carry AODV [B]."""

RREQ_BYTES = 24 + IP_UDP_BYTES
RREP_BYTES = 20 + IP_UDP_BYTES
"""Sizes of ROUTE REQUEST and ROUTE REPLY (RFC 3561, 5.1 and 5.2) [B]."""


def rerr_bytes(destinations: int) -> int:
    """Size of a ROUTE ERROR that names so many destinations [B]."""
    return 4 + 8 * destinations + IP_UDP_BYTES


@dataclass(frozen=True, slots=True)
class Rreq:
    """ROUTE REQUEST. sequence: last known of the destination, None for unknown.

    normal: pass on without MRDV's probability. destination_only: nobody may reply from its table.
    """

    origin: RobotId
    origin_sequence: int
    number: int
    destination: RobotId
    sequence: int | None
    hops: int
    ttl: int
    normal: bool
    destination_only: bool


@dataclass(frozen=True, slots=True)
class Rrep:
    """ROUTE REPLY on its way to `origin`: its sender is `hops` from destination; lifetime [ns]."""

    origin: RobotId
    destination: RobotId
    sequence: int
    hops: int
    lifetime: int


@dataclass(frozen=True, slots=True)
class Hello:
    """A ROUTE REPLY of a neighbour for the route to itself (6.9): to one receiver or BROADCAST."""

    receiver: RobotId
    sequence: int


@dataclass(frozen=True, slots=True)
class Rerr:
    """ROUTE ERROR: (destination, sequence) of everything that its sender cannot reach any more."""

    lost: tuple[tuple[RobotId, int], ...]
