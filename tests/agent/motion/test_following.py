"""A follower's way to its slot: free directions, the leader's trail, mates in the leader's view."""

import math

import numpy as np
import pytest

from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose
from onehop.contracts.sections import GainsSection, RobotSection
from robot_agent.core.motion.follower import Follower
from robot_agent.core.motion.follower_detector import FollowerDetector, painted
from robot_agent.core.motion.pursuit import Pursuit
from robot_agent.core.motion.steering import LOOKAHEAD, Steering
from robot_agent.core.motion.trail import Trail, behind

BODY = RobotSection()
FAN = Beams(BODY)
OPEN = np.full(181, np.inf, np.float32)


def block(first, last, distance):
    """A scan with one thing between two bearings [deg]."""
    scan = OPEN.copy()
    scan[90 + first : 91 + last] = distance
    return scan


def follower():
    return Follower(BODY, GainsSection(), FAN, (0.3, 0.7))


def test_the_free_direction_nearest_to_the_bearing_is_taken():
    steering = Steering(BODY, FAN)
    steering.look(block(-10, 30, 1.0))
    direction, free = steering.choose(0.0, 5.0, 0)
    assert math.degrees(direction) < -10.0
    assert free >= 1.2


@pytest.mark.parametrize(("side", "sign"), [(1, -1), (-1, 1)])
def test_border_following_hugs_the_side_it_chose(side, sign):
    steering = Steering(BODY, FAN)
    steering.look(block(-20, 20, 1.0))
    direction, _ = steering.choose(0.0, 5.0, side)
    assert direction * sign > 1.0


def test_nowhere_to_go_is_none():
    steering = Steering(BODY, FAN)
    steering.look(np.full(181, 0.3, np.float32))
    assert steering.choose(0.0, 5.0, 0) is None


@pytest.mark.parametrize("bearing", [-3.0, -1.0, 0.0, 0.3, 1.5, 2.2])
def test_an_obstacle_blocks_what_is_nearer_than_the_arcsine_of_its_share(bearing):
    steering = Steering(BODY, FAN)
    angles, ranges = FAN.angles[1::3][:60], np.random.default_rng(1).uniform(0.2, 5.0, (200, 60))
    for far in ranges.astype(np.float32):
        steering.look(np.append(np.repeat(far, 3), np.float32(np.inf)))
        half = np.where(far > 0.45, np.arcsin(np.minimum(0.45 / far, 1.0)), math.radians(90.0 + 12.0))
        free = np.where(np.abs(angles - bearing) < half, far - 0.45, LOOKAHEAD).min()
        assert steering.free_distance(bearing) == pytest.approx(min(free, LOOKAHEAD), abs=1e-6)


def test_free_distance_is_never_longer_than_the_disc_can_go():
    steering = Steering(BODY, FAN)
    steering.look(block(-3, 3, 2.0))
    assert steering.free_distance(0.0) == pytest.approx(2.0 - BODY.radius - 0.25, abs=0.01)
    assert steering.free_distance(1.5) == LOOKAHEAD
    assert steering.sees(1.5, 9.0)
    assert not steering.sees(0.0, 3.0)


def test_a_slot_behind_is_turned_to_on_the_spot_unless_reversing_is_asked_for():
    pose, target = Pose(0.0, 0.0, 0.0), Pose(-3.0, 0.0, 0.0)
    twist = follower().step(pose, OPEN, math.inf, target, (), 4.0, True, 1.0)
    assert twist.v == 0.0
    assert twist.w != 0.0
    backing = Follower(BODY, GainsSection(reverse=True), FAN, (0.3,))
    assert backing.step(pose, OPEN, math.inf, target, (), 4.0, True, 1.0).v == pytest.approx(-3.0)


def test_an_obstacle_in_the_way_for_half_a_second_starts_border_following_and_no_flutter():
    driver, pose, target = follower(), Pose(0.0, 0.0, 0.0), Pose(5.0, 0.0, 0.0)
    wall = block(-30, 30, 1.0)
    for tick in range(30):
        assert driver.border or tick < 20
        driver.step(pose, wall, 1.0, target, (), 4.0, True, 1.0)
    assert driver.border
    driver.step(pose, OPEN, math.inf, target, (), 4.0, True, 1.0)
    assert driver.border, "one clear look is not the clear"
    for _ in range(12):
        driver.step(pose, OPEN, math.inf, target, (), 4.0, True, 1.0)
    assert not driver.border


def test_in_its_slot_a_robot_only_turns_to_the_leaders_heading():
    twist = follower().step(
        Pose(0.0, 0.0, 0.0), OPEN, math.inf, Pose(0.05, 0.0, 1.0), (), 4.0, True, 3.0
    )
    assert twist.v == 0.0
    assert twist.w > 0.0


def test_the_newest_point_of_the_trail_in_sight_is_headed_for():
    steering = Steering(BODY, FAN)
    pursuit = Pursuit(steering)
    steering.look(block(40, 90, 1.0))
    trail = ((1.0, 0.0), (3.0, 0.0), (5.0, 0.0), (5.0, 6.0))
    aim = pursuit.aim(Pose(0.0, 0.0, 0.0), trail)
    assert (aim.distance, aim.bearing, aim.last) == (5.0, 0.0, False)


def test_out_of_sight_the_robot_goes_back_the_way_it_came():
    steering = Steering(BODY, FAN)
    pursuit = Pursuit(steering)
    trail = ((3.0, 0.0), (5.0, 0.0))
    steering.look(OPEN)
    assert pursuit.watch(Pose(0.0, 0.0, 0.0), trail)
    steering.look(np.full(181, 0.6, np.float32))
    for y in (1.5, 3.0, 4.5, 6.0, 7.5):
        assert not pursuit.watch(Pose(0.0, y, math.pi / 2), trail)
    aim = pursuit.aim(Pose(0.0, 7.6, math.pi / 2), trail)
    assert abs(aim.bearing) > 3.0, "its own last point lies behind it"
    assert aim.distance < 2.0


def test_a_point_that_slips_out_of_sight_at_a_corner_is_still_headed_for():
    steering = Steering(BODY, FAN)
    pursuit = Pursuit(steering)
    steering.look(OPEN)
    assert pursuit.watch(Pose(0.0, 0.0, 0.0), ((3.0, 0.0), (5.0, 0.0)))
    steering.look(np.full(181, 0.6, np.float32))
    aim = pursuit.aim(Pose(1.5, 0.0, 0.0), ((3.0, 0.0), (5.0, 0.0)))
    assert (aim.distance, aim.known, aim.last) == (3.5, True, True)


def test_a_follower_comes_back_along_the_piece_that_the_leader_drove_twice():
    steering = Steering(BODY, FAN)
    pursuit = Pursuit(steering)
    trail = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (4.0, 8.0))
    steering.look(OPEN)
    assert pursuit.watch(Pose(4.0, 5.0, math.pi / 2), trail)
    steering.look(np.full(181, 0.6, np.float32))
    assert pursuit.aim(Pose(4.0, 8.0, math.pi / 2), trail) is not None
    steering.look(OPEN)
    cut = ((0.0, 0.0), (4.0, 0.0), (0.0, -1.0))
    aim = pursuit.aim(Pose(4.0, 7.9, -math.pi / 2), cut)
    assert aim.known
    assert aim.bearing == pytest.approx(0.0, abs=0.6)
    hidden = np.full(181, np.inf, np.float32)
    hidden[:60] = 1.0
    steering.look(hidden)
    aim = pursuit.aim(Pose(4.0, 7.9, -math.pi / 2), cut)
    assert (aim.distance, aim.bearing) == (pytest.approx(7.9), pytest.approx(0.0)), "around the corner"


def test_a_column_drives_on_the_leaders_way_around_a_corner():
    trail = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0))
    pose = behind(Pose(4.0, 3.0, math.pi / 2), trail, 4.0)
    assert (pose.x, pose.y, pose.heading) == pytest.approx((3.0, 0.0, 0.0))
    before = behind(Pose(4.0, 3.0, math.pi / 2), trail, 9.0)
    assert (before.x, before.y) == pytest.approx((-2.0, 0.0))


def test_a_follower_is_told_from_a_wall_and_from_a_pillar_where_nobody_is():
    lookout = FollowerDetector(BODY, FAN)
    scan = OPEN.copy()
    scan[88:93] = 3.0  # 0.2 m wide: a robot
    scan[20:60] = 3.0  # 2 m wide: a wall
    here = Pose(0.0, 0.0, 0.0)
    assert lookout.beams(here, scan, [(3.2, 0.0)], 1.0) == frozenset(range(88, 93))
    assert lookout.beams(here, scan, [(8.0, 5.0)], 1.0) == frozenset()


def test_a_wall_at_a_grazing_angle_is_no_row_of_followers():
    """Its beams lie far apart, so that each of them stands alone."""
    lookout = FollowerDetector(BODY, FAN)
    scan = OPEN.copy()
    scan[10:19] = 0.6 / np.sin(np.radians(np.arange(10.5, 1.5, -1.0)))
    assert np.abs(np.diff(scan[10:19])).min() > 0.3
    here = Pose(0.0, 0.0, 0.0)
    assert lookout.beams(here, scan, [(2.0, -2.0)], 7.0) == frozenset()


def test_a_follower_beside_a_wall_is_found_where_it_reported_itself():
    lookout = FollowerDetector(BODY, FAN)
    scan = OPEN.copy()
    scan[60:121] = 3.0
    found = lookout.beams(Pose(0.0, 0.0, 0.0), scan, [(3.2, 0.0)], 1.0)
    assert 90 in found
    assert not found & {70, 110}


def test_behind_a_mate_the_wall_goes_on_straight():
    scan = (3.0 / np.cos(FAN.angles.clip(-1.2, 1.2))).astype(np.float32)
    hidden = scan.copy()
    hidden[85:96] = 1.0
    assert painted(hidden, frozenset(range(85, 96))) == pytest.approx(scan, rel=0.01)
    assert painted(hidden, frozenset()) is hidden


@pytest.mark.parametrize("far", [np.inf, 8.0])
def test_a_mate_before_an_opening_does_not_shut_it(far):
    scan = OPEN.copy()
    scan[:88] = 3.0
    scan[96:] = far
    scan[88:96] = 1.0
    assert painted(scan, frozenset(range(88, 96)))[90] == pytest.approx(far)


def drive_trail(*corners):
    """A trail after driving straight from corner to corner."""
    trail, pose = Trail(), Pose(*corners[0], 0.0)
    for x, y in corners[1:]:
        steps = max(1, round(math.dist((pose.x, pose.y), (x, y)) / 0.05))
        heading = math.atan2(y - pose.y, x - pose.x)
        for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
            trail.mark(Pose(pose.x + share * (x - pose.x), pose.y + share * (y - pose.y), heading))
        pose = Pose(x, y, heading)
    return trail, pose


def test_a_leader_that_turns_on_the_spot_does_not_turn_its_formation():
    trail, pose = drive_trail((0.0, 0.0), (10.0, 0.0))
    for heading in (0.0, 1.5, math.pi, -2.0):
        turned = Pose(pose.x, pose.y, heading)
        trail.mark(turned)
        assert trail.course(turned) == pytest.approx(0.0)


def test_a_leader_that_comes_back_pushes_its_column_out_backwards():
    trail, pose = drive_trail((0.0, 0.0), (20.0, 0.0), (8.0, 0.0))
    assert max(x for x, _ in trail.points) < 10.0, "the dead end is forgotten"
    assert trail.course(pose) == pytest.approx(0.0)
    assert behind(pose, trail.points, 3.0).x == pytest.approx(5.0, abs=0.8)


def test_a_leader_that_leaves_its_way_turns_the_formation():
    trail, pose = drive_trail((0.0, 0.0), (20.0, 0.0), (8.0, 0.0), (8.0, 6.0))
    assert trail.course(pose) == pytest.approx(math.pi / 2, abs=0.2)


def test_at_the_start_the_formation_looks_where_the_leader_does():
    assert Trail().course(Pose(1.0, 2.0, 0.7)) == 0.7


def test_what_is_too_near_is_drawn_away_from():
    """Straight along it the safety filter lets nobody drive."""
    steering = Steering(BODY, FAN)
    scan = OPEN.copy()
    scan[:30] = 0.24 / np.cos(np.radians(np.arange(30)))
    steering.look(scan)
    direction, _ = steering.choose(0.0, 5.0, 0)
    assert direction > math.radians(5.0)


def test_a_robot_that_wants_to_drive_but_is_held_fast_tries_another_side():
    driver = Follower(BODY, GainsSection(), FAN, (0.7,))
    pose, target = Pose(0.0, 0.0, 0.0), Pose(2.5, 4.3, 0.0)
    wall = block(30, 90, 1.0)
    twists = [driver.step(pose, wall, 1.0, target, (), 4.0, True, 1.0) for _ in range(120)]
    assert all(twist.v > 0.3 and abs(twist.w) < 0.5 for twist in twists[25:40]), "along the obstacle"
    assert min(twist.w for twist in twists[40:]) < -1.0
