"""Carrier sense, backoff, hidden stations and reservations, event by event (802.11-1999, 9.2)."""

import pytest

from onehop.contracts.messages import Cut, DeliveryStatus
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.addresses import EVERYONE
from tests.radio.stations import Cell

STILL = RadioSection(shadowing_db=0.0, mac_header_bytes=28)
BASIC = RadioSection(shadowing_db=0.0, mac_header_bytes=28, rts_threshold_bytes=2304)
ONE_ATTEMPT = RadioSection(shadowing_db=0.0, retry_limit=1)
HIDDEN = (Cut((1,), (3,)),)
"""Stations 0 and 2 do not hear each other; station 1, between them, hears both."""


def test_an_idle_medium_is_entered_after_difs_without_backoff() -> None:
    """50 + 352 + 10 + 304 + 10 + 6816 us."""
    cell = Cell([(0, 0), (0, 0)], STILL)
    cell.send_at(1000, 0, 1)
    cell.run(20_000)
    assert [now for now, _, _ in cell.arrived] == [1_000_000 + 7_542_000]


def test_a_busy_medium_is_entered_after_a_backoff() -> None:
    """9.2.5.1: who arrives while the medium is busy draws a backoff and waits for DIFS after it."""
    cell = Cell([(0, 0)] * 4, STILL)
    cell.send_at(0, 0, 1)
    cell.send_at(3000, 2, 3)
    cell.run(40_000)
    (first, _, _), (second, sender, _) = cell.arrived
    after_ack = first + 314_000
    slots = (second - after_ack - 7_542_000) / 20_000
    assert sender == 2
    assert slots == int(slots)
    assert 0 <= slots <= 31


def test_routing_packets_are_served_before_the_data_that_waits() -> None:
    """Das, Perkins and Royer, INFOCOM 2000, section IV; each kind in its own order."""
    cell = Cell([(0, 0), (0, 0)], STILL)
    first, data, *routing = (
        cell.send_at(time_us, 0, 1, urgent=time_us > 150) for time_us in (0, 100, 200, 300)
    )
    cell.run(60_000)
    assert [frame for _, _, frame in cell.arrived] == [first, *routing, data]


def test_backoff_freezes_while_the_medium_is_busy() -> None:
    """9.2.5.2: a station that is interrupted after two slots of its backoff waits for the rest alone."""
    exchange_us, difs_us = 7_542 + 314, 50
    arrivals_us = []
    for interrupted in (False, True):
        cell = Cell([(0, 0)] * 6, STILL)
        cell.send_at(0, 0, 1)
        cell.send_at(3000, 2, 3)
        if interrupted:
            cell.send_at(exchange_us + difs_us + 5, 4, 5)
        cell.run(60_000)
        arrivals_us.append(next(now for now, sender, _ in cell.arrived if sender == 2) / 1000)
    slots = (arrivals_us[0] - exchange_us - 7_542) / 20
    assert slots > 3, "the draw of this seed leaves room for an interruption"
    second_end_us = exchange_us + difs_us + 5 + exchange_us
    assert arrivals_us[1] == second_end_us + 7_542 + 20 * (slots - 2)


def test_stations_that_speak_in_the_same_slot_collide_and_double_their_window() -> None:
    """Two fresh frames at the same instant: both RTS are lost, both arrive in the end."""
    cell = Cell([(0, 0)] * 4, STILL)
    frames = [cell.send_at(0, 0, 1), cell.send_at(0, 2, 3)]
    cell.run(40_000)
    assert len(cell.arrived) == 2
    assert all(frame.attempts >= 2 for frame in frames)
    assert cell.arrived[0][0] >= 1000 * (50 + 352 + 222 + 7_542)


def test_a_carrier_within_the_turnaround_is_not_sensed() -> None:
    """9.2.10: a station cannot sense what begins 5 us before its own slot, but does sense 6 us."""
    for gap_us, attempts in ((4.9, 2), (6.0, 1)):
        cell = Cell([(0, 0)] * 4, STILL)
        cell.send_at(0, 0, 1)
        second = cell.send_at(gap_us, 2, 3)
        cell.run(60_000)
        assert len(cell.arrived) == 2
        assert (second.attempts >= 2) == (attempts == 2)


def test_hidden_stations_overlap_with_basic_access() -> None:
    """The second station cannot sense the first one's data, and finds its receiver busy with it."""
    cell = Cell([(-5, 0), (0, 0), (5, 0)], BASIC, HIDDEN)
    first = cell.send_at(0, 0, 1)
    second = cell.send_at(1000, 2, 1)
    cell.run(200_000)
    assert first.attempts == 1
    assert second.attempts > 1


def test_cts_silences_hidden_stations() -> None:
    """9.2.5.4: the CTS of the station between them reserves the medium until the ACK."""
    cell = Cell([(-5, 0), (0, 0), (5, 0)], STILL, HIDDEN)
    first = cell.send_at(0, 0, 1)
    second = cell.send_at(1000, 2, 1)
    cell.run(200_000)
    assert (first.attempts, second.attempts) == (1, 1)
    (one, _, _), (two, _, _) = cell.arrived
    assert two > one + 314_000 + 7_542_000


def test_an_rts_without_an_answer_does_not_reserve_its_whole_exchange() -> None:
    """9.2.5.4: bystanders forget the reservation when no answer follows."""
    cell = Cell([(0, 0), (30, 0), (0, 3), (0, 6)], RadioSection(shadowing_db=0.0, carrier_sense_db=40.0))
    cell.send_at(0, 0, 1)
    cell.send_at(410, 2, 3)
    cell.run(60_000)
    arrival_us = cell.arrived[0][0] / 1000
    assert cell.arrived[0][1] == 2
    assert arrival_us < 410 + 7_542 + 48 + 31 * 20 + 6 * 700


def test_nobody_answers_inside_a_reservation() -> None:
    """9.2.5.7: a station whose NAV is set leaves an RTS without a CTS."""
    cuts = (Cut((1,), (3,)), Cut((1,), (4,)), Cut((2,), (4,)))
    cell = Cell([(0, 0), (5, 0), (10, 0), (15, 0)], STILL, cuts)
    cell.send_at(0, 0, 1)
    late = cell.send_at(1200, 3, 2)
    cell.run(8_000)
    assert late.attempts >= 2
    assert late.cause is DeliveryStatus.RECEIVER_BUSY
    cell.run(60_000)
    assert len(cell.arrived) == 2


@pytest.mark.parametrize(
    "gone_us", [100, 405, 500, 720, 2000], ids=["in RTS", "before CTS", "in CTS", "after CTS", "in data"]
)
def test_a_receiver_that_leaves_during_an_exchange_is_the_reason_of_its_failure(
    gone_us: float,
) -> None:
    """RTS from 50 to 402 us, CTS from 412 to 716 us, data from 726 us on."""
    cell = Cell([(0, 0), (0, 0)], ONE_ATTEMPT)
    frame = cell.send_at(0, 0, 1)
    cell.run(gone_us)
    cell.dcf.remove(1)
    cell.run(20_000)
    assert cell.given_up == [frame]
    assert frame.cause == "receiver gone"


def test_a_receiver_that_leaves_before_its_acknowledgement_has_the_frame() -> None:
    """The data ends at 7,590 us, the ACK begins 10 us later."""
    cell = Cell([(0, 0), (0, 0)], ONE_ATTEMPT)
    frame = cell.send_at(0, 0, 1)
    cell.run(7_595)
    cell.dcf.remove(1)
    cell.run(20_000)
    assert [arrived for _, _, arrived in cell.arrived] == cell.given_up == [frame]
    assert (frame.received, frame.cause) == (True, "receiver gone")


def test_a_frame_is_given_up_after_the_one_limit_of_the_thesis() -> None:
    cell = Cell([(0, 0), (60, 0)], STILL)
    frame = cell.send_at(0, 0, 1)
    cell.run(100_000)
    assert cell.given_up == [frame]
    assert (frame.attempts, frame.cause) == (7, DeliveryStatus.BELOW_THRESHOLD)


def test_a_broadcast_is_sent_once_at_the_basic_rate() -> None:
    """No RTS, no ACK: DIFS + 192 + 8 (28 + 40) us, at 1 Mb/s whatever the data rate."""
    fast = RadioSection(shadowing_db=0.0, mac_header_bytes=28, rate_mbps=11.0)
    cell = Cell([(0, 0), (0, 0)], fast)
    frame = cell.send_at(0, 0, EVERYONE, 40)
    cell.run(20_000)
    assert [now for now, _, _ in cell.arrived] == [1000 * (50 + 192 + 8 * 68)]
    assert frame.attempts == 1


def test_propagation_delays_every_frame() -> None:
    """Thesis eq. 3.16: three delays until the data has arrived; 299.79 m are a microsecond."""
    loud = RadioSection(shadowing_db=0.0, mac_header_bytes=28, tx_power_dbm=70.0)
    cell = Cell([(0, 0), (299.792458, 0)], loud)
    cell.send_at(0, 0, 1)
    cell.run(20_000)
    assert [now for now, _, _ in cell.arrived] == [7_542_000 + 3_000]


def test_a_repeated_copy_is_not_handed_up_twice() -> None:
    """9.2.9: when only the ACK is lost the sender repeats, the receiver drops the copy."""
    faded = RadioSection(mac_header_bytes=28)
    cell = Cell([(0, 0), (17, 0)], faded)
    frames = [cell.send_at(0, 0, 1) for _ in range(60)]
    cell.run(3_000_000)
    arrived = [id(frame) for _, _, frame in cell.arrived]
    assert len(arrived) == len(set(arrived)) > 40
    assert any(frame.received for frame in cell.given_up) or sum(f.attempts for f in frames) > 70
