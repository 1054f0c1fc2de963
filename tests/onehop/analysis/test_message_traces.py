"""Messages between robots: payload and fate joined, with the receivers' inboxes as the oracle."""

from collections import Counter

from onehop.analysis import Log
from onehop.analysis.message_traces import frames
from onehop.analysis.readable import kind_of, opened
from onehop.analysis.timeline import reigns
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import DeliveryStatus
from robot_agent.core.team.team_messages import Ack, encode

from .conftest import LEADER, SUCCESSOR


def test_every_delivered_frame_is_the_message_that_its_receiver_got(log: Log) -> None:
    received: Counter[tuple[int, int, float, object]] = Counter()
    for robot in log.robots:
        for _, inbox in log.inboxes(robot):
            for one in inbox.receptions:
                received[one.source, robot, one.arrival_ns / 1e9, opened(one.payload)] += 1
    delivered = Counter(
        (frame.source, frame.receiver, frame.arrival_s, frame.message)
        for frame in frames(log)
        if frame.delivered
    )
    assert delivered == received
    assert delivered.total() > 100


def test_frames_of_a_stretch_are_the_same_as_in_the_whole(log: Log) -> None:
    part = frames(log, 5.0, 6.0)
    whole = [frame for frame in frames(log) if 5.0 - 1e-9 <= frame.settled_s <= 6.0 + 1e-9]
    assert [(f.source, f.number, f.message) for f in part] == [
        (f.source, f.number, f.message) for f in whole
    ]


def test_messages_to_a_killed_robot_are_lost_for_want_of_a_receiver(log: Log) -> None:
    late = [frame for frame in frames(log, 4.2) if frame.receiver == LEADER]
    assert all(frame.status == DeliveryStatus.RECEIVER_GONE for frame in late)


def test_kinds_have_the_names_of_the_thesis() -> None:
    assert kind_of(Ack(1, 2, True, Pose(0.0, 0.0, 0.0))) == "Ack"
    assert kind_of(opened(encode(Ack(1, 2, True, Pose(0.0, 0.0, 0.0))))) == "Ack"
    assert kind_of(opened(b"garbage")) == "garbled"


def test_reigns_from_the_tables_are_those_of_the_referee(log: Log) -> None:
    assert log.summary is not None
    found = [
        {**entry, "at_s": round(entry["at_s"], 6)}
        for entry in (
            {
                "at_s": reign.at_s + log.period_ns / 1e9,
                "leader": reign.leader,
                "epoch": reign.epoch,
                "members": list(reign.members),
                "shape": reign.shape,
            }
            for reign in reigns(log.table("status"))
        )
    ]
    expected = [{**entry, "at_s": round(entry["at_s"], 6)} for entry in log.summary["leaders"]]
    assert found == expected
    assert {entry["leader"] for entry in found} == {LEADER, SUCCESSOR}
