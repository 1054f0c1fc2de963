"""The same runs on Onehop. Frames: its link layer with static routes; messages: `Radio`, in ticks."""

from typing import Any

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import (
    Cut,
    DeliveryStatus,
    Presence,
    Transmission,
    TransmitRequest,
    Truth,
)
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.randomness import generator
from radio_proxy.core.addresses import RobotId
from radio_proxy.core.corruption import Corrupter
from radio_proxy.core.data_message import DataMessage, DataPacket
from radio_proxy.core.deliveries import Deliveries
from radio_proxy.core.draws import Draws
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_layer import LinkLayer
from radio_proxy.core.propagation import Propagation
from radio_proxy.core.radio import Radio

from .cases import TICK_S, Run

SECOND_NS = 1_000_000_000
TICK_NS = round(TICK_S * SECOND_NS)
ROUTING = {"aodv": "mrdv", "aodv with hellos": "mrdv", "dsr": "mrsr", "": "direct"}


def section(run: Run) -> RadioSection:
    """The radio of a run: 28 B header, and the standard read as ns-3 reads it."""
    return RadioSection(
        mac_header_bytes=28,
        rate_mbps=run.rate_mbps,
        rts_threshold_bytes=run.rts_threshold_bytes,
        shadowing_db=run.fading_db,
        receive_threshold_db=run.receive_threshold_db,
        carrier_sense_db=run.carrier_sense_db,
        energy_detect_db=run.carrier_sense_db,
        preamble_sinr_db=run.preamble_sinr_db,
        routing=ROUTING[run.protocol],
        as_ns3=True,
    )


def presences(run: Run) -> tuple[Presence, ...]:
    """Robot i + 1 stands where station i is."""
    still = Twist(0.0, 0.0)
    return tuple(Presence(i, 0, Pose(x, y, 0.0), still, False) for i, (x, y) in enumerate(run.places, 1))


def cuts(run: Run, now_s: float = 0.0) -> tuple[Cut, ...]:
    """Pairs without a path, and stations that have left by now."""
    apart = tuple(Cut((a + 1,), (b + 1,)) for a, b in run.silent)
    everyone = range(len(run.places))
    left = tuple(
        Cut((gone + 1,), tuple(i + 1 for i in everyone if i != gone))
        for gone, at_s in run.leaves
        if at_s <= now_s
    )
    return apart + left


class Flows:
    """Saturated flows over static routes on the link layer that carries the missions' messages."""

    def __init__(self, run: Run) -> None:
        robots = tuple(RobotId(i) for i in range(1, len(run.places) + 1))
        radio = section(run)
        propagation = Propagation(link_budget(radio), robots, ())
        propagation.update(presences(run), cuts(run), ())
        draws = Draws(generator(run.seed, "radio"))
        deliveries = Deliveries(Corrupter(generator(run.seed, "faults")))
        self.link = LinkLayer(robots, radio, propagation, draws, deliveries)
        self.received = [0] * len(robots)
        self.delays_ms: list[list[float]] = [[] for _ in run.paths]
        self._size = run.msdu_bytes
        for robot in robots:
            self.link.attach(robot, _StaticRouter(robot, self))
        self._paths = [tuple(RobotId(i + 1) for i in path) for path in run.paths]
        for flow in range(len(run.paths)):
            self.offer(flow, 0)

    def offer(self, flow: int, now: int) -> None:
        """The source of a flow gets its next message."""
        path = self._paths[flow]
        message = DataMessage(flow, path[0], path[-1], b"", self._size, now)
        self.link.force_backoff = True
        self.forward(DataPacket(message, (path[0],)), now)
        self.link.force_backoff = False

    def forward(self, packet: DataPacket, now: int) -> None:
        """Hand a message over to the link layer of the robot that holds it."""
        path = self._paths[packet.message.number]
        hop = len(packet.path) - 1
        self.link.send(path[hop], packet, path[hop + 1], self._size, "", now)

    def on_received(self, packet: DataPacket, now: int) -> None:
        message = packet.message
        self.received[packet.path[-2] - 1] += 1
        if len(packet.path) < len(self._paths[message.number]):
            self.forward(packet, now)
        else:
            self.delays_ms[message.number].append((now - message.first_service) / 1e6)

    def on_served(self, packet: DataPacket, now: int) -> None:
        """A link layer is done with a message, whatever became of it."""
        if len(packet.path) == 1:
            self.offer(packet.message.number, now)


class _StaticRouter:
    """A robot's part in static routes: a `Router` (radio_proxy/core/routing/interface.py)."""

    def __init__(self, robot: RobotId, flows: Flows) -> None:
        self._robot = robot
        self._flows = flows

    def submit(self, data: DataPacket, now: int) -> None:
        self._flows.forward(data, now)

    def abandon(self) -> list[DataPacket]:
        return []

    def on_packet(self, packet: object, sender: RobotId, now: int) -> None:  # noqa: ARG002
        assert isinstance(packet, DataPacket)
        self._flows.on_received(packet, now)

    def on_heard(self, neighbour: RobotId, margin_db: float, now: int) -> None:
        """Routes do not change."""

    def on_overheard(self, packet: object, sender: RobotId, now: int) -> None:
        """Routes do not change."""

    def on_broadcast_sent(self, packet: object, now: int) -> None:
        """Nobody broadcasts."""

    def on_acknowledged(self, packet: object, next_hop: RobotId, now: int) -> None:  # noqa: ARG002
        assert isinstance(packet, DataPacket)
        self._flows.on_served(packet, now)

    def on_undeliverable(
        self,
        packet: object,
        next_hop: RobotId,  # noqa: ARG002
        cause: DeliveryStatus,  # noqa: ARG002
        now: int,
    ) -> None:
        assert isinstance(packet, DataPacket)
        self._flows.on_served(packet, now)


def flows(run: Run) -> dict[str, Any]:
    """What ns3_worker.flows says, from Onehop."""
    simulated = Flows(run)
    simulated.link.events.run(round(run.seconds * SECOND_NS))
    return {"received": simulated.received, "delays_ms": simulated.delays_ms}


def messages(run: Run) -> dict[str, Any]:
    """What ns3_worker.messages says, from Onehop. Robots stand still, so each forwards with p_r = 1."""
    robots = tuple(range(1, len(run.places) + 1))
    radio = Radio(RadioBriefing(run.seed, TICK_NS, robots, section(run), ()))
    offered: dict[int, list[int]] = {}
    numbers: dict[tuple[int, int], int] = {}
    sent = dict.fromkeys(robots, 0)
    for index, (at_s, source, _) in enumerate(run.messages):
        offered.setdefault(round(at_s / TICK_S), []).append(index)
        sent[source + 1] += 1
        numbers[source + 1, sent[source + 1]] = index
    arrivals_s: list[float | None] = [None] * len(run.messages)
    control: dict[str, int] = {}
    for tick in range(round(run.seconds / TICK_S)):
        outboxes: dict[int, list[Transmission]] = {}
        for index in offered.get(tick, ()):
            _, source, destination = run.messages[index]
            sending = Transmission(destination + 1, b"", run.msdu_bytes, 0)
            outboxes.setdefault(source + 1, []).append(sending)
        requests = tuple(TransmitRequest(i, 0.0, 0.0, tuple(outboxes.get(i, ()))) for i in robots)
        gone = cuts(run, tick * TICK_S)
        end = (tick + 1) * TICK_NS
        record = radio.carry(Truth(tick + 1, end, presences(run), requests, gone, (), (), ())).record
        control = record.control_bytes
        for verdict in record.verdicts:
            if verdict.status is DeliveryStatus.DELIVERED:
                arrivals_s[numbers[verdict.source, verdict.message]] = verdict.arrival_ns / SECOND_NS
    source_route = control.get("source_route", 0)
    return {
        "arrivals_s": arrivals_s,
        "routing_bytes": sum(control.values()) - source_route,
        "source_route_bytes": source_route,
    }


def simulate(run: Run) -> dict[str, Any]:
    """One run."""
    return messages(run) if run.protocol else flows(run)
