"""EIFS, NAV, response timers and energy detection (802.11-1999, 9.2.3.4, 9.2.5.4, 9.2.5.7, 15.4.8.4)."""

import pytest

from onehop.contracts.messages import BROADCAST, Cut, Jam
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.addresses import EVERYONE, StationIndex
from tests.radio.missions import Mission, line, message
from tests.radio.stations import Cell

Places = list[tuple[float, float]]

WEAK = {"tx_power_dbm": -25.0, "receive_threshold_db": -9.5, "carrier_sense_db": -30.0}
"""12 dB at 1 m: within 4 m all is received, at 7.5 m a long frame is locked on and full of errors."""


def waits_us(
    section: RadioSection, places: list[tuple[float, float]], cuts: tuple[Cut, ...] = ()
) -> float:
    """From the end of a long broadcast of station 0 until station 1 begins its own, modulo a slot [us].

    Station 2, if there is one, sends a longer one meanwhile.
    """
    cell = Cell(places, section, cuts)
    cell.send_at(0, 0, EVERYONE)
    if len(places) > 2:
        cell.send_at(1000, 2, EVERYONE)
    cell.send_at(3000, 1, EVERYONE, 100)
    cell.run(60_000)
    ends_us = {sender: now / 1000 for now, sender, _ in cell.arrived}
    began_us = ends_us[1] - 192 - 8 * 134
    return (began_us - ends_us[0]) % 20


def test_after_a_frame_with_errors_a_station_waits_for_eifs() -> None:
    """SIFS + ACK + DIFS, 364 us, instead of 50 us: 4 and 10 us into a slot."""
    section = RadioSection(shadowing_db=0.0, **WEAK)
    assert waits_us(section, [(0, 0), (3, 0)]) == pytest.approx(10, abs=0.1)
    assert waits_us(section, [(0, 0), (7.5, 0)]) == pytest.approx(4, abs=0.1)


def test_eifs_begins_when_the_medium_is_idle_and_in_ns3_when_the_frame_ends() -> None:
    """Station 2 is 1000 us later, hidden from 0: its frame is noise to 1, and what it senses last."""
    places, cuts = [(0, 0), (7.5, 0), (16, 0)], (Cut((1,), (3,)),)
    standard = RadioSection(shadowing_db=0.0, preamble_sinr_db=0.0, **WEAK)
    as_ns3 = RadioSection(shadowing_db=0.0, preamble_sinr_db=0.0, as_ns3=True, **WEAK)
    assert waits_us(standard, places, cuts) == pytest.approx(4, abs=0.1)
    assert waits_us(as_ns3, places, cuts) == pytest.approx(10, abs=0.1)


def test_a_frame_without_errors_ends_an_eifs() -> None:
    """9.2.3.4: an ACK-sized frame 1 us after the bad one ends 9 us before EIFS - DIFS does."""
    section = RadioSection(shadowing_db=0.0, mac_header_bytes=1, **WEAK)
    cell = Cell([(0, 0), (7.5, 0), (8.5, 0)], section, (Cut((1,), (3,)),))
    cell.send_at(0, 0, EVERYONE)
    end_us = 50 + 192 + 8 * 801
    cell.send_at(end_us + 1 - 50, 2, EVERYONE, 13)
    cell.send_at(end_us + 100, 1, EVERYONE, 100)
    cell.run(30_000)
    ends_us = {sender: now / 1000 for now, sender, _ in cell.arrived}
    began_us = ends_us[1] - 192 - 8 * 101
    assert cell.statuses[0, 1] == "bit errors"
    assert cell.statuses[2, 1] is None
    assert (began_us - ends_us[2]) % 20 == pytest.approx(10, abs=0.1)


def reserved(frames: list[tuple[float, int, int]], late_us: float, as_ns3: bool = False) -> bool:
    """Whether the NAV of station 3 is set at a time, after frames (start [us], sender, receiver).

    3 hears 0 and 2 alike, 4 hears 0 better; 0 and 2 do not hear each other; 1, who is out of everyone's
    reach, never answers.
    """
    places: Places = [(0, 0), (300, 0), (10, 0), (5, 0), (1, 0)]
    section = RadioSection(shadowing_db=0.0, retry_limit=1, as_ns3=as_ns3, preamble_sinr_db=4.0)
    cell = Cell(places, section, (Cut((1,), (3,)),))
    for start_us, sender, receiver in frames:
        cell.send_at(start_us - 50, sender, receiver)
    cell.run(late_us)
    now = round(late_us * 1000)
    return cell.dcf.medium.nav.until(StationIndex(3), now) > now


def test_the_nav_is_set_by_frames_that_were_received_and_by_no_others() -> None:
    """An RTS lasts 352 us; 0 is received whole, 2 begins while 3 is locked on 0."""
    assert reserved([(100, 0, 1)], 460)
    assert reserved([(100, 0, 1), (300, 2, 1)], 460)
    assert not reserved([(100, 0, 1), (100, 2, 1)], 460)
    assert not reserved([(100, 3, 1), (300, 2, 1)], 660)


def test_the_nav_of_an_rts_is_reset_unless_another_frame_begins() -> None:
    """9.2.5.4: after 2 SIFS, CTS and 2 slots, 364 us; ns-3 waits for a header more."""
    assert reserved([(100, 0, 1)], 452 + 362)
    assert not reserved([(100, 0, 1)], 452 + 367)
    assert reserved([(100, 0, 1)], 452 + 192 + 362, as_ns3=True)
    assert not reserved([(100, 0, 1)], 452 + 192 + 367, as_ns3=True)
    assert reserved([(100, 0, 1), (452 + 100, 2, 1)], 452 + 367)
    assert not reserved([(100, 0, 1), (452 + 200, 2, 1)], 452 + 367)


def give_up(cts_timeout_us: float, take_shortcuts: bool) -> tuple[float, float]:
    """When 0 gives up an RTS that nobody answers, and when 3 receives a frame of 2 meanwhile [us]."""
    section = RadioSection(shadowing_db=0.0, retry_limit=1, cts_timeout_us=cts_timeout_us)
    cell = Cell([(0, 0), (300, 0), (0, 0), (0, 0)], section, (), take_shortcuts)
    cell.send_at(0, 0, 1)
    cell.send_at(480, 2, 3)
    cell.run(60_000)
    return cell.given_up_at[0] / 1000, cell.arrived[0][0] / 1000


def test_a_sender_that_hears_a_frame_begin_waits_for_its_end_before_it_gives_up() -> None:
    """9.2.5.7: CTSTimeout counts until PHY-RXSTART, 192 us after the begin of the RTS of 2."""
    _, arrived_us = give_up(3000.0, True)
    rts_start_us = arrived_us - 6864 - 304 - 20 - 352
    for take_shortcuts in (True, False):
        early = give_up(rts_start_us + 190 - 402, take_shortcuts)
        late = give_up(rts_start_us + 194 - 402, take_shortcuts)
        in_data = give_up(rts_start_us + 3000 - 402, take_shortcuts)
        assert early[0] == pytest.approx(rts_start_us + 190, abs=0.1)
        assert late[0] == pytest.approx(rts_start_us + 352, abs=0.1)
        assert in_data == pytest.approx((arrived_us, arrived_us), abs=0.1)


def test_energy_makes_the_medium_busy_if_the_scenario_says_so() -> None:
    """CCA mode 2 knows carriers only; with energy detection two that are too weak alone are enough."""
    starts = {}
    for energy_detect_db in (None, 30.0, 40.0):
        section = RadioSection(
            shadowing_db=0.0, carrier_sense_db=60.0, energy_detect_db=energy_detect_db
        )
        cell = Cell([(0, 0), (30, 0)], section)
        cell.send_at(0, 0, EVERYONE)
        cell.send_at(1000, 1, EVERYONE, 100)
        cell.run(60_000)
        starts[energy_detect_db] = next(now for now, sender, _ in cell.arrived if sender == 1)
    assert starts[None] == starts[40.0] < starts[30.0]


def test_a_frame_too_weak_for_a_carrier_stops_a_backoff_by_its_energy() -> None:
    """1 waits out a backoff behind its own broadcast when 0 begins; without detection it goes on."""
    starts = {}
    for energy_detect_db in (None, 30.0):
        section = RadioSection(
            shadowing_db=0.0, carrier_sense_db=60.0, energy_detect_db=energy_detect_db
        )
        cell = Cell([(0, 0), (30, 0)], section)
        cell.send_at(0, 1, EVERYONE, 100)
        cell.send_at(100, 1, EVERYONE, 100)
        cell.send_at(50 + 192 + 8 * 134 + 1, 0, EVERYONE)
        cell.run(60_000)
        starts[energy_detect_db] = [now for now, sender, _ in cell.arrived if sender == 1][1]
    assert starts[None] + 6000 * 1000 < starts[30.0]


def test_a_jam_is_energy_and_no_carrier() -> None:
    """It ends in a tick in which nobody transmits, and whoever waited goes on."""
    arrivals = []
    for energy_detect_db in (None, 20.0):
        section = RadioSection(routing="direct", shadowing_db=0.0, energy_detect_db=energy_detect_db)
        mission = Mission(line(2, 3.0), section)
        mission.jams = (Jam(0.0, 0.0, 1.0, -40.0),)
        during = mission.run(4, {1: (message(BROADCAST, 40),)})
        mission.jams = ()
        arrivals.append((len(during), len(mission.run(2))))
    assert arrivals == [(1, 0), (0, 1)]
