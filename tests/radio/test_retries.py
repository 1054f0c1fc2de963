"""Retry counts and the contention window (802.11-1999, 9.2.4 and 9.2.5.3), and ns-3's reading."""

import pytest

from onehop.contracts.messages import DeliveryStatus
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.addresses import EVERYONE, StationIndex
from radio_proxy.core.airtime import dsss
from radio_proxy.core.closed_forms import SaturatedLink, frame_probability
from radio_proxy.core.contention import Frame, Station
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_rules import LinkRules, RetryLimits, link_rules
from radio_proxy.core.retries import Retries
from radio_proxy.core.saturation import Saturation, pair
from tests.radio.stations import Cell

BY_COUNTS = LinkRules(retries=RetryLimits(single=None))


def fail(retries: Retries, station: Station, frame: Frame, after_cts: bool) -> tuple[bool, int]:
    """One more attempt that was not answered: whether it was the last, and the window's doublings."""
    frame.attempts += 1
    given_up = retries.on_failure(station, frame, after_cts)
    return given_up, station.failures


def test_seven_failed_rts_or_four_failed_data_frames_end_a_frame() -> None:
    for after_cts, limit in ((False, 7), (True, 4)):
        retries, station, frame = Retries(BY_COUNTS), Station(StationIndex(0)), Frame(EVERYONE, 1, None)
        ended = [fail(retries, station, frame, after_cts)[0] for _ in range(limit)]
        assert ended == [False] * (limit - 1) + [True]


def test_the_window_doubles_with_either_count_and_starts_over_at_a_limit() -> None:
    retries, station, frame = Retries(BY_COUNTS), Station(StationIndex(0)), Frame(EVERYONE, 1, None)
    seen = [
        fail(retries, station, frame, after_cts)[1] for after_cts in (False, True, False, True, True)
    ]
    assert seen == [1, 2, 3, 4, 5]
    assert fail(retries, station, frame, True) == (True, 0)


def test_a_cts_resets_the_short_count_but_not_the_window() -> None:
    retries, station, frame = Retries(BY_COUNTS), Station(StationIndex(0)), Frame(EVERYONE, 1, None)
    for _ in range(6):
        fail(retries, station, frame, False)
    retries.on_cts(frame)
    assert fail(retries, station, frame, True) == (False, 7)
    assert fail(retries, station, frame, False) == (False, 8)


def test_ns3_keeps_the_window_of_a_frame_that_is_given_up() -> None:
    """3.44: CW 1023 after the seventh failure stays; the eighth in a row resets it; so does an ACK."""
    retries, station = Retries(LinkRules(as_ns3=True)), Station(StationIndex(0))
    frame = Frame(EVERYONE, 1, None)
    seen = [fail(retries, station, frame, False) for _ in range(7)]
    assert seen[-2:] == [(False, 6), (True, 7)]
    retries.on_broadcast(station)
    assert station.failures == 7
    assert fail(retries, station, Frame(EVERYONE, 1, None), True) == (False, 0)
    standard = Retries(LinkRules())
    station.failures = 5
    standard.on_broadcast(station)
    assert station.failures == 0


@pytest.mark.parametrize(
    ("keys", "limits"),
    [
        ({}, RetryLimits(single=7)),
        ({"retry_limit": 3}, RetryLimits(single=3)),
        ({"preset": "physical"}, RetryLimits(single=None, short=7, long=4)),
        ({"preset": "physical", "as_ns3": True}, RetryLimits(single=7)),
        ({"preset": "physical", "retry_limit": 2}, RetryLimits(single=2)),
        ({"long_retry_limit": 5}, RetryLimits(single=None, short=7, long=5)),
        ({"short_retry_limit": 2, "as_ns3": True}, RetryLimits(single=None, short=2, long=4)),
    ],
)
def test_limits_of_a_scenario(keys: dict[str, object], limits: RetryLimits) -> None:
    section = RadioSection(**keys)  # type: ignore[arg-type]
    assert link_rules(section).retries == limits
    assert list(section.problems()) == []


def test_in_ns3_all_energy_is_held_against_carrier_sense() -> None:
    assert link_rules(RadioSection()).energy_detect_db is None
    assert link_rules(RadioSection(as_ns3=True, carrier_sense_db=26.0)).energy_detect_db == 26.0
    assert link_rules(RadioSection(as_ns3=True, energy_detect_db=40.0)).energy_detect_db == 40.0


def test_one_limit_and_two_are_not_set_together() -> None:
    section = RadioSection(retry_limit=7, long_retry_limit=4)
    assert [problem.key for problem in section.problems()] == ["long_retry_limit"]


@pytest.mark.parametrize(("rate_mbps", "attempts"), [(1.0, 7), (11.0, 4)])
def test_frames_of_the_dcf_end_by_the_count_that_is_theirs(rate_mbps: float, attempts: int) -> None:
    """At 0 dB an RTS gets through at 1 Mb/s, data at 11 never; at -9 dB nothing does."""
    distance = 4.0 if rate_mbps == 11.0 else 11.0
    section = RadioSection(
        preset="physical", path_loss_exponent=2.0, shadowing_db=0.0, rate_mbps=rate_mbps,
        tx_power_dbm=-41.0, receive_threshold_db=-9.5, carrier_sense_db=-30.0,
    )  # fmt: skip
    cell = Cell([(0, 0), (distance, 0)], section)
    frame = cell.send_at(0, 0, 1)
    cell.run(400_000)
    assert cell.given_up == [frame]
    assert (frame.attempts, frame.cause) == (attempts, DeliveryStatus.BIT_ERRORS)


def test_an_acknowledged_frame_resets_the_window() -> None:
    """Two fresh frames in one instant collide; both arrive in the end."""
    cell = Cell([(0, 0)] * 4, RadioSection(shadowing_db=0.0))
    frames = [cell.send_at(0, 0, 1), cell.send_at(0, 2, 3)]
    cell.run(700)
    assert all(cell.dcf._stations[i].failures == 1 for i in (0, 2))
    cell.run(60_000)
    assert all(frame.received and frame.attempts > 1 for frame in frames)
    assert all(cell.dcf._stations[i].failures == 0 for i in (0, 2))


@pytest.mark.slow
@pytest.mark.parametrize("distance", [10.0, 15.0, 20.0])
def test_a_link_with_both_counts_is_within_3_percent_of_the_closed_form(distance: float) -> None:
    section = RadioSection(short_retry_limit=7, long_retry_limit=4)
    budget, timing, rules = link_budget(section), dsss(section), link_rules(section)
    p = frame_probability(budget, budget.mean_snr_db(distance), 1.0, 834)
    _, expected = SaturatedLink(timing, 800, rules.retries).one_draw_per_frame(p, p, p, p)
    tally = Saturation(pair(distance, 800, True), timing, budget, 1, rules).run(200.0)
    assert tally.delivered[0] * 6400 / 200e6 == pytest.approx(expected, rel=0.03)
