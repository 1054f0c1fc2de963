"""What the card of a robot says of who is around: frames for it and for others, each with its SNR."""

import dataclasses
import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.messages import BROADCAST, Inbox, Jam
from onehop.contracts.neighbour import Neighbour
from onehop.contracts.radio_section import RadioSection
from onehop.wire.codec import decode, encode
from radio_proxy.core.link_budget import link_budget
from tests.radio.missions import PERIOD, Mission, line, message

CLEAR = RadioSection(neighbours=True, shadowing_db=0.0, routing="direct", receive_threshold_db=20.0)


def heard(mission: Mission, robot: int) -> dict[int, Neighbour]:
    return {one.robot: one for one in mission.inboxes[robot].neighbours}


def test_a_frame_for_another_robot_is_heard_by_everyone_in_range() -> None:
    mission = Mission(line(4, 10.0), CLEAR)
    mission.step({1: (message(2),)})
    budget = link_budget(CLEAR)
    for robot, distance in ((2, 10.0), (3, 20.0), (4, 30.0)):
        one = heard(mission, robot)[1]
        assert one.snr_db == pytest.approx(budget.mean_snr_db(distance))
        assert one.rssi_dbm == pytest.approx(one.snr_db + budget.noise_dbm)
        assert one.frames == 1
        assert 0 < one.time_ns <= PERIOD
    assert heard(mission, 1) == {}
    assert [len(mission.inboxes[robot].receptions) for robot in (2, 3, 4)] == [1, 0, 0]


def test_a_broadcast_tells_everyone_and_the_last_of_several_frames_counts() -> None:
    mission = Mission(line(3, 10.0), CLEAR)
    mission.step({1: (message(BROADCAST, 100), message(BROADCAST, 100))})
    one = heard(mission, 3)[1]
    assert one.frames == 2
    assert one.time_ns == max(each.arrival_ns for each in mission.inboxes[3].receptions)
    mission.step()
    assert mission.inboxes[3].neighbours == ()


def test_who_is_out_of_reach_is_not_heard_and_a_jam_takes_snr_and_no_power() -> None:
    mission = Mission({1: (0.0, 0.0), 2: (10.0, 0.0), 3: (0.0, 10.0), 4: (5000.0, 0.0)}, CLEAR)
    mission.step({1: (message(2),)})
    quiet = heard(mission, 3)[1]
    assert heard(mission, 4) == {}
    mission.jams = (Jam(0.0, 10.0, 1.0, -70.0),)
    mission.step({1: (message(2),)})
    jammed = heard(mission, 3)[1]
    assert jammed.rssi_dbm == pytest.approx(quiet.rssi_dbm)
    assert jammed.snr_db < quiet.snr_db - 5.0


def test_who_is_stopped_hears_of_it_when_it_goes_on() -> None:
    mission = Mission(line(3, 10.0), CLEAR)
    mission.stopped = (3,)
    mission.step({1: (message(2),)})
    mission.stopped = ()
    mission.step()
    assert heard(mission, 3)[1].frames == 1


def test_a_new_process_has_heard_nothing() -> None:
    mission = Mission(line(3, 10.0), CLEAR)
    mission.stopped = (3,)
    mission.step({1: (message(2),)})
    mission.stopped = ()
    mission.incarnations[3] = 1
    mission.step()
    assert mission.inboxes[3].neighbours == ()


@pytest.mark.parametrize("section", [RadioSection(), RadioSection(preset="indoor", routing="mrsr")])
def test_listening_changes_nothing_of_what_happens_on_the_air(section: RadioSection) -> None:
    """Of 40 ticks in which all talk, with fading: verdicts and receptions are the same."""
    both = [
        Mission(line(5, 9.0), dataclasses.replace(section, neighbours=listens))
        for listens in (False, True)
    ]
    for tick in range(40):
        talk = {i: (message(1 + (i + tick) % 5, 200), message(BROADCAST, 60)) for i in range(1, 6)}
        for mission in both:
            mission.step(talk)
        deaf, listening = (mission.inboxes for mission in both)
        assert {i: one.receptions for i, one in deaf.items()} == {
            i: one.receptions for i, one in listening.items()
        }
        assert all(one.neighbours == () for one in deaf.values())
    assert both[0].verdicts == both[1].verdicts


def test_overheard_frames_fade_as_much_as_those_that_are_received() -> None:
    section = dataclasses.replace(CLEAR, shadowing_db=4.0, receive_threshold_db=0.0)
    mission = Mission({1: (0.0, 0.0), 2: (0.0, 2.0), 3: (20.0, 0.0)}, section)
    levels = []
    for _ in range(400):
        mission.step({1: (message(2, 50),)})
        levels += [one.snr_db for one in mission.inboxes[3].neighbours]
    assert len(levels) > 390
    assert statistics.mean(levels) == pytest.approx(link_budget(section).mean_snr_db(20.0), abs=0.7)
    assert statistics.stdev(levels) == pytest.approx(4.0, abs=0.5)


db = st.floats(-300.0, 300.0)
neighbour = st.builds(
    Neighbour, st.integers(1, 2**31 - 1), db, db, st.integers(0, 2**62), st.integers(1, 10_000)
)


@given(st.lists(neighbour, max_size=5))
def test_an_inbox_survives_the_wire_and_without_neighbours_says_nothing_of_them(
    ones: list[Neighbour],
) -> None:
    inbox = Inbox(7, 350_000_000, (), tuple(ones))
    data = encode(inbox)
    assert decode(Inbox, data) == inbox
    assert (b"neighbours" in data) == bool(ones)
