"""What becomes of each data message: its verdict, and the reception if it arrived.

An acknowledgement that is lost leaves a copy of a message with two robots. A message is delivered with
the first copy that arrives, and lost when its last copy is given up.
"""

from onehop.contracts.messages import (
    Carriage,
    DeliveryStatus,
    Inbox,
    RadioRecord,
    Reception,
    Truth,
    Verdict,
    running,
)
from radio_proxy.core.addresses import BROADCAST, RobotId
from radio_proxy.core.corruption import Corrupter
from radio_proxy.core.data_message import DataMessage, DataPacket
from radio_proxy.core.eavesdropper import Eavesdropper

BUFFER_BYTES = 212_992
"""What waits at most for a robot that is stopped [B]: Linux's net.core.rmem_default."""


class Deliveries:
    """Verdicts and receptions since the last tick. present: robots whose NICs are up, sorted.

    stopped: those of them that read nothing: what they receive waits until they go on.
    """

    def __init__(self, corrupter: Corrupter, eavesdropper: Eavesdropper | None = None) -> None:
        self._corrupter = corrupter
        self._eavesdropper = eavesdropper
        self.present: tuple[RobotId, ...] = ()
        self.stopped: tuple[int, ...] = ()
        self._verdicts: list[Verdict] = []
        self._receptions: list[tuple[int, int, int, RobotId, Reception]] = []
        self._control_bytes: dict[str, int] = {}

    def carriage(self, truth: Truth, control_bytes: dict[str, int]) -> Carriage:
        """What the radio says at the end of a tick; control_bytes: what routing has cost so far [B]."""
        tick, time_ns = truth.tick, truth.time_ns
        inboxes = {presence.robot: Inbox(tick, time_ns, ()) for presence in running(truth)}
        if self._receptions:
            self._receptions.sort(key=lambda reception: reception[:4])
            received: dict[RobotId, list[Reception]] = {}
            for _, _, _, robot, reception in self._receptions:
                received.setdefault(robot, []).append(reception)
            self._receptions = [one for one in self._receptions if one[3] in self.stopped]
            for robot in sorted(received):
                if robot not in self.stopped:
                    inboxes[robot] = Inbox(tick, time_ns, tuple(received[robot]))
        if self._eavesdropper is not None:
            inboxes = {
                robot: Inbox(tick, time_ns, inbox.receptions, self._eavesdropper.heard(robot))
                for robot, inbox in inboxes.items()
            }
        verdicts = tuple(self._verdicts)
        self._verdicts = []
        if control_bytes != self._control_bytes:
            self._control_bytes = dict(sorted(control_bytes.items()))
        return Carriage(inboxes, RadioRecord(tick, time_ns, verdicts, self._control_bytes))

    def take_receptions(self) -> list[tuple[int, Reception]]:
        """Receivers that read, and what they have received since the last time, in order of arrival."""
        if not self._receptions:
            return []
        self._receptions.sort(key=lambda reception: reception[:4])
        taken: list[tuple[int, Reception]] = [
            (one[3], one[4]) for one in self._receptions if one[3] not in self.stopped
        ]
        self._receptions = [one for one in self._receptions if one[3] in self.stopped]
        return taken

    def forget(self, robot: RobotId) -> None:
        """A robot has left, or is another process: what waits for it is lost."""
        self._receptions = [one for one in self._receptions if one[3] != robot]
        if self._eavesdropper is not None:
            self._eavesdropper.forget(robot)

    def deliver(self, data: DataPacket, now: int) -> None:
        """A copy reached its destination; a second one is dropped."""
        message = data.message
        if not message.has_verdict:
            message.has_verdict = True
            self.record(data, message.destination, DeliveryStatus.DELIVERED, now)
        self.release_copy(message)

    def drop(self, data: DataPacket, status: DeliveryStatus) -> None:
        """A copy is given up. Of several copies the one that came farthest says why it was lost."""
        loss = data.message.loss
        if loss is None or len(data.path) >= len(loss[0].path):
            data.message.loss = (data, status)
        self.release_copy(data.message)

    def drop_with_holder(self, data: DataPacket, holder: RobotId) -> None:
        """A copy is lost because the robot that held it left the mission."""
        at_source = holder == data.message.source
        self.drop(data, DeliveryStatus.SENDER_GONE if at_source else DeliveryStatus.RELAY_GONE)

    def release_copy(self, message: DataMessage) -> None:
        """A robot holds the message no more; if it was the last one, the message is lost."""
        message.copies -= 1
        if message.has_verdict or message.copies > 0:
            return
        message.has_verdict = True
        assert message.loss is not None
        data, status = message.loss
        if message.destination == BROADCAST:
            for robot in self.present:
                if robot != message.source:
                    self.record(data, robot, status, -1)
            return
        if status is not DeliveryStatus.SENDER_GONE and message.destination not in self.present:
            status = DeliveryStatus.RECEIVER_GONE
        self.record(data, message.destination, status, -1)

    def record(self, data: DataPacket, receiver: RobotId, status: DeliveryStatus, arrival: int) -> None:
        """The verdict on a message and one receiver; arrival: -1 when it was lost [ns]."""
        message, payload = data.message, data.message.payload
        if status is DeliveryStatus.DELIVERED and (self._corrupter.in_force or self.stopped):
            payload = self._corrupter.received(receiver, payload)
            if payload != message.payload:
                status = DeliveryStatus.CORRUPTED
            if receiver in self.stopped and not self._has_room(receiver, message.msdu_bytes):
                status, arrival = DeliveryStatus.QUEUE_FULL, -1
        verdict = message.verdict(data, receiver, status, arrival)
        self._verdicts.append(verdict)
        if status is DeliveryStatus.DELIVERED or status is DeliveryStatus.CORRUPTED:
            reception = Reception(
                source=message.source,
                payload=payload,
                service_start_ns=verdict.service_start_ns,
                arrival_ns=arrival,
                hops=len(data.path) - 1,
                attempts=sum(data.attempts),
                snr_db=message.sinr_db,
                bit_error_rate=message.bit_error_rate,
                msdu_bytes=message.msdu_bytes,
            )
            self._receptions.append((arrival, message.source, message.number, receiver, reception))

    def _has_room(self, robot: RobotId, msdu_bytes: int) -> bool:
        waiting = sum(one[4].msdu_bytes for one in self._receptions if one[3] == robot)
        return waiting + msdu_bytes <= BUFFER_BYTES
