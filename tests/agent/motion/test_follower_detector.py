"""Followers in a leader's scan: found where they can be, and removed from what the planner sees."""

import numpy as np
import pytest

from robot_agent.core.motion.follower_detector import FollowerDetector, without_followers
from tests.agent.motion.scans import BEAMS, BODY, HERE, OPEN


def found(scan, place, reach):
    """Beams that hit a follower that can be within `reach` of a place."""
    return FollowerDetector(BODY, BEAMS).beams(HERE, scan, [place], reach).tolist()


def test_a_follower_is_told_from_a_wall_and_from_a_pillar_where_nobody_is():
    scan = OPEN.copy()
    scan[88:93] = 3.0  # 0.2 m wide: a robot
    scan[20:60] = 3.0  # 2 m wide: a wall
    assert found(scan, (3.2, 0.0), 1.0) == [*range(88, 93)]
    assert found(scan, (8.0, 5.0), 1.0) == []


def test_a_wall_at_a_grazing_angle_is_no_row_of_followers():
    """Its beams lie far apart, so that each of them stands alone."""
    scan = OPEN.copy()
    scan[10:19] = 0.6 / np.sin(np.radians(np.arange(10.5, 1.5, -1.0)))
    assert np.abs(np.diff(scan[10:19])).min() > 0.3
    assert found(scan, (2.0, -2.0), 7.0) == []


def test_a_follower_beside_a_wall_is_found_where_it_reported_itself():
    scan = OPEN.copy()
    scan[60:121] = 3.0
    beams = found(scan, (3.2, 0.0), 1.0)
    assert 90 in beams
    assert 70 not in beams
    assert 110 not in beams


def test_behind_a_follower_the_wall_goes_on_straight():
    scan = (3.0 / np.cos(BEAMS.angles.clip(-1.2, 1.2))).astype(np.float32)
    hidden = scan.copy()
    hidden[85:96] = 1.0
    assert without_followers(hidden, np.arange(85, 96)) == pytest.approx(scan, rel=0.01)
    assert without_followers(hidden, np.arange(0)) is hidden


@pytest.mark.parametrize("far", [np.inf, 8.0])
def test_a_follower_before_a_gap_does_not_shut_it(far):
    scan = OPEN.copy()
    scan[:88] = 3.0
    scan[96:] = far
    scan[88:96] = 1.0
    assert without_followers(scan, np.arange(88, 96))[90] == pytest.approx(far)
