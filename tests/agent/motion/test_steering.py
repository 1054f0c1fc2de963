"""From a bearing to a twist: the one place where a robot turns and drives."""

import math

import pytest

from onehop.contracts import elementary
from onehop.contracts.geometry import STANDSTILL, Twist
from robot_agent.core.motion.steering import TURN_IN_PLACE, Steering, stoppable
from tests.agent.motion.scans import BEAMS, BODY, GAINS, OPEN, block, walls

POW_DIFFERS = (1.2986881746121464, 1.3916975423503644, 1.4701317332823889)
"""Directions whose cosine the C library does not square by multiplying, with FMA or without [rad]."""


def steering():
    return Steering(BODY, GAINS, BEAMS)


def test_turning_on_the_spot_never_moves():
    assert steering().turn(3.0) == Twist(0.0, BODY.max_turn_rate)
    assert steering().turn(-0.1) == Twist(0.0, pytest.approx(-0.8))
    assert steering().turn(0.0) == STANDSTILL


@pytest.mark.parametrize("direction", POW_DIFFERS)
def test_the_speed_falls_with_a_product_and_not_with_the_c_librarys_power(direction):
    """Which has other last places on other processors, and a twist feeds them back."""
    facing = elementary.cos(direction)
    assert steering().drive(direction, 1.0).v == facing * facing
    assert steering().drive(-direction, 3.0).v == 3.0 * facing * facing


def test_a_robot_drives_fully_ahead_and_not_at_all_abeam():
    assert steering().drive(0.0, 2.0) == Twist(2.0, 0.0)
    assert steering().drive(0.5 * math.pi, 2.0).v == pytest.approx(0.0, abs=1e-12)
    assert steering().drive(2.0, 2.0) == Twist(0.0, BODY.max_turn_rate)


def test_a_way_around_goes_to_the_bearing_where_nothing_is_in_the_way():
    assert steering().around(OPEN, 0.0, 1.0) == Twist(1.0, pytest.approx(0.0, abs=1e-9))
    assert steering().around(OPEN, TURN_IN_PLACE + 0.1, 1.0) == Twist(0.0, BODY.max_turn_rate)


def test_a_way_around_goes_past_what_is_in_the_way_and_turns_where_nothing_is_free():
    past = steering().around(block(-10, 30, 1.0), 0.1, 1.0)
    assert past.v > 0.2
    assert past.w < -1.0
    assert steering().around(walls(0.3), -0.1, 1.0) == Twist(0.0, -BODY.max_turn_rate)


def test_a_robot_is_as_slow_as_lets_it_stop_before_what_it_sees():
    assert stoppable(3.0, 0.2) == pytest.approx(0.5)
    assert stoppable(3.0, 9.0) == 3.0
    assert stoppable(3.0, -0.1) == 0.0
