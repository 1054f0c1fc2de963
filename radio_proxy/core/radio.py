"""The radio of a mission: `Radio.carry(truth)` moves every message through one tick.

Its steps can be taken one by one, where truths and messages come at any instant (continuous.py). Here a
tick meets the network: who is present, and what each robot hands to its NIC. How a message finds its way
is in routing/, what becomes of it in deliveries.py, a hop in link_layer.py and dcf.py.
"""

from collections.abc import Iterable

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.messages import (
    Carriage,
    DeliveryStatus,
    Reception,
    Transmission,
    TransmitRequest,
    Truth,
)
from onehop.contracts.plugin_names import PROPAGATION, ROUTING
from onehop.contracts.randomness import generator
from onehop.contracts.units import nanoseconds
from radio_proxy.core import path_loss
from radio_proxy.core.addresses import BROADCAST, RobotId
from radio_proxy.core.corruption import Corrupter
from radio_proxy.core.data_message import DataMessage, DataPacket
from radio_proxy.core.deliveries import Deliveries
from radio_proxy.core.draws import Draws
from radio_proxy.core.eavesdropper import Eavesdropper
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.fast_fading import fast_fading
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_layer import LinkLayer
from radio_proxy.core.link_rules import link_rules
from radio_proxy.core.measured_links import MeasuredLinks
from radio_proxy.core.nic import Nic
from radio_proxy.core.path_loss import HeldToRange, ModelMaker, PropagationModel
from radio_proxy.core.propagation import Propagation
from radio_proxy.core.routing import built_in as routing
from radio_proxy.core.routing.built_in import RouterMaker
from radio_proxy.core.routing.interface import Router


class Radio:
    """Everything between the outboxes of one tick and the inboxes of the next."""

    def __init__(self, briefing: RadioBriefing) -> None:
        section = briefing.radio
        robots = tuple(RobotId(robot) for robot in sorted(briefing.robots))
        self._period = briefing.period_ns
        self._section = section
        self._draws = Draws(generator(briefing.seed, "radio"))
        self._propagation = make_propagation(briefing)
        self._make_router: RouterMaker = briefing.plugin(ROUTING) or routing.BUILT_IN[section.routing]
        self._corrupter = Corrupter(generator(briefing.seed, "faults"))
        self._eavesdropper = _eavesdropper(briefing, robots, self._propagation)
        self._deliveries = Deliveries(self._corrupter, self._eavesdropper)
        self._link = LinkLayer(
            robots, section, self._propagation, self._draws, self._deliveries, self._eavesdropper
        )
        self._events = self._link.events
        self._nics: dict[RobotId, tuple[Nic, Router]] = {}
        self._incarnations: tuple[tuple[int, int], ...] = ()
        self._requests: dict[int, TransmitRequest] = {}
        self._numbers = dict.fromkeys(robots, 0)
        self._default_lifetime = nanoseconds(section.message_lifetime_s)

    def carry(self, truth: Truth) -> Carriage:
        """What reaches whom in the tick that ends at truth.time_ns, and what became of the rest."""
        start = truth.time_ns - self._period
        self.place(truth, start)
        self.hand_over(truth.transmit_requests, start)
        self._events.run(truth.time_ns)
        return self._deliveries.carriage(truth, self._link.control_bytes)

    def place(self, truth: Truth, now: int) -> None:
        """Let a truth hold from now on [ns]; robots reach their places in it a period later."""
        self._update_nics(truth, now)
        self._propagation.update(truth.present, truth.cuts, truth.jams, (now, now + self._period))
        self._link.on_placed(now)
        self._corrupter.in_force = truth.corruptions
        self._deliveries.stopped = truth.stopped
        self._requests = {request.robot: request for request in truth.transmit_requests}

    def hand_over(self, requests: Iterable[TransmitRequest], now: int) -> None:
        """Take over what present robots hand to their NICs [ns]: all that do so at this instant."""
        talking = []
        for request in requests:
            self._requests[request.robot] = request
            if request.outbox:
                talking.append(request)
        if talking:
            self._submit_all(talking, now)

    def next_event(self) -> int:
        """When something happens next on the air, or a timer expires [ns]."""
        return self._events.next()

    def follow(self, until: int) -> list[tuple[int, Reception]]:
        """What happens up to an instant that was not known before [ns]; who has received what in it."""
        self._events.follow(until)
        return self._deliveries.take_receptions()

    def account(self, truth: Truth) -> Carriage:
        """What became of messages since the last account; inboxes hold what cards heard of others."""
        return self._deliveries.carriage(truth, self._link.control_bytes)

    def _update_nics(self, truth: Truth, now: int) -> None:
        """NICs of robots that left (or came back as another process) go down; new ones start empty."""
        incarnations = tuple([(p.robot, p.incarnation) for p in truth.present])
        if incarnations == self._incarnations:
            return
        before, after = dict(self._incarnations), dict(incarnations)
        self._incarnations = incarnations
        left = [RobotId(robot) for robot in sorted(before) if after.get(robot) != before[robot]]
        down = [self._nics.pop(robot) for robot in left]
        self._deliveries.present = tuple(sorted(self._nics))
        for nic, router in down:
            nic.shut_down()
            for data in router.abandon():
                self._deliveries.drop_with_holder(data, nic.robot)
        for robot in left:
            self._deliveries.forget(robot)
            for data in self._link.detach(robot):
                self._deliveries.drop_with_holder(data, robot)
        for presence in truth.present:
            if before.get(presence.robot) != presence.incarnation:
                self._start_nic(RobotId(presence.robot), presence.incarnation, now)
        self._deliveries.present = tuple(sorted(self._nics))

    def _start_nic(self, robot: RobotId, incarnation: int, now: int) -> None:
        shared = self._link, self._deliveries, self._events, self._draws
        nic = Nic(robot, incarnation, *shared, self._request_of)
        router = self._make_router(nic, self._section, now)
        self._nics[robot] = nic, router
        self._link.attach(robot, router)

    def _request_of(self, robot: RobotId) -> TransmitRequest:
        """The robot's last word about its speed and distance; at rest when it has said nothing yet."""
        return self._requests.get(robot) or TransmitRequest(robot, 0.0, 0.0, ())

    def _submit_all(self, requests: list[TransmitRequest], now: int) -> None:
        """Take over what the robots send in this tick; of several, each frame draws a backoff."""
        self._link.force_backoff = len(requests) > 1
        for request in requests:
            robot = RobotId(request.robot)
            for transmission in request.outbox:
                self._submit(robot, transmission, now)
        self._link.force_backoff = False

    def _submit(self, robot: RobotId, transmission: Transmission, now: int) -> None:
        """A robot hands a message to its NIC."""
        self._numbers[robot] += 1
        destination = RobotId(transmission.destination)
        size = max(transmission.msdu_bytes, len(transmission.payload))
        lifetime = transmission.lifetime_ns or self._default_lifetime
        expires = now + lifetime if lifetime else NEVER
        number, payload = self._numbers[robot], transmission.payload
        message = DataMessage(number, robot, destination, payload, size, now, expires)
        data = DataPacket(message, (robot,))
        if destination == BROADCAST:
            if not self._link.send(robot, data, BROADCAST, size, "", now):
                self._deliveries.drop(data, DeliveryStatus.QUEUE_FULL)
        elif destination == robot:
            self._deliveries.drop(data, DeliveryStatus.NO_ROUTE)
        elif destination not in self._numbers:
            self._deliveries.drop(data, DeliveryStatus.RECEIVER_GONE)
        else:
            self._nics[robot][1].submit(data, now)


def _eavesdropper(
    briefing: RadioBriefing, robots: tuple[RobotId, ...], propagation: Propagation
) -> Eavesdropper | None:
    """What listens for the cards of a mission, if they tell whom they hear."""
    if not briefing.radio.neighbours:
        return None
    draws = Draws(generator(briefing.seed, "radio/neighbours"))
    return Eavesdropper(robots, propagation, link_rules(briefing.radio), draws)


def make_propagation(briefing: RadioBriefing) -> Propagation:
    """At which SNR the robots of a mission receive each other."""
    section = briefing.radio
    budget = link_budget(section)
    return Propagation(
        budget,
        tuple(RobotId(robot) for robot in sorted(briefing.robots)),
        briefing.walls,
        fast_fading=fast_fading(section, briefing.seed),
        measured=None if briefing.links is None else MeasuredLinks(briefing.links, section, budget),
        model=_model(briefing),
    )


def _model(briefing: RadioBriefing) -> PropagationModel:
    """The propagation that a scenario names: built in, or handed in."""
    own: ModelMaker | None = briefing.plugin(PROPAGATION)
    if own is not None:
        return HeldToRange(own(briefing))
    return path_loss.BUILT_IN[briefing.radio.propagation](briefing)
