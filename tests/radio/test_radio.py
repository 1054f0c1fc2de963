"""What a robot may rely on when it hands messages to the radio."""

import pytest

from onehop.contracts.messages import BROADCAST, Cut, DeliveryStatus
from onehop.contracts.radio_section import RadioSection
from tests.radio.missions import PERIOD, Mission, line, message

STILL = RadioSection(routing="direct", shadowing_db=0.0, mac_header_bytes=28)
"""One hop, no fading, and the header of the measured references."""


def test_idle_exchange_takes_what_ns3_measured() -> None:
    """ns-3 3.44, one hop without backoff, 28 B header: 7.542 ms."""
    (verdict,) = Mission(line(2, 5.0), STILL).run(1, {1: (message(2),)})
    assert verdict.status is DeliveryStatus.DELIVERED
    assert verdict.arrival_ns - verdict.service_start_ns == pytest.approx(7_542_000, abs=100)


def test_waiting_behind_other_messages_is_not_service() -> None:
    """Five Nexts queued together each measure their own service, not the queue."""
    team = line(6, 2.0)
    outbox = tuple(message(i) for i in (2, 3, 4, 5, 6))
    verdicts = Mission(team, STILL).run(2, {1: outbox})
    assert [v.receiver for v in verdicts] == [2, 3, 4, 5, 6]
    assert all(v.arrival_ns - v.service_start_ns <= 7_542_100 + 31 * 20_000 for v in verdicts)
    assert verdicts[-1].queueing_ns > 4 * 7_542_000


def test_a_message_that_outlasts_the_tick_arrives_in_the_next_one() -> None:
    mission = Mission(line(2, 5.0), STILL)
    assert len(mission.step({1: tuple(message(2) for _ in range(8))})) == 6
    first = mission.inboxes[2].receptions
    assert all(r.arrival_ns <= PERIOD for r in first)
    assert len(mission.step()) == 2
    assert all(PERIOD < r.arrival_ns <= 2 * PERIOD for r in mission.inboxes[2].receptions)


def test_a_broadcast_has_one_verdict_for_each_robot_present() -> None:
    verdicts = Mission({1: (0, 0), 2: (5, 0), 3: (90, 0)}, STILL).run(1, {1: (message(BROADCAST, 40),)})
    assert [(v.receiver, v.status) for v in verdicts] == [
        (2, DeliveryStatus.DELIVERED),
        (3, DeliveryStatus.BELOW_THRESHOLD),
    ]


def test_of_broadcasts_of_hidden_robots_one_is_lost_for_good() -> None:
    """802.11-1999, 9.2.7: no RTS, no ACK, no repetition. 2 hears 1 and 3, who do not hear each other."""
    mission = Mission(line(3, 5.0), STILL)
    mission.cuts = (Cut((1,), (3,)),)
    beacon = (message(BROADCAST, 100),)
    verdicts = mission.run(4, {1: beacon, 3: beacon})
    assert sorted((v.status, v.attempts) for v in verdicts if v.receiver == 2) == [
        (DeliveryStatus.DELIVERED, (1,)),
        (DeliveryStatus.RECEIVER_BUSY, (1,)),
    ]


def test_broadcasts_of_robots_that_hear_each_other_take_turns() -> None:
    """9.2.5: handed over in the same instant, both draw a backoff, and seldom the same one."""
    mission = Mission(line(3, 5.0), STILL)
    beacon = (message(BROADCAST, 100),)
    rounds = [mission.run(2, {1: beacon, 3: beacon}) for _ in range(100)]
    collided = sum(v.status is DeliveryStatus.COLLISION for r in rounds for v in r if v.receiver == 2)
    assert 0 < collided < 20


def test_a_message_to_oneself_or_to_a_stranger_ends_at_once() -> None:
    verdicts = Mission(line(2, 5.0), STILL).run(1, {1: (message(1), message(77))})
    assert [v.status for v in verdicts] == [DeliveryStatus.NO_ROUTE, DeliveryStatus.RECEIVER_GONE]


def test_out_of_range_ends_below_the_threshold_after_all_retries() -> None:
    (verdict,) = Mission(line(2, 40.0), STILL).run(4, {1: (message(2),)})
    assert (verdict.status, verdict.attempts) == (DeliveryStatus.BELOW_THRESHOLD, (7,))


def test_queue_of_a_robot_that_left_ends_in_sender_gone() -> None:
    mission = Mission(line(3, 5.0), STILL)
    mission.step({1: tuple(message(2) for _ in range(9))})
    del mission.places[1]
    assert {v.status for v in mission.step()} == {DeliveryStatus.SENDER_GONE}


def test_frames_to_a_robot_that_left_end_in_receiver_gone() -> None:
    mission = Mission(line(3, 5.0), STILL)
    del mission.places[2]
    (verdict,) = mission.run(3, {1: (message(2),)})
    assert verdict.status is DeliveryStatus.RECEIVER_GONE


def test_a_restarted_robot_starts_with_an_empty_queue() -> None:
    mission = Mission(line(2, 5.0), STILL)
    mission.step({1: tuple(message(2) for _ in range(9))})
    mission.incarnations[1] = 1
    settled = mission.run(4)
    assert [v.status for v in settled] == [DeliveryStatus.SENDER_GONE] * 3


def test_a_full_queue_drops_the_newest() -> None:
    mission = Mission(line(2, 5.0), RadioSection(routing="direct", queue_frames=4))
    verdicts = mission.step({1: tuple(message(2) for _ in range(6))})
    full = [v.message for v in verdicts if v.status is DeliveryStatus.QUEUE_FULL]
    assert full == [5, 6]


def test_robots_that_speak_in_the_same_tick_do_not_always_collide() -> None:
    """Ticks put hand-overs into one instant; the DCF spreads them by a backoff."""
    attempts = [
        sum(v.attempts)
        for seed in range(20)
        for v in Mission(line(4, 3.0), STILL, seed).run(2, {1: (message(2),), 3: (message(4),)})
    ]
    assert len(attempts) == 40
    assert attempts.count(1) >= 32


def test_a_fault_at_a_tick_holds_for_every_frame_that_begins_after_it() -> None:
    """An exchange that is under way when its link is cut gets no further frame through."""
    data_ns = 6_816_000
    for seed in range(60):
        mission = Mission(line(2, 5.0), STILL, seed)
        mission.step({1: tuple(message(2) for _ in range(8))})
        mission.cuts = (Cut((1,), (2,)),)
        for verdict in mission.run(12):
            assert (
                verdict.status is not DeliveryStatus.DELIVERED
                or verdict.arrival_ns - data_ns <= PERIOD + 100
            )


def test_what_a_relay_drops_before_it_acknowledges_has_a_verdict() -> None:
    mission = Mission(line(3, 20.0), RadioSection(routing="mrdv", shadowing_db=0.0))
    mission.run(20, {1: (message(3),)})
    mission.incarnations[2] = 1
    (verdict,) = mission.run(3, {1: (message(3),)})
    assert (verdict.status, verdict.path) == (DeliveryStatus.NO_ROUTE, (1, 2))


def test_discovery_is_service_and_waiting_is_not() -> None:
    """Discovery, retries and relays count, the wait behind other messages does not."""
    mission = Mission(line(3, 20.0), RadioSection(routing="mrdv", shadowing_db=0.0))
    verdicts = mission.run(40, {1: (message(3), message(3), message(3))})
    for verdict in verdicts:
        service = verdict.arrival_ns - verdict.service_start_ns
        assert verdict.discovery_ns > 200_000_000
        assert verdict.discovery_ns + 15_000_000 < service < verdict.discovery_ns + 45_000_000
        assert verdict.queueing_ns == verdict.service_start_ns - verdict.offered_ns
    assert verdicts[2].queueing_ns > verdicts[0].queueing_ns + 14_000_000


@pytest.mark.parametrize("routing", ["direct", "mrdv", "mrsr"])
def test_a_message_that_arrives_twice_is_delivered_once(routing: str) -> None:
    """At 20 m an acknowledgement in three is lost, and messages are sent again."""
    section = RadioSection(routing=routing)  # type: ignore[arg-type]
    mission = Mission({1: (0.0, 0.0), 2: (20.0, 0.0), 3: (10.0, 8.0)}, section)
    for _ in range(200):
        mission.run(2, {1: (message(2),)})
    mission.run(1000)
    numbers = [verdict.message for verdict in mission.verdicts]
    assert sorted(numbers) == list(range(1, 201))
