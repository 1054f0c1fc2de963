"""A data message on its way from robot to robot, and what is on record about it until its verdict."""

from dataclasses import dataclass

from msgspec import Struct
from msgspec.structs import replace

from onehop.contracts.messages import DeliveryStatus, Verdict
from radio_proxy.core.addresses import RobotId
from radio_proxy.core.event_queue import NEVER
from radio_proxy.core.path_loss import SILENT_DB

MAX_DISCOVERIES = 2
"""Route discoveries that the source makes for one message: at first, and once more when a hop failed."""


@dataclass(slots=True, eq=False)
class DataMessage:
    """One message of one robot. Times in ns, -1 until they are known.

    offered: when its source handed it over. copies: how many robots hold it (an ACK that is lost leaves
    two). loss: of the copies that were given up, the one that came farthest, and why.
    first_service: when its source's link layer took it up. discovering_since: start of the route
    discovery that it waits for; discoveries: how many there were; discovery_time: spent in them.
    expires: when it is of no use any more, NEVER if it always is.
    sinr_db, bit_error_rate: of the last attempt of its last hop.
    """

    number: int
    source: RobotId
    destination: RobotId
    payload: bytes
    msdu_bytes: int
    offered: int
    expires: int = NEVER
    copies: int = 1
    has_verdict: bool = False
    loss: "tuple[DataPacket, DeliveryStatus] | None" = None
    first_service: int = -1
    discovery_time: int = 0
    discovery_time_before_service: int = 0
    discovering_since: int = -1
    discoveries: int = 0
    sinr_db: float = SILENT_DB
    bit_error_rate: float = 0.5

    @property
    def service_start(self) -> int:
        """When the source's link layer began to serve it, its discovery included [ns].

        The wait behind other messages lies between discovery and service; it is taken out by moving the
        start, so that arrival - service_start is discovery and service alone: a follower measures its
        throughput by it.
        """
        return -1 if self.first_service < 0 else self.first_service - self.discovery_time_before_service

    def begin_service(self, now: int) -> None:
        """The link layer of its source takes it up for the first time."""
        self.first_service = now
        self.discovery_time_before_service = self.discovery_time

    def begin_discovery(self, now: int) -> None:
        """Its source has no route for it and looks for one."""
        if self.discovering_since < 0:
            self.discovering_since = now
            self.discoveries += 1

    def end_discovery(self, now: int) -> None:
        """A route was found, or given up."""
        if self.discovering_since >= 0:
            self.discovery_time += now - self.discovering_since
            self.discovering_since = -1

    def verdict(
        self, data: "DataPacket", receiver: RobotId, status: DeliveryStatus, arrival: int
    ) -> Verdict:
        """Its record as the log keeps it; arrival is -1 when it was lost."""
        start = self.service_start
        waited = 0 if start < 0 else start - self.offered
        return Verdict(
            message=self.number,
            source=self.source,
            destination=self.destination,
            receiver=receiver,
            status=status,
            msdu_bytes=self.msdu_bytes,
            path=data.path,
            attempts=data.attempts,
            offered_ns=self.offered,
            service_start_ns=start,
            arrival_ns=arrival,
            discovery_ns=self.discovery_time,
            queueing_ns=waited,
            snr_db=self.sinr_db,
            bit_error_rate=self.bit_error_rate,
        )


class DataPacket(Struct, frozen=True, eq=False):
    """A copy of a message that one robot holds. path, attempts: how it came there.

    route, salvaged: the source route that it carries and how often it was salvaged (MRSR).
    given_up: attempts of each time that the link to its next hop gave it up.
    """

    message: DataMessage
    path: tuple[RobotId, ...]
    attempts: tuple[int, ...] = ()
    route: tuple[RobotId, ...] = ()
    salvaged: int = 0
    given_up: tuple[int, ...] = ()

    def named_beyond(self, next_hop: RobotId) -> tuple[RobotId, ...]:
        """Whom it names of those that it comes to after its next hop.

        All of them with a source route, and without one the destination alone.
        """
        if next_hop == self.message.destination:
            return ()
        if not self.route:
            return (self.message.destination,)
        return self.route[self.route.index(next_hop) + 1 :]

    def tried(self, attempts: int) -> "DataPacket":
        """The same copy after that many more attempts at the next hop."""
        if self.given_up:
            attempts += sum(self.given_up)
        tried = (*self.attempts, attempts)
        return DataPacket(self.message, self.path, tried, self.route, self.salvaged, self.given_up)

    def again(self) -> "DataPacket":
        """A copy that its link gave up, as it is handed to the same link once more."""
        given_up = (*self.given_up, self.attempts[-1] - sum(self.given_up))
        return replace(self, attempts=self.attempts[:-1], given_up=given_up)

    def afresh(self) -> "DataPacket":
        """A copy that its link gave up, as if nothing had been tried from here."""
        return replace(self, attempts=self.attempts[:-1], given_up=())

    def salvage(self) -> "DataPacket":
        """A copy that its link gave up, as its holder looks for another route of its own (MRSR)."""
        return replace(self.afresh(), salvaged=self.salvaged + 1)

    def along(self, route: tuple[RobotId, ...]) -> "DataPacket":
        """The same copy with this source route."""
        return replace(self, route=route)

    def moved(self, holder: RobotId, attempts: int) -> "DataPacket":
        """The copy that the next robot holds, after that many more attempts."""
        if self.given_up:
            attempts += sum(self.given_up)
        path, tried = (*self.path, holder), (*self.attempts, attempts)
        return DataPacket(self.message, path, tried, self.route, self.salvaged)
