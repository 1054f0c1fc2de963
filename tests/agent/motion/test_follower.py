"""A follower's way to its slot: tracking in the open, a detour around what is in the way."""

import math

import numpy as np
import pytest

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.sections import GainsSection
from robot_agent.core.motion.detour import SlotTask
from robot_agent.core.motion.follower import FollowerMotion
from tests.agent.motion.scans import BEAMS, BODY, GAINS, HERE, OPEN, PERIOD, block, moved


def follower(period=PERIOD, gains=GAINS, draws=(0.3, 0.7)):
    return FollowerMotion(BODY, gains, BEAMS, period, draws)


def task(slot, k_rho=1.0):
    """Its slot, and no trail; the leader drives 4 m ahead of it."""
    return SlotTask(slot, (), 4.0, True, k_rho)


def test_a_slot_behind_is_turned_to_on_the_spot_unless_reversing_is_asked_for():
    behind = task(Pose(-3.0, 0.0, 0.0))
    twist = follower().to_slot(HERE, OPEN, math.inf, behind)
    assert twist.v == 0.0
    assert twist.w != 0.0


def test_a_slot_behind_is_backed_up_to_over_ground_seen_free_a_moment_ago():
    """Thesis eq. 3.10: v = -k_rho * rho."""
    backing, behind = follower(gains=GainsSection(reverse=True)), task(Pose(-0.3, 0.0, 0.0))
    assert backing.to_slot(HERE, OPEN, math.inf, behind).v == 0.0, "it never looked there"
    backing = follower(gains=GainsSection(reverse=True))
    for x in (-1.2, -0.8, -0.4):
        for _ in range(4):
            backing.to_slot(Pose(x, 0.0, 0.0), OPEN, math.inf, task(Pose(4.0, 0.0, 0.0)))
    assert backing.to_slot(HERE, OPEN, math.inf, behind).v == pytest.approx(-0.3)
    wall = follower(gains=GainsSection(reverse=True))
    assert wall.to_slot(HERE, block(-90, 90, 1.0), 1.0, behind).v == 0.0


@pytest.mark.parametrize("period", [0.02, 0.05, 0.1])
def test_an_obstacle_in_the_way_for_a_second_starts_border_following_and_no_flutter(period):
    driver, slot = follower(period), task(Pose(5.0, 0.0, 0.0))
    wall, second = block(-30, 30, 1.0), round(1.0 / period)
    blocked = 0
    while not driver.detour.border:
        driver.to_slot(HERE, wall, 1.0, slot)
        blocked += 1
    assert 0.75 <= blocked * period <= 1.05
    for _ in range(second // 5):
        driver.to_slot(HERE, OPEN, math.inf, slot)
    assert driver.detour.border, "a clear look or two are not the clear"
    for _ in range(second // 2):
        driver.to_slot(HERE, OPEN, math.inf, slot)
    assert not driver.detour.border


def test_in_its_slot_a_robot_only_turns_to_the_leaders_heading():
    twist = follower().to_slot(HERE, OPEN, math.inf, task(Pose(0.05, 0.0, 1.0), 3.0))
    assert twist.v == 0.0
    assert twist.w > 0.0


@pytest.mark.parametrize("period", [0.02, 0.05, 0.1])
def test_a_robot_that_wants_to_drive_but_is_held_fast_tries_another_side(period):
    driver, slot, wall = follower(period, draws=(0.7,)), task(Pose(2.5, 4.3, 0.0)), block(30, 90, 1.0)
    twists = [driver.to_slot(HERE, wall, 1.0, slot) for _ in range(round(6.0 / period))]
    along = twists[round(1.25 / period) : round(1.9 / period)]
    assert all(twist.v > 0.3 and abs(twist.w) < 0.5 for twist in along), "along the obstacle"
    assert min(twist.w for twist in twists[round(1.9 / period) :]) < -1.0


@pytest.mark.parametrize(("period", "ticks"), [(0.02, 5), (0.05, 2), (0.1, 1)])
def test_a_course_around_an_obstacle_is_held_for_a_tenth_of_a_second(period, ticks):
    """Held towards the heading that was chosen, not as a turn rate: it does not overshoot."""
    driver, slot, wall = follower(period), task(Pose(5.0, 0.0, 0.0)), block(-10, 30, 1.0)
    driver.to_slot(HERE, wall, 1.0, slot)
    turned = Pose(0.0, 0.0, -0.3)
    held = [driver.to_slot(turned, OPEN, 1.0, slot).w for _ in range(ticks)]
    assert all(w < 0.0 for w in held[:-1]), "as it was decided"
    assert held[-1] > 0.0, "decided anew: nothing is in the way any more"


@pytest.mark.parametrize("period", [0.02, 0.05, 0.1])
def test_a_robot_beside_a_wall_does_not_turn_to_and_fro(period):
    """It heads for a point that it saw, now behind a wall that it is too near to. Away from the wall is
    too far from the point, which it would turn back to: it faces away first, with any period."""
    driver, pose = follower(period, draws=(0.1,)), Pose(0.0, 0.0, 0.9)
    task = SlotTask(Pose(8.0, -2.0, 0.0), ((3.4, -1.1),), 1.0, True, 1.0)
    for _ in range(round(0.5 / period)):
        driver.to_slot(Pose(0.0, 0.0, -0.3), OPEN, 1.0, task)
    ticks = left = 0
    while left * period < 0.35 and ticks * period < 3.0:
        angles = BEAMS.angles + pose.heading
        wall = np.where((angles > -1.6) & (angles < 0.6), 0.25, np.inf).astype(np.float32)
        twist = driver.to_slot(pose, wall, 0.25, task)
        left = left + 1 if twist.w > 0.0 else 0
        pose = moved(pose, Twist(0.0, twist.w), period)
        ticks += 1
    assert ticks * period < 1.0


@pytest.mark.parametrize("period", [0.02, 0.05, 0.1])
def test_a_robot_that_only_turns_and_never_faces_what_it_turns_to_escapes(period):
    """What it heads for is another thing at every look, or it is held fast: turning is no way out."""
    driver, wall = follower(period, draws=(0.7,)), block(-30, 30, 1.0)
    while not driver.detour.border:
        driver.to_slot(HERE, wall, 1.0, task(Pose(5.0, 0.0, 0.0)))
    beside = task(Pose(0.3, 5.0, 0.0))
    rates = [driver.to_slot(HERE, wall, 1.0, beside).w for _ in range(round(5.0 / period))]
    escape = next(k for k, rate in enumerate(rates) if rate < 0.0) * period
    assert 2.0 < escape < 3.5, "not during a turn that it is right to make"


@pytest.mark.parametrize("period", [0.02, 0.05])
@pytest.mark.parametrize("between", [Pose(0.0, 5.0, 0.0), HERE], ids=["tracking", "in its slot"])
def test_a_course_is_not_taken_up_again_after_something_else(period, between):
    """It was decided for an obstacle and a slot that may be gone for minutes."""
    driver, wall = follower(period), block(-10, 30, 1.0)
    assert driver.to_slot(HERE, wall, 1.0, task(Pose(5.0, 0.0, 0.0))).w < 0.0
    driver.to_slot(HERE, OPEN, math.inf, task(between))
    assert driver.to_slot(HERE, OPEN, 1.0, task(Pose(5.0, 3.0, 0.0))).w > 0.0
