"""Energy of driving and of the card, against the figures of their sources."""

import pytest

from onehop.analysis.energy import (
    DISCARD,
    IDLE_W,
    RECEIVE,
    RECEIVE_BROADCAST,
    SEND,
    SEND_BROADCAST,
    EnergyMeter,
    driving_w,
    gained_j,
)
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import DeliveryStatus, Presence, RadioRecord, Truth, Verdict
from onehop.contracts.radio_section import RadioSection

PERIOD_S = 0.05
IDLE_J = IDLE_W * PERIOD_S
SENT_POWER_W, RECEIVED_POWER_W = 1.327, 0.967
"""Powers of the same card while it sends and receives (Feeney and Nilsson, 2 Mb/s)."""


def truth(*places: tuple[int, float, float], tick: int = 1) -> Truth:
    present = tuple(Presence(i, 0, Pose(x, 0.0, 0.0), Twist(v, 0.0), False) for i, x, v in places)
    return Truth(tick, tick * 50_000_000, present, (), (), (), (), ())


def verdict(source: int, destination: int, receiver: int, path=(), attempts=(), arrival=1) -> Verdict:
    status = DeliveryStatus.DELIVERED if arrival >= 0 else DeliveryStatus.BELOW_THRESHOLD
    return Verdict(
        1, source, destination, receiver, status, 800, path, attempts, 0, 0, arrival, 0, 0, 40.0, 0.0
    )


def card(rate_mbps: float, present: Truth, *verdicts: Verdict) -> dict[int, float]:
    """What each card spends beyond idling [J]."""
    meter = EnergyMeter(RadioSection(rate_mbps=rate_mbps), PERIOD_S)
    spent = meter.take(present, RadioRecord(1, present.time_ns, verdicts, {}))
    return {robot: one.radio_j - IDLE_J for robot, one in spent.items()}


def test_costs_of_a_byte_are_its_time_at_2_mbps_times_the_power_above_idling() -> None:
    us_a_byte = 4.0
    assert pytest.approx((SENT_POWER_W - IDLE_W) * us_a_byte, abs=0.05) == SEND.per_byte_uj
    assert pytest.approx((RECEIVED_POWER_W - IDLE_W) * us_a_byte, abs=0.05) == RECEIVE.per_byte_uj
    assert SEND.joules(800, 1.0) - SEND.joules(800, 2.0) == pytest.approx(1.9e-6 * 800)


def test_a_robot_that_stands_and_hears_nothing_spends_its_idle_powers() -> None:
    spent = EnergyMeter(RadioSection(), PERIOD_S).take(truth((1, 0, 0)), RadioRecord(1, 0, (), {}))
    assert spent[1] == pytest.approx((0.29 * PERIOD_S, IDLE_J))


def test_driving_costs_by_wheel_speed_and_by_the_speed_that_is_gained() -> None:
    assert driving_w(1.0, 0.0) == driving_w(-1.0, 0.0) == pytest.approx(7.69)
    assert driving_w(0.0, 2.0) == pytest.approx(0.29 + 7.4 * 0.33)
    assert gained_j(1.0, 3.0) == gained_j(-1.0, -3.0) == pytest.approx(36.0)
    assert gained_j(3.0, 1.0) == 0.0
    meter, silent = EnergyMeter(RadioSection(), PERIOD_S), RadioRecord(1, 0, (), {})
    starts = meter.take(truth((1, 0, 1.0)), silent)[1].drive_j
    goes_on = meter.take(truth((1, 0, 1.0), tick=2), silent)[1].drive_j
    assert starts - goes_on == pytest.approx(4.5)


def test_every_attempt_costs_its_sender_and_every_hop_one_reception() -> None:
    relayed = verdict(1, 3, 3, (1, 2, 3), (2, 1))
    spent = card(2.0, truth((1, 0, 0), (2, 100, 0), (3, 200, 0)), relayed)
    assert spent[1] == pytest.approx(2 * SEND.joules(800, 2.0))
    assert spent[2] == pytest.approx(RECEIVE.joules(800, 2.0) + SEND.joules(800, 2.0))
    assert spent[3] == pytest.approx(RECEIVE.joules(800, 2.0))


def test_who_hears_a_frame_for_others_discards_it_and_who_is_far_does_not() -> None:
    spent = card(
        2.0, truth((1, 0, 0), (2, 5, 0), (3, 25, 0), (4, 25.2, 0)), verdict(1, 2, 2, (1, 2), (1,))
    )
    assert spent[3] == pytest.approx(DISCARD.joules(800, 2.0))
    assert spent[4] == 0.0


def test_a_broadcast_is_sent_once_and_at_the_basic_rate() -> None:
    heard = verdict(1, 0, 2, (1, 2), (1,))
    missed = verdict(1, 0, 3, (1,), (1,), arrival=-1)
    spent = card(11.0, truth((1, 0, 0), (2, 5, 0), (3, 6, 0)), heard, missed)
    assert spent[1] == pytest.approx(SEND_BROADCAST.joules(800, 1.0))
    assert spent[2] == pytest.approx(RECEIVE_BROADCAST.joules(800, 1.0))
    assert spent[3] == 0.0


def test_a_robot_that_has_left_spends_nothing() -> None:
    assert set(card(1.0, truth((2, 0, 0)), verdict(1, 2, 2, (1, 2), (1,)))) == {2}
