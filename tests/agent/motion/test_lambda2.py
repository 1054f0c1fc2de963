"""Gain policy `lambda2`: up the second eigenvalue of the Laplacian of rates."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.briefings import robot_briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GainsSection, GoalSection, MapSection
from robot_agent.core.motion.aim import Situation
from robot_agent.core.motion.lambda2 import NEAREST, Lambda2Gain, ascent, rate, second_eigenpair

PLACES = st.lists(
    st.tuples(st.floats(-15.0, 15.0), st.floats(-15.0, 15.0)), min_size=2, max_size=6, unique=True
)


def weights_of(places):
    return [[0.0 if a == b else rate(math.dist(a, b))[0] for b in places] for a in places]


def laplacian(weights):
    matrix = np.array(weights)
    return np.diag(matrix.sum(axis=1)) - matrix


@pytest.mark.parametrize("distance", [1.0, 4.0, 8.0, 25.0])
def test_the_rate_is_that_of_fink(distance: float) -> None:
    """1 - erfc(sqrt(P / N0)) with L0 = -53 dBm, n = 2.52, N0 = -70 dBm."""
    over_noise = 10.0 ** ((-53.0 - 25.2 * math.log10(distance) + 70.0) / 10.0)
    value, slope = rate(distance)
    assert value == pytest.approx(1.0 - math.erfc(math.sqrt(over_noise)), rel=1e-9)
    step = 1e-5
    measured = (rate(distance + step)[0] - rate(distance - step)[0]) / (2.0 * step)
    assert slope == pytest.approx(measured, rel=1e-4, abs=1e-9)


@given(PLACES)
def test_the_eigenvalue_is_never_below_lambda2_and_mostly_near_it(places) -> None:
    weights = weights_of(places)
    value, vector = second_eigenpair(weights)
    exact = np.linalg.eigvalsh(laplacian(weights))
    assert value >= exact[1] - 1e-9
    assert value <= exact[-1] + 1e-9
    assert math.fsum(vector) == pytest.approx(0.0, abs=1e-9)
    assert math.fsum(one * one for one in vector) == pytest.approx(1.0)


def test_the_eigenvalue_of_a_straggler_is_exact() -> None:
    weights = weights_of(
        [(-20.0, 0.0), (0.0, 0.0), (-2.0, 3.5), (-2.0, -3.5), (-6.0, 3.5), (-6.0, -3.5)]
    )
    assert second_eigenpair(weights)[0] == pytest.approx(np.linalg.eigvalsh(laplacian(weights))[1])


@pytest.mark.parametrize("here", [(-20.0, 0.0), (-10.0, 2.0), (-12.0, -7.0)])
def test_the_ascent_is_the_gradient_of_log_lambda2(here) -> None:
    others = ((0.0, 0.0), (-2.0, 3.5), (-2.0, -3.5), (-6.0, 3.5), (-6.0, -3.5))

    def log_lambda2(x, y):
        return math.log(np.linalg.eigvalsh(laplacian(weights_of([(x, y), *others])))[1])

    step, (x, y) = 1e-4, here
    measured = (
        (log_lambda2(x + step, y) - log_lambda2(x - step, y)) / (2.0 * step),
        (log_lambda2(x, y + step) - log_lambda2(x, y - step)) / (2.0 * step),
    )
    assert ascent(here, others) == pytest.approx(measured, rel=0.01)


def test_two_robots_attract_each_other_until_they_are_side_by_side() -> None:
    x, y = ascent((0.0, 0.0), ((10.0, 0.0),))
    assert x > 0.0
    assert y == 0.0
    assert ascent((0.0, 0.0), ((NEAREST / 2.0, 0.0),)) == (0.0, 0.0)


def policy() -> Lambda2Gain:
    scenario = Scenario(
        name="lambda2",
        goal=GoalSection(90.0, 0.0),
        map=MapSection(width=100.0, height=100.0),
        gains=GainsSection(policy="lambda2", k_rho_min=0.3),
    )
    return Lambda2Gain(robot_briefing(scenario, 1, 0))


def situation(x: float, told_ns: int, driving: bool = True) -> Situation:
    others = ((0.0, 0.0), (-2.0, 3.5), (-2.0, -3.5))
    slot = Pose(-4.0, 0.0, 0.0)
    return Situation(told_ns, Pose(x, 0.0, 0.0), Pose(0.0, 0.0, 0.0), told_ns, slot, others, driving)


def test_a_straggler_aims_beyond_its_slot_by_half_a_spacing_at_most() -> None:
    one = policy()
    aims = [one.aim(situation(x, told)) for told, x in enumerate((-6.0, -10.0, -20.0))]
    assert all(aim.slot.x > -4.0 for aim in aims)
    assert all(aim.slot.x <= -2.0 + 1e-12 for aim in aims)
    assert all(aim.k_rho == 0.3 for aim in aims)


def test_the_gradient_is_renewed_with_each_word_and_not_between() -> None:
    one = policy()
    first = one.aim(situation(-10.0, 1))
    assert one.aim(situation(-6.0, 1)) == first
    assert one.aim(situation(-6.0, 2)) != first


def test_the_very_slot_counts_while_the_team_gathers() -> None:
    assert policy().aim(situation(-10.0, 1, driving=False)).slot == Pose(-4.0, 0.0, 0.0)


def test_throughput_is_not_what_it_goes_by() -> None:
    assert {policy().heard(one, 5e5) for one in (0.0, 1e6)} == {0.3}
