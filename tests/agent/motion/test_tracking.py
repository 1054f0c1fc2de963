"""The tracking controller against the thesis's equations."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.sections import GainsSection, RobotSection
from robot_agent.core.motion.tracking import polar_error, polar_twist, within_limits

GAINS = GainsSection()
TARGET = Pose(0.0, 0.0, 0.0)
coordinate = st.floats(-10.0, 10.0)
angle = st.floats(-3.0, 3.0)


def test_error_ahead_is_eq_3_5_to_3_7():
    error = polar_error(Pose(-3.0, -4.0, 0.2), TARGET)
    assert error.rho == pytest.approx(5.0)
    assert error.alpha == pytest.approx(-0.2 + math.atan2(4.0, 3.0))
    assert error.beta == pytest.approx(-0.2 - error.alpha)
    assert not error.reverse


def test_target_behind_is_eq_3_9_and_drives_backwards():
    error = polar_error(Pose(2.0, 0.0, 0.0), TARGET)
    twist = polar_twist(error, GAINS, 1.0, 9.0)
    assert error.reverse
    assert twist == Twist(-2.0, pytest.approx(0.0, abs=1e-9))


@pytest.mark.parametrize(
    ("bearing", "reverse"), [(90.0, False), (-90.0, True), (91.0, True), (-89.0, False)]
)
def test_boundary_of_the_two_intervals_is_half_open(bearing, reverse):
    """Eq. 3.4: I1 = (-pi/2, pi/2]."""
    heading = -math.radians(bearing)
    assert polar_error(Pose(-1.0, 0.0, heading), TARGET).reverse is reverse


def test_law_is_eq_3_11_and_3_12_with_the_thesis_gains():
    error = polar_error(Pose(-2.0, 0.0, -0.1), TARGET)
    twist = polar_twist(error, GAINS, 3.0, 100.0)
    assert twist.v == pytest.approx(3.0 * 2.0)
    assert twist.w == pytest.approx(8.0 * 0.1 - 1.5 * 0.0)
    turned = polar_error(Pose(-2.0, 0.0, 0.0), Pose(0.0, 0.0, 0.4))
    assert polar_twist(turned, GAINS, 3.0, 100.0).w == pytest.approx(-1.5 * 0.4)


def test_speed_is_limited_to_what_the_body_can():
    error = polar_error(Pose(-100.0, 0.0, 0.0), TARGET)
    assert polar_twist(error, GAINS, 3.0, 3.0).v == 3.0


@settings(deadline=None, max_examples=30)
@given(coordinate, coordinate, angle, angle, st.sampled_from([1.0, 3.0]))
def test_closed_loop_comes_to_the_pose_from_anywhere(x, y, heading, wanted, k_rho):
    """Eq. 3.13, 3.14: stable; integrated with small steps, without limits of the body."""
    pose, target, step = Pose(x, y, heading), Pose(0.0, 0.0, wanted), 0.005
    for _ in range(4000):
        twist = polar_twist(polar_error(pose, target), GAINS, k_rho, 1e9)
        middle = pose.heading + 0.5 * twist.w * step
        pose = Pose(
            pose.x + twist.v * step * math.cos(middle),
            pose.y + twist.v * step * math.sin(middle),
            pose.heading + twist.w * step,
        )
    assert math.hypot(pose.x, pose.y) < 0.05


def test_turn_limit_keeps_the_arc():
    body = RobotSection(max_turn_rate=3.0)
    limited = within_limits(Twist(2.0, -6.0), body)
    assert limited == Twist(1.0, -3.0)
    assert within_limits(Twist(2.0, 1.0), body) == Twist(2.0, 1.0)
