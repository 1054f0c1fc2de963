"""Free directions of one scan: VFH+ without a grid."""

import math

import numpy as np
import pytest

from onehop.contracts.beams import Beams
from onehop.contracts.sections import RobotSection
from robot_agent.core.motion.free_directions import CLEARANCES, LOOKAHEAD, FreeDirections
from tests.agent.motion.scans import BEAMS, BODY, OPEN, block, walls


def seen(scan):
    """The free directions of a scan."""
    free = FreeDirections(BODY, BEAMS)
    free.look(scan)
    return free


def test_the_free_direction_nearest_to_the_bearing_is_taken():
    direction, free = seen(block(-10, 30, 1.0)).choose(0.0, 5.0)
    assert math.degrees(direction) < -10.0
    assert free >= 1.2


@pytest.mark.parametrize(("side", "sign"), [(1, -1), (-1, 1)])
def test_border_following_hugs_the_side_it_chose(side, sign):
    direction, _ = seen(block(-20, 20, 1.0)).choose(0.0, 5.0, side)
    assert direction * sign > 1.0


def test_nowhere_to_go_is_none():
    assert seen(walls(0.3)).choose(0.0, 5.0) is None


def test_free_distance_is_never_longer_than_the_disc_can_go():
    free = seen(block(-3, 3, 2.0))
    assert free.free_distance(0.0) == pytest.approx(2.0 - BODY.radius - 0.25, abs=0.01)
    assert free.free_distance(1.5) == LOOKAHEAD
    assert free.sees(1.5, 9.0)
    assert not free.sees(0.0, 3.0)


def test_what_is_too_near_is_drawn_away_from():
    """Straight along it the safety filter lets nobody drive."""
    scan = OPEN.copy()
    scan[:30] = 0.24 / np.cos(np.radians(np.arange(30)))
    direction, _ = seen(scan).choose(0.0, 5.0)
    assert direction > math.radians(5.0)


@pytest.mark.parametrize("count", [90, 181, 361, 721])
@pytest.mark.parametrize("distance", [0.5, 1.0, 2.0])
def test_a_post_blocks_the_directions_within_the_arc_sine_of_radius_over_range(count, distance):
    """Whatever the laser's resolution, to within one bundle and one candidate."""
    body = RobotSection(laser_beams=count)
    beams = Beams(body)
    free = FreeDirections(body, beams)
    post = np.abs(beams.angles) <= math.radians(2.1)
    free.look(np.where(post, distance, np.inf).astype(np.float32))
    width = math.asin((BODY.radius + CLEARANCES[0]) / distance)
    for bearing in np.arange(-1.5, 1.5, 0.01):
        apart = abs(bearing)
        if apart < width:
            assert free.free_distance(bearing) == pytest.approx(distance - BODY.radius - CLEARANCES[0])
        elif apart > width + math.radians(4.0):
            assert free.free_distance(bearing) == LOOKAHEAD


@pytest.mark.parametrize("count", [90, 181, 361, 721])
def test_a_gap_is_as_wide_as_it_is_to_within_half_a_bundle_at_any_resolution(count):
    body = RobotSection(laser_beams=count)
    beams = Beams(body)
    free = FreeDirections(body, beams)
    half = math.asin((BODY.radius + CLEARANCES[0]) / 1.5) + math.radians(1.51)
    for degrees in range(-40, 41):
        middle = math.radians(degrees)
        gap = np.abs(beams.angles - middle) < half
        free.look(np.where(gap, np.inf, 1.5).astype(np.float32))
        assert free.free_distance(middle) == LOOKAHEAD, degrees


@pytest.mark.parametrize("count", [2, 10, 181])
@pytest.mark.parametrize("fov_deg", [1.0, 2.0])
def test_a_view_narrower_than_a_bundle_is_one_bundle(count, fov_deg):
    body = RobotSection(laser_beams=count, laser_fov_deg=fov_deg)
    free = FreeDirections(body, Beams(body))
    ranges = np.full(count, np.inf, dtype=np.float32)
    ranges[-1] = 1.0
    free.look(ranges)
    assert free.free_distance(0.0) == pytest.approx(1.0 - BODY.radius - CLEARANCES[0])
