"""What a routing protocol is given, and what it must do. Times in ns."""

from typing import Any, Protocol

from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import RobotId
from radio_proxy.core.data_message import DataPacket
from radio_proxy.core.event_queue import Callback


class NicServices(Protocol):
    """What the NIC of one robot offers to its routing protocol (nic.py)."""

    robot: RobotId
    incarnation: int

    def send(self, packet: object, next_hop: RobotId, size_bytes: int, kind: str, now: int) -> bool:
        """Queue a packet for one hop (BROADCAST for all); False when the queue is full.

        kind: what the bytes are counted as ("rreq", ...), "" for data.
        """
        ...

    def deliver(self, data: DataPacket, now: int) -> None:
        """A message has reached this robot, its destination; a second copy is ignored."""
        ...

    def drop(self, data: DataPacket, status: DeliveryStatus) -> None:
        """Give up one copy of a message, and say why."""
        ...

    def at(self, time_ns: int, event: Callback, argument: Any) -> None:
        """A timer: call event(argument, time_ns) then, unless the robot has left by that time."""
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
        """This robot is the source of a message."""
        ...

    def abandon(self) -> list[DataPacket]:
        """The robot leaves: messages that still waited for a route."""
        ...

    def on_packet(self, packet: object, sender: RobotId, now: int) -> None:
        """A packet arrived from a neighbour; a DataPacket already lists this robot in its path."""
        ...

    def on_heard(self, neighbour: RobotId, margin_db: float, now: int) -> None:
        """A frame of a neighbour was received. A routing packet or data for a router comes next.

        margin_db: its SINR above the receive threshold [dB].
        """
        ...

    def on_overheard(self, packet: object, sender: RobotId, now: int) -> None:
        """A packet for another robot was overheard; `sender` is the neighbour that sent it.

        A control packet, or data on its way over that other robot to this one.
        """
        ...

    def on_broadcast_sent(self, packet: object, now: int) -> None:
        """A broadcast of this robot has been transmitted."""
        ...

    def on_acknowledged(self, packet: object, next_hop: RobotId, now: int) -> None:
        """The link layer's acknowledgement of a unicast packet came."""
        ...

    def on_undeliverable(
        self, packet: object, next_hop: RobotId, cause: DeliveryStatus, now: int
    ) -> None:
        """The link layer gave a unicast packet up."""
        ...
