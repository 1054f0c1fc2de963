"""k_rho follows the throughput of the link (thesis 3.5)."""

from typing import get_args

import pytest

from onehop.contracts.briefings import robot_briefing
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GainPolicyName, GainsSection, GoalSection, MapSection, TeamSection
from robot_agent.core.motion.gains import make_policy
from robot_agent.core.robot import required_throughput_bps

THRESHOLD = 0.5333e6  # thesis 3.8.3


def course(policy, throughputs):
    scenario = Scenario(
        name="gains",
        goal=GoalSection(9.0, 0.0),
        map=MapSection(width=20.0, height=20.0),
        gains=GainsSection(policy=policy, k_rho_min=1.0, k_rho_max=3.0),
    )
    chooser = make_policy(robot_briefing(scenario, 1, 0))
    return [chooser.heard(value, THRESHOLD) for value in throughputs]


def test_thesis_policy_is_two_valued():
    assert course("throughput", [0.78e6, 0.5e6, 0.0, 0.5333e6, 0.6e6]) == [1.0, 3.0, 3.0, 1.0, 1.0]


def test_constant_policy_never_hurries():
    assert course("constant", [0.78e6, 0.0, 0.1e6]) == [1.0, 1.0, 1.0]


def test_smooth_policy_is_calm_on_a_good_link_and_hurries_fully_on_a_dead_one():
    assert course("smooth", [0.84e6] * 5) == [1.0] * 5
    assert course("smooth", [0.0] * 5)[-1] == 3.0


def test_smooth_policy_answers_one_fade_with_less_than_full_gain():
    assert 1.0 < course("smooth", [0.84e6, 0.55e6])[-1] < 3.0
    assert course("throughput", [0.84e6, 0.53e6])[-1] == 3.0


def test_smooth_policy_sees_a_steady_fall_before_the_threshold():
    falling = [0.80e6, 0.75e6, 0.70e6, 0.65e6, 0.60e6]
    assert all(gain == 1.0 for gain in course("throughput", falling))
    smooth = course("smooth", falling)
    assert smooth == sorted(smooth)
    assert smooth[-1] > 1.5


@pytest.mark.parametrize("policy", get_args(GainPolicyName))
def test_gain_stays_within_its_bounds(policy):
    values = course(policy, [0.0, 1e6, 0.3e6, 0.0, 2e6, 0.5e6])
    assert all(1.0 <= gain <= 3.0 for gain in values)


def test_the_ideal_threshold_follows_rate_and_size_of_next():
    """Thesis 3.8.3: 0.5333 Mb/s; eq. 3.15 gives 0.7792 Mb/s at 1 Mb/s and 800 B."""

    def threshold(threshold="ideal", rate_mbps=1.0, size=800, distance=0.0):
        scenario = Scenario(
            name="links",
            goal=GoalSection(9.0, 0.0),
            map=MapSection(width=20.0, height=20.0),
            team=TeamSection(next_msdu_bytes=size),
            gains=GainsSection(threshold=threshold),
            radio=RadioSection(rate_mbps=rate_mbps),
        )
        return required_throughput_bps(robot_briefing(scenario, 1, 0), distance)

    assert threshold() == pytest.approx(THRESHOLD, rel=1e-3)
    assert threshold(rate_mbps=11.0) > 3.0 * THRESHOLD
    assert threshold(size=200) < 0.8 * THRESHOLD
    assert threshold("thesis", 11.0, 200) == THRESHOLD
    near, far = (threshold("slot", distance=distance) for distance in (4.0, 8.0))
    assert far < near < threshold()
    assert far == pytest.approx(THRESHOLD, rel=1e-3), "slightly different from slot to slot (3.8.3)"
