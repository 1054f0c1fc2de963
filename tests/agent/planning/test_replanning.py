"""When it is time to look and plan anew: in seconds, metres and radians, whatever the period."""

import math

import numpy as np
import pytest

from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose
from onehop.contracts.sections import RobotSection
from robot_agent.core.planning.path_tracking import PathTracker
from robot_agent.core.planning.replanning import Replanning

BODY = RobotSection()
BEAMS = Beams(BODY)
ORIGIN = Pose(0.0, 0.0, 0.0)
CLEAR = np.full(BODY.laser_beams, np.inf, dtype=np.float32)
PERIODS_MS = pytest.mark.parametrize("period_ms", [20, 50, 100])


def pair(period_ms: int) -> tuple[Replanning, PathTracker]:
    """Planned at the origin: a way of 5 m straight ahead."""
    tracker = PathTracker(BODY, BEAMS, period_ms * 1_000_000, 0.5, ORIGIN)
    replanning = Replanning(0.5, period_ms * 1_000_000)
    assert replanning.due(ORIGIN, tracker)
    replanning.begin(ORIGIN, tracker)
    tracker.follow(np.array(((0.0, 0.0), (5.0, 0.0))))
    return replanning, tracker


def ticks_until_due(replanning: Replanning, tracker: PathTracker, scan: np.ndarray) -> int:
    """Ticks that the robot stands before it plans anew."""
    for tick in range(10_000):
        if replanning.due(ORIGIN, tracker):
            return tick
        tracker.drive(ORIGIN, scan)
    raise AssertionError("never due")


@PERIODS_MS
def test_a_blocked_robot_plans_anew_after_a_fifth_of_a_second(period_ms: int) -> None:
    scan = CLEAR.copy()
    scan[90] = 0.5
    assert ticks_until_due(*pair(period_ms), scan) * period_ms == 200


@PERIODS_MS
def test_a_robot_that_is_made_to_wait_plans_anew_after_eight_seconds(period_ms: int) -> None:
    assert ticks_until_due(*pair(period_ms), CLEAR) * period_ms == 8000


@pytest.mark.parametrize(
    ("pose", "due"),
    [
        (Pose(1.4, 0.0, 0.0), False),
        (Pose(1.5, 0.0, 0.0), True),
        (Pose(0.0, 0.0, 0.78), False),
        (Pose(0.0, 0.0, 0.79), True),
    ],
)
def test_a_piece_driven_or_turned_is_time_to_plan_anew(pose: Pose, due: bool) -> None:
    replanning, tracker = pair(50)
    assert replanning.due(pose, tracker) is due


def test_the_end_of_a_way_or_of_a_turn_is_time_to_plan_anew() -> None:
    replanning, tracker = pair(50)
    tracker.follow(np.array(((0.0, 0.0), (1.0, 0.0))))
    assert not replanning.due(Pose(0.8, 0.0, 0.0), tracker)
    assert replanning.due(Pose(0.95, 0.0, 0.0), tracker)
    tracker.face(0.5)
    assert not replanning.due(Pose(0.0, 0.0, 0.3), tracker)
    assert replanning.due(Pose(0.0, 0.0, 0.45), tracker)


def test_planning_moments_in_a_row_without_a_move_are_counted() -> None:
    replanning, tracker = pair(50)
    scan = CLEAR.copy()
    scan[90] = 0.5
    for count in (1, 2):
        ticks_until_due(replanning, tracker, scan)
        assert replanning.begin(ORIGIN, tracker) == 0.0
        assert replanning.stuck == count
        tracker.follow(np.array(((0.0, 0.0), (5.0, 0.0))))
    away = Pose(math.pi, 0.0, 0.0)
    assert replanning.begin(away, tracker) == math.pi
    assert replanning.stuck == 0
