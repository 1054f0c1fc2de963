"""Gain policy `predictive`: acts on what will be."""

import math

import pytest

from onehop.contracts.briefings import Briefing, robot_briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GainsSection, GoalSection, MapSection
from robot_agent.core.motion.aim import Report, Situation
from robot_agent.core.motion.predictive import LEAST_PACE, PredictiveGain

S = 1_000_000_000
THRESHOLD = 0.5333e6


def briefing(**radio: object) -> Briefing:
    scenario = Scenario(
        name="predictive",
        goal=GoalSection(90.0, 0.0),
        map=MapSection(width=100.0, height=100.0),
        gains=GainsSection(policy="predictive", k_rho_min=0.3),
        radio=RadioSection(**radio),
    )
    return robot_briefing(scenario, 1, 0)


def situation(now_s: float, leader: Pose, told_s: float, pose: Pose, driving: bool = True) -> Situation:
    slot = Pose(leader.x - 4.0, leader.y, leader.heading)
    return Situation(round(now_s * S), pose, leader, round(told_s * S), slot, (), driving)


def told_twice(policy: PredictiveGain, heading: float = 0.0) -> None:
    """The leader was at (8, 0) and 2 s later at (10, 0)."""
    policy.aim(situation(0.0, Pose(8.0, 0.0, 0.0), 0.0, Pose(0.0, 0.0, 0.0)))
    policy.aim(situation(2.0, Pose(10.0, 0.0, heading), 2.0, Pose(2.0, 0.0, 0.0)))


def test_the_slot_moves_on_with_the_leader_between_its_words() -> None:
    policy = PredictiveGain(briefing())
    told_twice(policy)
    aims = [
        policy.aim(situation(2.0 + age, Pose(10.0, 0.0, 0.0), 2.0, Pose(2.0, 0.0, 0.0)))
        for age in (0.0, 1.0, 2.0)
    ]
    assert [aim.slot.x for aim in aims] == pytest.approx([6.0, 7.0, 8.0])


def test_a_leader_that_turns_is_taken_to_drive_where_it_looks() -> None:
    """It came 2 m along x and looks 60 degrees to the left: half of its speed, that way."""
    policy = PredictiveGain(briefing())
    heading = math.pi / 3.0
    told_twice(policy, heading)
    aim = policy.aim(situation(4.0, Pose(10.0, 0.0, heading), 2.0, Pose(2.0, 0.0, 0.0)))
    assert (aim.slot.x - 6.0, aim.slot.y) == pytest.approx((0.5, math.sqrt(3.0) / 2.0))


def test_a_leader_that_is_silent_for_long_is_taken_to_be_where_it_said() -> None:
    policy = PredictiveGain(briefing())
    told_twice(policy)
    silent = policy.aim(situation(6.1, Pose(10.0, 0.0, 0.0), 2.0, Pose(2.0, 0.0, 0.0)))
    assert silent.slot.x == 6.0
    assert silent.k_rho == 0.3


def test_a_follower_keeps_half_the_pace_of_its_leader_within_the_gains_bounds() -> None:
    policy = PredictiveGain(briefing())
    told_twice(policy)
    far = policy.aim(situation(2.5, Pose(10.0, 0.0, 0.0), 2.0, Pose(1.5, 0.0, 0.0)))
    assert far.k_rho == pytest.approx(0.3 + 0.5 / 5.0)
    near = policy.aim(situation(2.5, Pose(10.0, 0.0, 0.0), 2.0, Pose(6.45, 0.0, 0.0)))
    assert near.k_rho == 3.0
    passed = policy.aim(situation(2.5, Pose(10.0, 0.0, 0.0), 2.0, Pose(8.5, 0.0, 0.0)))
    assert passed.k_rho == 0.3


def test_it_hurries_below_the_threshold_and_before_a_steady_fall_reaches_it() -> None:
    policy = PredictiveGain(briefing())
    throughputs = (0.84e6, 0.76e6, 0.66e6, 0.66e6, 0.5e6, 0.7e6)
    heard = [policy.heard(one, THRESHOLD) for one in throughputs]
    # 0.66 after 0.76 is 0.56 next: still enough; 0.5 is too low; 0.7 rises.
    assert heard == [0.3, 0.3, 0.3, 0.3, 3.0, 0.3]
    assert policy.heard(0.6e6, THRESHOLD) == 3.0, "0.5 with the next Next"


def test_who_is_waited_for_hurries() -> None:
    policy = PredictiveGain(briefing())
    aim = policy.aim(situation(0.0, Pose(8.0, 0.0, 0.0), 0.0, Pose(0.0, 0.0, 0.0), driving=False))
    assert (aim.slot.x, aim.k_rho) == (4.0, 3.0)


def report(apart: float, snr_db: float, hops: int = 1) -> Report:
    return Report((-apart, 0.0), (0.0, 0.0), snr_db, hops)


def free_space_db(apart: float) -> float:
    """60 dB at 1 m (thesis 3.7)."""
    return 60.0 - 20.0 * math.log10(apart)


@pytest.mark.parametrize(
    ("apart", "share"),
    # 36 dB, four above the threshold, are at 15.85 m; a period of 2 s at 1 m/s is 2 m.
    [(8.0, 1.0), (13.8, 1.0), (14.85, 0.5), (15.8, LEAST_PACE), (30.0, LEAST_PACE)],
)
def test_the_leader_slows_where_a_follower_comes_near_the_frontier(apart: float, share: float) -> None:
    policy = PredictiveGain(briefing())
    pace = policy.pace((0.0, 0.0), {2: report(apart, free_space_db(apart)), 4: report(4.0, 48.0)})
    assert pace == pytest.approx(share, abs=0.01)


def test_a_single_fade_moves_the_frontier_by_a_quarter_of_it() -> None:
    policy = PredictiveGain(briefing())
    assert policy.pace((0.0, 0.0), {2: report(8.0, free_space_db(8.0))}) == 1.0
    faded = policy.pace((0.0, 0.0), {2: report(8.0, free_space_db(8.0) - 8.0)})
    assert faded == 1.0
    for seen in range(8):
        faded = policy.pace((0.0, 0.0), {2: report(8.0, free_space_db(8.0) - 8.0 - 0.001 * seen)})
    assert faded < 1.0


def test_who_is_heard_over_a_relay_has_no_frontier() -> None:
    policy = PredictiveGain(briefing())
    assert policy.pace((0.0, 0.0), {2: report(40.0, 40.0, hops=2)}) == 1.0
    assert policy.pace((0.0, 0.0), {}) == 1.0


def test_a_card_that_hears_more_has_a_farther_frontier() -> None:
    sensitive = PredictiveGain(briefing(preset="indoor"))
    assert sensitive.pace((0.0, 0.0), {2: report(30.0, free_space_db(30.0))}) == 1.0
