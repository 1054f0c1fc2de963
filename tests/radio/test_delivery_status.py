"""Each lost message says why, in one word for one reason."""

from onehop.contracts.messages import BROADCAST, Cut, DeliveryStatus, Jam
from onehop.contracts.radio_section import RadioSection
from tests.radio.missions import Mission, line, message


def section(routing: str = "direct", **changes: object) -> RadioSection:
    return RadioSection(routing=routing, shadowing_db=0.0, **changes)  # type: ignore[arg-type]


HIDDEN = (Cut((1,), (3,)),)
"""Robots 1 and 3 do not hear each other; robot 2 hears both."""


def test_of_two_broadcasts_that_overlap_a_receiver_is_busy_with_the_first() -> None:
    """802.11-1999, 9.2.7: sent once, never repeated."""
    mission = Mission(line(3, 5.0), section())
    mission.cuts = HIDDEN
    beacon = (message(BROADCAST, 100),)
    verdicts = mission.run(4, {1: beacon, 3: beacon})
    assert sorted((v.status, v.attempts) for v in verdicts if v.receiver == 2) == [
        ("delivered", (1,)),
        ("receiver busy", (1,)),
    ]


def test_two_broadcasts_that_begin_in_one_instant_are_a_collision() -> None:
    """Whichever is to be received, the other drowns its preamble."""
    mission = Mission(line(3, 5.0), section())
    mission.cuts = HIDDEN
    beacon = (message(BROADCAST, 100),)
    statuses = set()
    for _ in range(60):
        verdicts = mission.run(2, {1: beacon, 3: beacon})
        statuses.add(tuple(v.status for v in verdicts if v.receiver == 2))
    assert ("collision", "collision") in statuses


def test_unicast_frames_of_hidden_robots_find_the_receiver_busy() -> None:
    """Without RTS; the last of the attempts decides."""
    mission = Mission(line(3, 5.0), section(rts_threshold_bytes=2304, retry_limit=1))
    mission.cuts = HIDDEN
    verdicts = mission.run(4, {1: (message(2),), 3: (message(2),)})
    assert {(v.status, v.attempts) for v in verdicts} == {
        ("delivered", (1,)),
        ("receiver busy", (1,)),
    }


def test_a_frame_too_weak_even_alone_is_no_collision() -> None:
    mission = Mission({1: (0, 0), 2: (40, 0), 3: (80, 0)}, section(rts_threshold_bytes=2304))
    mission.cuts = HIDDEN
    verdicts = mission.run(8, {1: (message(2),), 3: (message(2),)})
    assert {v.status for v in verdicts} == {DeliveryStatus.BELOW_THRESHOLD}


def test_a_receiver_silenced_by_a_reservation_is_busy() -> None:
    """802.11-1999, 9.2.5.7: 3 heard the CTS of 2 for 1; 4 hears neither and asks 3 meanwhile."""
    mission = Mission(line(4, 5.0), section(retry_limit=1))
    mission.cuts = (Cut((1,), (3, 4)), Cut((2,), (4,)))
    mission.step({1: (message(2, 2304),) * 4})
    verdicts = mission.run(2, {4: (message(3),)})
    assert sorted((v.source, v.status, v.attempts) for v in verdicts)[-1] == (4, "receiver busy", (1,))


def test_a_relay_that_is_not_there_is_not_the_receiver() -> None:
    """2 holds a message for 4, and 3 between them has left."""
    mission = Mission(line(4, 20.0), section("mrdv"))
    mission.run(40, {1: (message(4),)})
    del mission.places[3]
    (verdict,) = mission.run(40, {1: (message(4),)})
    assert (verdict.status, verdict.path) == ("relay gone", (1, 2))


def test_a_relay_that_leaves_with_a_message_is_not_its_sender() -> None:
    mission = Mission(line(3, 20.0), section("mrdv"))
    mission.run(20, {1: (message(3),)})
    before = len(mission.verdicts)
    mission.step({1: (message(3),) * 8})
    del mission.places[2]
    mission.run(1000)
    statuses = {v.path: v.status for v in mission.verdicts[before:] if v.arrival_ns < 0}
    assert statuses == {(1, 2): "relay gone", (1,): DeliveryStatus.NO_ROUTE}


def test_what_the_next_hop_did_with_a_message_counts_and_not_a_lost_acknowledgement() -> None:
    """1 hears no ACK for the noise around it; 2 had the message and, restarted, no route for it."""
    mission = Mission(line(3, 20.0), section("mrdv", rts_threshold_bytes=2304))
    mission.run(20, {1: (message(3),)})
    mission.incarnations[2] = 1
    mission.jams = (Jam(0.0, 0.0, 5.0, -40.0),)
    (verdict,) = mission.run(600, {1: (message(3),)})
    assert (verdict.status, verdict.path) == (DeliveryStatus.NO_ROUTE, (1, 2))
