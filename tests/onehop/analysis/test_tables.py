"""Columns from the messages of the wire, as they are declared."""

import math

from onehop.analysis.tables import build
from onehop.contracts.messages import (
    BROADCAST,
    DeliveryStatus,
    RadioRecord,
    Transmission,
    TransmitRequest,
    Truth,
    Verdict,
)
from onehop.wire.codec import encode
from onehop.wire.selection import Selected

PERIOD_NS = 50_000_000


def verdict(message: int, status: DeliveryStatus, arrival_ns: int) -> Verdict:
    return Verdict(
        message=message, source=1, destination=2, receiver=2, status=status, msdu_bytes=800,
        path=(1, 3, 2), attempts=(2, 1), offered_ns=50_000_000, service_start_ns=51_000_000,
        arrival_ns=arrival_ns, discovery_ns=0, queueing_ns=250_000, snr_db=36.5, bit_error_rate=0.0,
    )  # fmt: skip


def test_verdicts_have_times_in_seconds_and_no_arrival_when_lost() -> None:
    record = RadioRecord(
        2, 2 * PERIOD_NS,
        (
            verdict(1, DeliveryStatus.DELIVERED, 75_000_000),
            verdict(2, DeliveryStatus.BELOW_THRESHOLD, -1),
        ),
        {"rreq": 40, "rerr": 20},
    )  # fmt: skip
    message = Selected(2, "radio", encode(record))
    tables = build(("verdicts", "control"), [message], PERIOD_NS)
    verdicts, control = tables["verdicts"], tables["control"]
    assert verdicts["time_s"].tolist() == [0.1, 0.1]
    assert verdicts["status"].tolist() == ["delivered", "below threshold"]
    assert verdicts["offered_s"].tolist() == [0.05, 0.05]
    assert verdicts["arrival_s"][0] == 0.075
    assert math.isnan(verdicts["arrival_s"][1])
    assert verdicts["attempts"].tolist() == [3, 3]
    assert verdicts["path"].tolist() == [(1, 3, 2)] * 2
    assert control["kind"].tolist() == ["rerr", "rreq"]
    assert control["bytes"].tolist() == [20, 40]


def test_every_message_of_an_outbox_is_a_transmit_request_of_its_robot() -> None:
    outbox = Transmission(BROADCAST, b"a", 60, 0), Transmission(4, b"bc", 800, 0)
    requests = (TransmitRequest(3, 0.5, 9.0, outbox), TransmitRequest(4, 0.5, 9.0, ()))
    truth = Truth(7, 7 * PERIOD_NS, (), requests, (), (), (), ())
    table = build(("transmit_requests",), [Selected(7, "truth", encode(truth))], PERIOD_NS)
    found = table["transmit_requests"]
    assert found["robot"].tolist() == [3, 3]
    assert found["destination"].tolist() == [0, 4]
    assert found["msdu_bytes"].tolist() == [60, 800]
    assert found["payload"].tolist() == [b"a", b"bc"]
