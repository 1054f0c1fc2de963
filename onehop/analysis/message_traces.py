"""The trace of every message between robots: who sent what to whom, and what became of it.

The radio's verdicts hold no payloads and the transmit requests no delivery status; a message's number
(the how-many-th of its source, as radio_proxy counts) joins the two.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from onehop.analysis.log import Log
from onehop.analysis.payloads import decode_payload, kind_of
from onehop.analysis.tables import Table
from robot_agent.core.team.team_messages import TeamMessage


@dataclass(frozen=True, slots=True)
class MessageTrace:
    """One message to one receiver. Times in s of the mission; arrival_s is nan when it was lost.

    settled_s: end of the tick in which its delivery status was known. kind: kind_of(message). path:
    source to last holder. attempts: over all hops.
    """

    source: int
    receiver: int
    number: int
    broadcast: bool
    kind: str
    message: TeamMessage | None
    offered_s: float
    arrival_s: float
    settled_s: float
    status: str
    path: tuple[int, ...]
    attempts: int
    snr_db: float
    bit_error_rate: float
    msdu_bytes: int

    @property
    def delivered(self) -> bool:
        return self.status == "delivered"


def traces(log: Log, start_s: float = 0.0, end_s: float | None = None) -> list[MessageTrace]:
    """Messages that were settled within a time, in the order in which the radio settled them."""
    verdicts = log.table("verdicts", start_s=start_s, end_s=end_s)
    return list(join(verdicts, log.table("transmit_requests", end_s=end_s)))


def join(verdicts: Table, requests: Table) -> Iterator[MessageTrace]:
    """verdicts: of any stretch; requests: from the start of the mission, since they are counted."""
    payloads: dict[tuple[int, int], bytes] = {}
    counts: dict[int, int] = {}
    for robot, payload in zip(requests["robot"].tolist(), requests["payload"], strict=True):
        counts[robot] = counts.get(robot, 0) + 1
        payloads[robot, counts[robot]] = payload
    for row in range(len(verdicts)):
        source, number = int(verdicts["source"][row]), int(verdicts["message"][row])
        message = decode_payload(payloads.get((source, number), b""))
        yield MessageTrace(
            source=source,
            receiver=int(verdicts["receiver"][row]),
            number=number,
            broadcast=int(verdicts["destination"][row]) == 0,
            kind=kind_of(message),
            message=message,
            offered_s=float(verdicts["offered_s"][row]),
            arrival_s=float(verdicts["arrival_s"][row]),
            settled_s=float(verdicts["time_s"][row]),
            status=str(verdicts["status"][row]),
            path=verdicts["path"][row],
            attempts=int(verdicts["attempts"][row]),
            snr_db=float(verdicts["snr_db"][row]),
            bit_error_rate=float(verdicts["bit_error_rate"][row]),
            msdu_bytes=int(verdicts["msdu_bytes"][row]),
        )
