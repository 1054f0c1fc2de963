"""A goal that somebody stands on is reached from beside it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from onehop.contracts.arrays import Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import robot_briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GoalSection, MapSection
from robot_agent.core.motion.occupied_goal import OccupiedGoal

GOAL = GoalSection(20.0, 10.0)
SCENARIO = Scenario("watch", GOAL, MapSection(width=40.0, height=40.0))
BRIEFING = robot_briefing(SCENARIO, 1, 0)
BEAMS = Beams(BRIEFING.body)
SECOND = round(1e9 / BRIEFING.period_ns)


def disc(pose: Pose, x: float, y: float, radius: float = 0.2) -> Ranges:
    """What a laser sees of one disc, and nothing else."""
    dx, dy = x - pose.x, y - pose.y
    along = BEAMS.directions[:, 0] * dx + BEAMS.directions[:, 1] * dy
    off2 = radius * radius - (dx * dx + dy * dy - along * along)
    hit = (off2 >= 0.0) & (along > 0.0)
    ranges = np.where(hit, along - np.sqrt(np.maximum(off2, 0.0)), np.inf)
    return ranges.astype(np.float32)


NOTHING = np.full(len(BEAMS.angles), np.inf, np.float32)


def ticks_until_reached(pose: Pose, scan: Ranges, most: int = 4 * SECOND) -> float:
    """Ticks after which a leader that stands there has arrived; inf for never."""
    watch = OccupiedGoal(BRIEFING, BEAMS)
    return next((n for n in range(1, most) if watch.reached(pose, scan)), math.inf)


@pytest.mark.parametrize("distance", [0.74, 1.0, 1.25])
def test_a_robot_that_stays_on_the_goal_makes_the_place_beside_it_the_goal(distance: float) -> None:
    pose = Pose(20.0 - distance, 10.0, 0.0)
    assert ticks_until_reached(pose, disc(pose, 20.0, 10.0)) == SECOND
    assert ticks_until_reached(pose, NOTHING) == math.inf


def test_who_is_not_beside_the_goal_yet_goes_on() -> None:
    pose = Pose(18.0, 10.0, 0.0)
    assert ticks_until_reached(pose, disc(pose, 20.0, 10.0)) == math.inf


def test_a_robot_that_passes_by_the_goal_does_not_count() -> None:
    pose, watch = Pose(19.0, 10.0, 0.0), OccupiedGoal(BRIEFING, BEAMS)
    for _ in range(10):
        scans = [disc(pose, 20.0, 10.0)] * (SECOND - 1) + [NOTHING]
        assert not any(watch.reached(pose, scan) for scan in scans)


def test_a_wall_as_near_to_the_goal_as_one_may_be_does_not_occupy_it() -> None:
    pose = Pose(19.0, 10.0, 0.0)
    wall = disc(pose, 20.0 + BRIEFING.planner.inflation + 5.0, 10.0, radius=5.0)
    assert np.isfinite(wall).any()
    assert ticks_until_reached(pose, wall) == math.inf


def test_the_time_does_not_depend_on_the_period() -> None:
    briefing = replace(SCENARIO, clock=replace(SCENARIO.clock, period_ms=100))
    watch = OccupiedGoal(robot_briefing(briefing, 1, 0), BEAMS)
    pose = Pose(19.0, 10.0, 0.0)
    scan = disc(pose, 20.0, 10.0)
    assert [watch.reached(pose, scan) for _ in range(10)] == [False] * 9 + [True]
