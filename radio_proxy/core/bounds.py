"""The two radios between which every real one lies: a perfect link, and none at all.

What communication is worth to a team is what lies between them. *Perfect*: each message reaches each
receiver in one hop, without loss or waiting, after the airtime of one exchange and nothing more, however
far it is; others on the air do not matter. *None*: nothing ever arrives; robots then are teams of one
(`robot_briefing`). Cuts part a perfect link, jams do not weaken it.
"""

from collections.abc import Iterable
from typing import Protocol

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.messages import (
    Carriage,
    Cut,
    DeliveryStatus,
    Reception,
    Transmission,
    TransmitRequest,
    Truth,
)
from onehop.contracts.randomness import generator
from radio_proxy.core.addresses import BROADCAST, RobotId
from radio_proxy.core.airtime import dsss
from radio_proxy.core.corruption import Corrupter
from radio_proxy.core.data_message import DataMessage, DataPacket
from radio_proxy.core.deliveries import Deliveries
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.radio import Radio

PERFECT_SNR_DB = 100.0
"""SNR of every frame on a perfect link [dB]."""


class Carrier(Protocol):
    """A radio: what reaches whom, tick by tick, or step by step (see Radio)."""

    def carry(self, truth: Truth) -> Carriage:
        """What reaches whom in the tick that ends at truth.time_ns, and what became of the rest."""
        ...

    def place(self, truth: Truth, now: int) -> None:
        """Let a truth hold from now on [ns]."""

    def hand_over(self, requests: Iterable[TransmitRequest], now: int) -> None:
        """Take over what present robots hand to their NICs at this instant [ns]."""

    def next_event(self) -> int:
        """When something happens next on the air, or a timer expires [ns]."""
        ...

    def follow(self, until: int) -> list[tuple[int, Reception]]:
        """What happens up to an instant that was not known before [ns]; who has received what in it."""
        ...

    def account(self, truth: Truth) -> Carriage:
        """What became of messages since the last account; inboxes hold what cards heard of others."""
        ...


def make_radio(briefing: RadioBriefing) -> Carrier:
    """The radio of a scenario."""
    return Radio(briefing) if briefing.radio.link == "modelled" else Bound(briefing)


class Bound:
    """A perfect link between all robots, or no link at all."""

    def __init__(self, briefing: RadioBriefing) -> None:
        section = briefing.radio
        self._period = briefing.period_ns
        self._perfect = section.link == "perfect"
        self._timing = dsss(section)
        self._rts_threshold_bytes = section.rts_threshold_bytes
        self._numbers = dict.fromkeys((RobotId(robot) for robot in sorted(briefing.robots)), 0)
        self._corrupter = Corrupter(generator(briefing.seed, "faults"))
        self._deliveries = Deliveries(self._corrupter)
        self._incarnations: dict[RobotId, int] = {}
        self._under_way: list[tuple[int, DataPacket, RobotId]] = []
        self._cuts: tuple[Cut, ...] = ()

    def carry(self, truth: Truth) -> Carriage:
        """What reaches whom in the tick that ends at truth.time_ns, and what became of the rest."""
        start = truth.time_ns - self._period
        self.place(truth, start)
        self.hand_over(truth.transmit_requests, start)
        self._arrive(truth.time_ns)
        return self.account(truth)

    def place(self, truth: Truth, now: int) -> None:  # noqa: ARG002 - wherever robots are
        """Let a truth hold from now on."""
        self._update_present(truth)
        self._corrupter.in_force = truth.corruptions
        self._deliveries.stopped = truth.stopped
        self._cuts = truth.cuts

    def hand_over(self, requests: Iterable[TransmitRequest], now: int) -> None:
        """Take over what present robots hand to their NICs at this instant [ns]."""
        for request in requests:
            for transmission in request.outbox:
                self._submit(RobotId(request.robot), transmission, now)

    def next_event(self) -> int:
        """When the next message arrives [ns]."""
        return min((arrival for arrival, _, _ in self._under_way), default=NEVER)

    def follow(self, until: int) -> list[tuple[int, Reception]]:
        """What arrives up to an instant, one after the other [ns]."""
        while (arrival := self.next_event()) <= until:
            self._arrive(arrival)
        return self._deliveries.take_receptions()

    def account(self, truth: Truth) -> Carriage:
        """What became of messages since the last account."""
        return self._deliveries.carriage(truth, {})

    def _arrive(self, until: int) -> None:
        arriving = [one for one in self._under_way if one[0] <= until]
        self._under_way = [one for one in self._under_way if one[0] > until]
        for arrival, data, receiver in arriving:
            moved = data.moved(receiver, 1)
            self._deliveries.record(moved, receiver, DeliveryStatus.DELIVERED, arrival)

    def _update_present(self, truth: Truth) -> None:
        """What is under way to or from a robot that left, or came back as another process, is lost."""
        present = {RobotId(one.robot): one.incarnation for one in truth.present}
        if present == self._incarnations:
            return
        left = [i for i, number in self._incarnations.items() if present.get(i) != number]
        self._incarnations = present
        self._deliveries.present = tuple(sorted(present))
        for robot in left:
            self._deliveries.forget(robot)
        kept = []
        for arrival, data, receiver in self._under_way:
            if receiver in left or data.message.source in left:
                gone = receiver in left
                why = DeliveryStatus.RECEIVER_GONE if gone else DeliveryStatus.SENDER_GONE
                self._deliveries.record(data.tried(1), receiver, why, -1)
            else:
                kept.append((arrival, data, receiver))
        self._under_way = kept

    def _submit(self, robot: RobotId, transmission: Transmission, now: int) -> None:
        """A robot hands a message to its NIC."""
        self._numbers[robot] += 1
        destination, payload = RobotId(transmission.destination), transmission.payload
        size = max(transmission.msdu_bytes, len(payload))
        message = DataMessage(self._numbers[robot], robot, destination, payload, size, now)
        data = DataPacket(message, (robot,))
        message.begin_service(now)
        if destination == robot:
            self._deliveries.record(data, robot, DeliveryStatus.NO_ROUTE, -1)
            return
        receivers: tuple[RobotId, ...] = (destination,)
        if destination == BROADCAST:
            receivers = tuple(i for i in self._deliveries.present if i != robot)
        for receiver in receivers:
            why = self._loss(robot, receiver)
            if why is not None:
                self._deliveries.record(data.tried(1), receiver, why, -1)
                continue
            message.sinr_db, message.bit_error_rate = PERFECT_SNR_DB, 0.0
            arrival = now + self._airtime(size, destination == BROADCAST)
            self._under_way.append((arrival, data, receiver))

    def _loss(self, robot: RobotId, receiver: RobotId) -> DeliveryStatus | None:
        """Why a message cannot arrive."""
        if receiver not in self._incarnations:
            return DeliveryStatus.RECEIVER_GONE
        if self._perfect and not any(one.parts(robot, receiver) for one in self._cuts):
            return None
        return DeliveryStatus.BELOW_THRESHOLD

    def _airtime(self, msdu_bytes: int, to_everyone: bool) -> int:
        """From the first frame of an exchange to the last bit of its data, without waiting [ns]."""
        timing = self._timing
        if to_everyone:
            return timing.broadcast(msdu_bytes)
        rts_cts = msdu_bytes > self._rts_threshold_bytes
        before = timing.rts + timing.cts + 2 * timing.sifs if rts_cts else 0
        return before + timing.data(msdu_bytes)
