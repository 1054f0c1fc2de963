"""A network for routing protocols alone: links that hold or fail, a millisecond a hop, no contention."""

import heapq
import random
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from onehop.contracts.messages import BROADCAST, DeliveryStatus
from radio_proxy.core.data_message import DataMessage, DataPacket
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.routing.interface import Router
from radio_proxy.core.routing.links import REPEATED_EXCHANGES
from radio_proxy.core.routing.mrdv import MrdvRouter
from radio_proxy.core.routing.mrsr import MrsrRouter

MS = 1_000_000
HOP_NS = MS


@dataclass(frozen=True)
class Sent:
    """A transmitted packet: when, by whom, to whom (BROADCAST for all), how large."""

    time_ns: int
    sender: int
    target: int
    packet: object
    size_bytes: int


class NetNic:
    """A robot's NIC on the test network."""

    def __init__(self, net: "Net", robot: int, incarnation: int) -> None:
        self.robot = robot
        self.incarnation = incarnation
        self.alive = True
        self._net = net
        self.router: Router

    def send(self, packet: object, next_hop: int, size_bytes: int, kind: str, now: int) -> bool:
        assert (kind == "") == isinstance(packet, DataPacket)
        self._net.put(self, packet, next_hop, size_bytes, now)
        return True

    def deliver(self, data: DataPacket, now: int) -> None:
        self._net.delivered.append((now, data))
        data.message.has_verdict = True
        self._net.release_copy(data.message)

    def drop(self, data: DataPacket, status: DeliveryStatus) -> None:
        data.message.loss = (data, status)
        self._net.release_copy(data.message)

    def at(self, time_ns: int, event: Callable[[Any, int], None], argument: Any) -> None:
        self._net.at(time_ns, lambda given, now: event(given, now) if self.alive else None, argument)

    def uniform(self) -> float:
        return self._net.dice.random()

    def speed(self) -> float:
        return self._net.speed

    def remaining_distance(self) -> float:
        return self._net.remaining


class Net:
    """Robots, the links among them, and everything that was sent. protocol: "mrdv" or "mrsr".

    hold_ns: how long a packet waits in its queue. margin_db: how far above the threshold one is heard.
    """

    def __init__(
        self,
        protocol: str,
        robots: Iterable[int],
        links: Iterable[tuple[int, int]],
        hello_period: int = 0,
    ) -> None:
        self.protocol = protocol
        self.hello_period = hello_period
        self.now = 0
        self.dice = random.Random(1)
        self.speed = 0.0
        self.remaining = 0.0
        self.loss: Callable[[int, int], bool] = lambda _sender, _receiver: False
        self.margin_db: Callable[[int, int], float] = lambda _sender, _receiver: 20.0
        self.watch: Callable[[], None] = lambda: None
        self.hold_ns = 0
        self.links = {frozenset(link) for link in links}
        self.sent: list[Sent] = []
        self.delivered: list[tuple[int, DataPacket]] = []
        self.lost: list[tuple[DataMessage, DeliveryStatus]] = []
        self._events: list[tuple[int, int, Callable[[Any, int], None], Any]] = []
        self._sequence = 0
        self.nics: dict[int, NetNic] = {}
        self.messages: list[DataMessage] = []
        for robot in robots:
            self.start(robot, 0)

    def start(self, robot: int, incarnation: int) -> None:
        """A robot's NIC comes up with empty tables."""
        nic = NetNic(self, robot, incarnation)
        if self.protocol == "mrdv":
            nic.router = MrdvRouter(nic, 10.0, self.now, self.hello_period)
        else:
            nic.router = MrsrRouter(nic, 10.0)
        self.nics[robot] = nic

    def stop(self, robot: int) -> None:
        """A robot's NIC goes down with everything in it."""
        nic = self.nics.pop(robot)
        nic.alive = False
        for data in nic.router.abandon():
            nic.drop(data, DeliveryStatus.SENDER_GONE)

    def linked(self, a: int, b: int) -> bool:
        return frozenset((a, b)) in self.links and a in self.nics and b in self.nics

    def at(self, time_ns: int, event: Callable[[Any, int], None], argument: Any) -> None:
        self._sequence += 1
        heapq.heappush(self._events, (time_ns, self._sequence, event, argument))

    def submit(self, source: int, destination: int, lifetime_ns: int = 0) -> DataMessage:
        """A robot hands over a message now. lifetime_ns: 0 for ever."""
        expires = self.now + lifetime_ns if lifetime_ns else NEVER
        message = DataMessage(len(self.messages) + 1, source, destination, b"", 800, self.now, expires)
        self.messages.append(message)
        self.nics[source].router.submit(DataPacket(message, (source,)), self.now)
        return message

    def run(self, duration_ns: int) -> None:
        """Everything that happens in the next so many nanoseconds."""
        until = self.now + duration_ns
        while self._events and self._events[0][0] <= until:
            self.now, _, event, argument = heapq.heappop(self._events)
            event(argument, self.now)
            self.watch()
        self.now = until

    def put(self, nic: NetNic, packet: object, target: int, size_bytes: int, now: int) -> None:
        self.sent.append(Sent(now, nic.robot, target, packet, size_bytes))
        self.at(now + self.hold_ns + HOP_NS, self._arrive, (nic, packet, target))

    def release_copy(self, message: DataMessage) -> None:
        """A robot holds a message no more; the last one loses it unless it was delivered."""
        message.copies -= 1
        assert message.copies >= 0
        if not message.has_verdict and message.copies == 0:
            message.has_verdict = True
            assert message.loss is not None
            self.lost.append((message, message.loss[1]))

    def of(self, kind: type) -> list[Sent]:
        """What was sent of one kind of packet."""
        return [sent for sent in self.sent if isinstance(sent.packet, kind)]

    def first_of(self, kind: type) -> list[Sent]:
        """The same without what was handed to a link again."""
        first: dict[tuple[int, int, object], Sent] = {}
        for sent in self.of(kind):
            first.setdefault((sent.sender, sent.target, sent.packet), sent)
        return list(first.values())

    def _arrive(self, given: tuple[NetNic, object, int], now: int) -> None:
        nic, packet, target = given
        if target == BROADCAST:
            if nic.alive:
                nic.router.on_broadcast_sent(packet, now)
            for robot in sorted(self.nics):
                if self.linked(nic.robot, robot) and not self.loss(nic.robot, robot):
                    self.hear(nic.robot, robot)
                    self.nics[robot].router.on_packet(packet, nic.robot, now)
            return
        reached = nic.alive and self.linked(nic.robot, target) and not self.loss(nic.robot, target)
        if reached:
            self._receive(nic, packet, target, now)
        if not nic.alive:
            if isinstance(packet, DataPacket):
                nic.drop(packet, DeliveryStatus.SENDER_GONE)
        elif reached and not self.loss(target, nic.robot):
            if isinstance(packet, DataPacket):
                self.release_copy(packet.message)
            nic.router.on_acknowledged(packet, target, now)
        else:
            failed = packet.tried(7) if isinstance(packet, DataPacket) else packet
            nic.router.on_undeliverable(failed, target, DeliveryStatus.BELOW_THRESHOLD, now)

    def hear(self, sender: int, receiver: int) -> None:
        """A frame has come from one to the other."""
        self.nics[receiver].router.on_heard(sender, self.margin_db(sender, receiver), self.now)

    def _receive(self, nic: NetNic, packet: object, target: int, now: int) -> None:
        self.hear(nic.robot, target)
        named: Iterable[int] = sorted(self.nics)
        if isinstance(packet, DataPacket):
            named = packet.named_beyond(target)
        for robot in named:
            if robot != target and self.linked(nic.robot, robot):
                self.hear(nic.robot, robot)
                self.nics[robot].router.on_overheard(packet, nic.robot, now)
        if isinstance(packet, DataPacket):
            packet.message.copies += 1
            packet = packet.moved(target, 1)
        self.nics[target].router.on_packet(packet, nic.robot, now)


def receive(net: Net, robot: int, packet: object, sender: int, now: int) -> None:
    """A packet comes from a neighbour that need not exist, over a good link."""
    net.nics[robot].router.on_heard(sender, 20.0, now)
    net.nics[robot].router.on_packet(packet, sender, now)


def lose_link(net: Net, robot: int, neighbour: int) -> None:
    """The link layer gives up what a robot sends to a neighbour, until the link counts as broken."""
    for _ in range(REPEATED_EXCHANGES + 1):
        net.nics[robot].router.on_undeliverable(None, neighbour, DeliveryStatus.BELOW_THRESHOLD, net.now)


def chain(protocol: str, robots: int, hello_period: int = 0) -> Net:
    """Robots 1..n, each linked to the next. hello_period: of MRDV's hellos [ns]."""
    links = [(i, i + 1) for i in range(1, robots)]
    return Net(protocol, range(1, robots + 1), links, hello_period)
