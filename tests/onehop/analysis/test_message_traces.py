"""Traces of messages: payload and delivery status joined; the receivers' inboxes are the oracle."""

from collections import Counter

from onehop.analysis import Log
from onehop.analysis.message_traces import traces
from onehop.analysis.payloads import decode_payload, kind_of
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import DeliveryStatus
from robot_agent.core.team.team_messages import Ack, encode

from .conftest import LEADER


def test_every_delivered_trace_is_the_message_that_its_receiver_got(log: Log) -> None:
    received: Counter[tuple[int, int, float, object]] = Counter()
    for robot in log.robots:
        for _, inbox in log.inboxes(robot):
            for one in inbox.receptions:
                received[one.source, robot, one.arrival_ns / 1e9, decode_payload(one.payload)] += 1
    delivered = Counter(
        (trace.source, trace.receiver, trace.arrival_s, trace.message)
        for trace in traces(log)
        if trace.delivered
    )
    assert delivered == received
    assert delivered.total() > 100


def test_traces_of_a_stretch_are_the_same_as_in_the_whole(log: Log) -> None:
    part = traces(log, 5.0, 6.0)
    whole = [trace for trace in traces(log) if 5.0 - 1e-9 <= trace.settled_s <= 6.0 + 1e-9]
    assert [(f.source, f.number, f.message) for f in part] == [
        (f.source, f.number, f.message) for f in whole
    ]


def test_messages_to_a_killed_robot_are_lost_for_want_of_a_receiver(log: Log) -> None:
    late = [trace for trace in traces(log, 4.2) if trace.receiver == LEADER]
    assert all(trace.status == DeliveryStatus.RECEIVER_GONE for trace in late)


def test_kinds_have_the_names_of_the_thesis() -> None:
    assert kind_of(Ack(1, 2, True, Pose(0.0, 0.0, 0.0))) == "Ack"
    assert kind_of(decode_payload(encode(Ack(1, 2, True, Pose(0.0, 0.0, 0.0))))) == "Ack"
    assert kind_of(decode_payload(b"garbage")) == "other"
