"""Which point of the leader's trail a follower heads for, and how it gets back to it."""

import math

import numpy as np
import pytest

from onehop.contracts.geometry import Pose
from robot_agent.core.motion.free_directions import FreeDirections
from robot_agent.core.motion.trail_pursuit import TrailPursuit
from tests.agent.motion.scans import BEAMS, BODY, HERE, OPEN, PERIOD, block, walls


def test_the_newest_point_of_the_trail_in_sight_is_headed_for():
    free = FreeDirections(BODY, BEAMS)
    pursuit = TrailPursuit(free, PERIOD)
    free.look(block(40, 90, 1.0))
    trail = ((1.0, 0.0), (3.0, 0.0), (5.0, 0.0), (5.0, 6.0))
    point = pursuit.point(HERE, trail, 2)
    assert (point.distance, point.bearing, point.newest) == (5.0, 0.0, False)


def test_out_of_sight_the_robot_goes_back_the_way_it_came():
    free = FreeDirections(BODY, BEAMS)
    pursuit = TrailPursuit(free, PERIOD)
    trail = ((3.0, 0.0), (5.0, 0.0))
    free.look(OPEN)
    assert pursuit.watch(HERE, trail)
    free.look(walls(0.6))
    for y in (1.5, 3.0, 4.5, 6.0, 7.5):
        assert not pursuit.watch(Pose(0.0, y, math.pi / 2), trail)
    point = pursuit.point(Pose(0.0, 8.3, math.pi / 2), trail, 2)
    assert abs(point.bearing) > 3.0, "its own last point lies behind it"
    assert point.distance == pytest.approx(0.8)
    point = pursuit.point(Pose(0.0, 7.6, math.pi / 2), trail, 2)
    assert point.distance == pytest.approx(1.6), "not the one that it stands on"
    assert not pursuit.watch(HERE, trail)
    assert pursuit.point(HERE, trail, 2).newest, "back where the trail was in sight"


def test_a_point_that_slips_out_of_sight_at_a_corner_is_still_headed_for():
    free = FreeDirections(BODY, BEAMS)
    pursuit = TrailPursuit(free, PERIOD)
    free.look(OPEN)
    assert pursuit.watch(HERE, ((3.0, 0.0), (5.0, 0.0)))
    free.look(walls(0.6))
    point = pursuit.point(Pose(1.5, 0.0, 0.0), ((3.0, 0.0), (5.0, 0.0)), 2)
    assert (point.distance, point.known, point.newest) == (3.5, True, True)


def test_a_follower_comes_back_along_the_piece_that_the_leader_drove_twice():
    free = FreeDirections(BODY, BEAMS)
    pursuit = TrailPursuit(free, PERIOD)
    trail = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (4.0, 8.0))
    free.look(OPEN)
    assert pursuit.watch(Pose(4.0, 5.0, math.pi / 2), trail)
    free.look(walls(0.6))
    assert pursuit.point(Pose(4.0, 8.0, math.pi / 2), trail, 2) is not None
    free.look(OPEN)
    cut = ((0.0, 0.0), (4.0, 0.0), (0.0, -1.0))
    point = pursuit.point(Pose(4.0, 7.9, -math.pi / 2), cut, 2)
    assert point.known
    assert point.bearing == pytest.approx(0.0, abs=0.6)
    hidden = np.full(181, np.inf, np.float32)
    hidden[:60] = 1.0
    free.look(hidden)
    point = pursuit.point(Pose(4.0, 7.9, -math.pi / 2), cut, 2)
    assert (point.distance, point.bearing) == (pytest.approx(7.9), pytest.approx(0.0)), (
        "around the corner"
    )


@pytest.mark.parametrize("period", [0.02, 0.05, 0.1])
def test_a_point_out_of_sight_is_headed_for_for_six_seconds_before_the_robot_goes_back(period):
    free = FreeDirections(BODY, BEAMS)
    pursuit = TrailPursuit(free, period)
    trail = ((3.0, 0.0), (5.0, 0.0))
    free.look(OPEN)
    assert pursuit.watch(HERE, trail)
    free.look(walls(0.6))
    here = Pose(0.0, 2.0, math.pi / 2)
    assert not pursuit.watch(here, trail), "a breadcrumb"
    asked = 1
    while pursuit.point(here, trail, 1).newest:
        asked += 1
    assert asked * period == pytest.approx(6.0, abs=1.1 * period)
