"""No routing: every message goes to its destination in one hop or not at all."""

from onehop.contracts.messages import DeliveryStatus
from radio_proxy.core.addresses import RobotId
from radio_proxy.core.data_message import DataPacket
from radio_proxy.core.routing.interface import NicServices


class DirectRouter:
    """One hop, no tables, no control packets."""

    def __init__(self, nic: NicServices) -> None:
        self._nic = nic

    def submit(self, data: DataPacket, now: int) -> None:
        message = data.message
        if not self._nic.send(data, message.destination, message.msdu_bytes, "", now):
            self._nic.drop(data, DeliveryStatus.QUEUE_FULL)

    def abandon(self) -> list[DataPacket]:
        return []

    def on_packet(self, packet: object, sender: RobotId, now: int) -> None:  # noqa: ARG002
        assert isinstance(packet, DataPacket)
        self._nic.deliver(packet, now)

    def on_heard(self, neighbour: RobotId, margin_db: float, now: int) -> None:
        """How well others are heard says nothing that this protocol uses."""

    def on_overheard(self, packet: object, sender: RobotId, now: int) -> None:
        """Others' control packets say nothing that this protocol uses."""

    def on_broadcast_sent(self, packet: object, now: int) -> None:
        """Nothing waits for a reply."""

    def on_acknowledged(self, packet: object, next_hop: RobotId, now: int) -> None:
        """Nothing is kept that could be refreshed."""

    def on_undeliverable(
        self,
        packet: object,
        next_hop: RobotId,  # noqa: ARG002
        cause: DeliveryStatus,
        now: int,  # noqa: ARG002
    ) -> None:
        assert isinstance(packet, DataPacket)
        self._nic.drop(packet, cause)
