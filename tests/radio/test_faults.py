"""Faults of the air: links that carry one way, payloads that change, NICs of stopped processes."""

import pytest

from onehop.contracts.messages import BROADCAST, Corruption, Cut, DeliveryStatus
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.deliveries import BUFFER_BYTES
from tests.radio.missions import PERIOD, Mission, line, message

STILL = RadioSection(routing="direct", shadowing_db=0.0)
SENT = bytes(range(200))
TO_ALL = (message(BROADCAST, 200, SENT),)


@pytest.mark.parametrize("one_way", [True, False])
def test_a_one_way_cut_carries_back(one_way: bool) -> None:
    mission = Mission(line(2, 5.0), STILL)
    mission.cuts = (Cut((1,), (2,), one_way),)
    heard = [mission.run(2, {source: TO_ALL})[0].status for source in (1, 2)]
    assert heard == [
        DeliveryStatus.BELOW_THRESHOLD,
        DeliveryStatus.DELIVERED if one_way else DeliveryStatus.BELOW_THRESHOLD,
    ]


def test_a_corrupted_message_arrives_with_other_bytes_and_is_told_as_such() -> None:
    mission = Mission(line(3, 5.0), STILL)
    mission.corruptions = (Corruption((2,), 1.0),)
    verdicts = mission.run(1, {1: TO_ALL})
    assert [(v.receiver, v.status) for v in verdicts] == [
        (2, DeliveryStatus.CORRUPTED),
        (3, DeliveryStatus.DELIVERED),
    ]
    assert 0 < verdicts[0].arrival_ns <= PERIOD
    (altered,), (sound,) = (mission.inboxes[i].receptions for i in (2, 3))
    assert sound.payload == SENT
    assert len(altered.payload) == len(SENT)
    assert 1 <= sum(a != b for a, b in zip(altered.payload, SENT, strict=True)) <= 8


def test_corruption_takes_its_share_and_shifts_no_other_draw() -> None:
    """Every second broadcast of forty, and each of them at the instant at which it came without it."""
    arrivals = []
    for probability in (0.0, 0.5):
        mission = Mission(line(2, 5.0), RadioSection(routing="direct"))
        mission.corruptions = (Corruption((2,), probability),)
        for _ in range(40):
            mission.step({1: TO_ALL})
        arrivals.append([(v.arrival_ns, v.snr_db) for v in mission.verdicts])
    corrupted = sum(v.status is DeliveryStatus.CORRUPTED for v in mission.verdicts)
    assert 10 < corrupted < 30
    assert arrivals[0] == arrivals[1]


def test_what_a_stopped_robot_is_sent_waits_in_its_nic() -> None:
    mission = Mission(line(2, 5.0), STILL)
    mission.stopped = (2,)
    statuses = [v.status for v in mission.run(3, {1: (message(2), message(2))})]
    assert statuses == [DeliveryStatus.DELIVERED] * 2
    mission.stopped = ()
    mission.step()
    waited = [reception.arrival_ns for reception in mission.inboxes[2].receptions]
    assert len(waited) == 2
    assert 0 < waited[0] < waited[1] <= PERIOD
    mission.step()
    assert mission.inboxes[2].receptions == ()


def test_what_waits_for_a_process_is_lost_with_it() -> None:
    mission = Mission(line(2, 5.0), STILL)
    mission.stopped = (2,)
    mission.run(2, {1: (message(2),)})
    mission.stopped, mission.incarnations[2] = (), 1
    mission.step()
    assert mission.inboxes[2].receptions == ()


def test_a_nic_holds_no_more_for_a_stopped_robot_than_its_buffer_has_room_for() -> None:
    mission = Mission(line(2, 5.0), RadioSection(routing="direct", shadowing_db=0.0, rate_mbps=11.0))
    mission.stopped = (2,)
    fits = BUFFER_BYTES // 2304
    sent = 0
    while sent < fits + 4:
        mission.run(2, {1: (message(2, 2304),) * 8})
        sent += 8
    mission.run(4)
    statuses = [v.status for v in mission.verdicts]
    assert statuses == [DeliveryStatus.DELIVERED] * fits + [DeliveryStatus.QUEUE_FULL] * (sent - fits)
    mission.stopped = ()
    mission.step()
    assert len(mission.inboxes[2].receptions) == fits
