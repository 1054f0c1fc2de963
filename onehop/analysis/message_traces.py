"""The trace of every message between robots: who sent what to whom, and what became of it.

The radio's verdicts hold no payloads and the transmit requests no delivery status; a message's number
(the how-many-th of its source, as radio_proxy counts) joins the two.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from onehop.analysis.log import Log
from onehop.analysis.payloads import decode_payload, kind_of
from onehop.analysis.tables import Table
from onehop.contracts.messages import BROADCAST
from robot_agent.core.team.team_messages import TeamMessage


@dataclass(frozen=True, slots=True)
class MessageTrace:
    """One message to one receiver. Times in s of the mission; arrival_s is nan when it was lost.

    settled_s: end of the tick in which its delivery status was known. kind: kind_of(message), "unknown"
    when the log does not hold it. path: source to last holder. attempts: over all hops.
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
    return list(join(verdicts, log.table("transmit_requests", end_s=end_s), log.period_ns))


def join(verdicts: Table, requests: Table, period_ns: int) -> Iterator[MessageTrace]:
    """verdicts: of any stretch; requests: from the start of the mission, since they are counted."""
    outboxes = _Outboxes(requests)
    columns = (
        "source", "message", "destination", "receiver", "offered_s", "arrival_s", "time_s", "status",
        "path", "attempts", "snr_db", "bit_error_rate", "msdu_bytes",
    )  # fmt: skip
    for (
        source, number, destination, receiver, offered_s, arrival_s, settled_s, status,
        path, attempts, snr_db, bit_error_rate, msdu_bytes,
    ) in verdicts.rows(*columns):  # fmt: skip
        tick = round(offered_s * 1e9 / period_ns) + 1
        payload = outboxes.payload(source, number, tick, destination)
        message = None if payload is None else decode_payload(payload)
        yield MessageTrace(
            source=source,
            receiver=receiver,
            number=number,
            broadcast=destination == BROADCAST,
            kind="unknown" if payload is None else kind_of(message),
            message=message,
            offered_s=offered_s,
            arrival_s=arrival_s,
            settled_s=settled_s,
            status=status,
            path=path,
            attempts=attempts,
            snr_db=snr_db,
            bit_error_rate=bit_error_rate,
            msdu_bytes=msdu_bytes,
        )


class _Outboxes:
    """Payloads by source and number.

    Behind ticks that are missing in the log the count is wrong. A payload is found there by the tick in
    which it was handed to the radio and by its destination, if it is the only one.
    """

    def __init__(self, requests: Table) -> None:
        self._counted: dict[int, list[tuple[int, int, bytes]]] = {}
        self._sent: dict[tuple[int, int, int], list[bytes]] = {}
        for robot, *sent in requests.rows("robot", "tick", "destination", "payload"):
            tick, destination, payload = sent
            self._counted.setdefault(robot, []).append((tick, destination, payload))
            self._sent.setdefault((robot, tick, destination), []).append(payload)

    def payload(self, source: int, number: int, tick: int, destination: int) -> bytes | None:
        counted = self._counted.get(source, [])
        if 0 < number <= len(counted) and counted[number - 1][:2] == (tick, destination):
            return counted[number - 1][2]
        sent = self._sent.get((source, tick, destination), [])
        return sent[0] if len(sent) == 1 else None
