"""Pure pursuit along a way, and the shield against what the laser sees late."""

import math

import numpy as np
import pytest

from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose
from onehop.contracts.sections import RobotSection
from robot_agent.core.planning.path_tracking import PathTracker
from tests.agent.planning.test_pathfinders import moved

BODY = RobotSection()
BEAMS = Beams(BODY)
CLEAR = np.full(BODY.laser_beams, np.inf, dtype=np.float32)
PERIOD_NS = 50_000_000
ORIGIN = Pose(0.0, 0.0, 0.0)


def tracker(*way: tuple[float, float]) -> PathTracker:
    made = PathTracker(BODY, BEAMS, PERIOD_NS, 0.5, ORIGIN)
    made.follow(np.array(way))
    return made


def test_a_way_with_corners_is_driven_at_constant_speed_and_kept_to() -> None:
    ends = [(0.0, 0.0), (6.0, 0.0), (10.0, 3.0), (16.0, 3.0)]
    on_way, pose, far = tracker(*ends), np.array((0.0, 0.0, 0.0)), 0.0
    for _ in range(300):
        twist = on_way.drive(Pose(*map(float, pose)), CLEAR)
        assert twist.v == pytest.approx(BODY.leader_speed)
        pose = moved(pose, twist)
        far = max(far, abs(pose[1] - np.interp(pose[0], *zip(*ends, strict=True))))
    assert pose[0] > 14.0
    assert far < 0.2


def test_way_ends_at_its_last_point() -> None:
    on_way, pose = tracker((0.0, 0.0), (2.0, 0.0)), np.array((0.0, 0.0, 0.0))
    for _ in range(80):
        pose = moved(pose, on_way.drive(Pose(*map(float, pose)), CLEAR))
    assert math.dist(pose[:2], (2.0, 0.0)) < 0.01


def test_a_way_behind_is_turned_to_on_the_spot_without_changing_sides() -> None:
    on_way = tracker((0.0, 0.0), (-5.0, 0.01))
    rates = [on_way.drive(Pose(0.0, 0.0, heading), CLEAR).w for heading in (0.0, -0.02, 0.02)]
    assert all(on_way.drive(Pose(0.0, 0.0, 0.0), CLEAR).v == 0.0 for _ in range(3))
    assert min(rates) > 0.0 or max(rates) < 0.0


@pytest.mark.parametrize("bearing", [0.0, 0.5, -0.5])
def test_shield_drives_into_nothing_that_the_laser_sees(bearing: float) -> None:
    """A post 0.05 m from the hull on the way: never straight on."""
    on_way, scan = tracker((0.0, 0.0), (5.0, 0.0)), CLEAR.copy()
    beam = int(np.argmin(np.abs(BEAMS.angles - bearing)))
    scan[beam] = BODY.radius + 0.05
    twist = on_way.drive(Pose(0.0, 0.0, 0.0), scan)
    assert twist.v == 0.0
    assert on_way.blocked_ns == PERIOD_NS


def test_a_way_that_turns_off_before_an_obstacle_is_turned_to() -> None:
    """Sliding along the obstacle would turn the other way, and back at the next tick."""
    on_way, scan = tracker((0.0, 0.0), (0.3, 0.6)), CLEAR.copy()
    scan[int(np.argmin(np.abs(BEAMS.angles - 0.35)))] = BODY.radius + 0.2
    twist = on_way.drive(Pose(0.0, 0.0, 0.0), scan)
    assert twist.v == 0.0
    assert twist.w > 0.0
