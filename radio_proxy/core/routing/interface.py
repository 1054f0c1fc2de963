"""What a routing protocol is given, and what it must do. Robots by id, times in ns."""

from collections.abc import Callable
from typing import Any, Protocol

from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.data_message import DataPacket


class NicServices(Protocol):
    """What the card of one robot lets its routing protocol do."""

    robot: int
    incarnation: int

    def send(self, packet: object, next_hop: int, size_bytes: int, kind: str, now: int) -> bool:
        """Queue a packet for one hop (BROADCAST for all); False when the queue is full.

        kind: what the bytes are counted as ("rreq", ...), "" for data.
        """
        ...

    def deliver(self, data: DataPacket, now: int) -> None:
        """Hand a message to its robot; a second copy is dropped here."""
        ...

    def drop(self, data: DataPacket, status: DeliveryStatus) -> None:
        """Give one copy of a message up."""
        ...

    def at(self, time_ns: int, event: Callable[[Any, int], None], argument: Any) -> None:
        """Call event(argument, time_ns) then, unless the robot has left by that time."""
        ...

    def uniform(self) -> float:
        """A random number in [0, 1)."""
        ...

    def speed(self) -> float:
        """The robot's own speed [m/s]."""
        ...

    def remaining_distance(self) -> float:
        """The robot's own distance to go [m]."""
        ...


class Router(Protocol):
    """A routing protocol on one robot."""

    def submit(self, data: DataPacket, now: int) -> None:
        """The robot itself has a message for another."""
        ...

    def abandon(self) -> list[DataPacket]:
        """The robot leaves: the messages that still wait for a route."""
        ...

    def on_packet(self, packet: object, sender: int, now: int) -> None:
        """A packet arrived from a neighbour; a DataPacket already lists this robot in its path."""
        ...

    def on_overheard(self, packet: object, sender: int, now: int) -> None:
        """A control packet for another robot was heard; `sender` is the neighbour that sent it."""
        ...

    def on_broadcast_sent(self, packet: object, now: int) -> None:
        """A broadcast of this robot has left its card."""
        ...

    def on_acknowledged(self, packet: object, next_hop: int, now: int) -> None:
        """The link layer's acknowledgement of a unicast packet came."""
        ...

    def on_undeliverable(self, packet: object, next_hop: int, cause: DeliveryStatus, now: int) -> None:
        """The link layer gave a unicast packet up."""
        ...
