"""The laser against a brute-force oracle, and where both could be wrong alike."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from onehop.contracts.arrays import FloatArray
from onehop.contracts.sections import MapSection, RobotSection
from onehop.maps.grid import GridFrame, grid_map
from onehop.maps.map_file import load_map
from onehop.maps.polygons import PolygonGround
from onehop.maps.walls import WallMap, segment_distances
from world_server.core.laser import _SLACK, Laser, _direction

BODY = RobotSection()
LOOK = np.array([0], dtype=np.int32)
BEYOND_BLOCK = 15.0 + 2.0 * math.sqrt(2.0)


def bare_map(segments: FloatArray, size: float = 40.0) -> WallMap:
    return WallMap(segments, (0.0, 0.0, size, size), PolygonGround(size, size, ()))


def oracle(segments: FloatArray, discs: FloatArray, pose: FloatArray, body: RobotSection) -> FloatArray:
    """Every beam against everything, in the map frame, (n_beams,) float64 [m]."""
    half = math.radians(body.laser_fov_deg) / 2.0
    angles = pose[2] + np.linspace(-half, half, body.laser_beams)
    ray = np.column_stack((np.cos(angles), np.sin(angles)))
    start, run = segments[:, :2] - pose[:2], segments[:, 2:] - segments[:, :2]
    with np.errstate(all="ignore"):
        turn = ray[:, None, 0] * run[None, :, 1] - ray[:, None, 1] * run[None, :, 0]
        reach = (start[:, 0] * run[:, 1] - start[:, 1] * run[:, 0])[None, :] / turn
        along = (start[None, :, 0] * ray[:, None, 1] - start[None, :, 1] * ray[:, None, 0]) / turn
        reach = np.where((reach >= 0.0) & (along >= 0.0) & (along <= 1.0), reach, math.inf)
    centre = discs - pose[:2]
    ahead = ray @ centre.T
    off = ray[:, None, 0] * centre[None, :, 1] - ray[:, None, 1] * centre[None, :, 0]
    depth = body.radius**2 - off**2
    round_reach = np.where(
        (depth >= 0.0) & (ahead > 0.0), ahead - np.sqrt(np.maximum(depth, 0.0)), math.inf
    )
    everything = np.hstack((reach, round_reach, np.full((len(ray), 1), math.inf)))
    nearest: FloatArray = everything.min(axis=1)
    nearest[nearest > body.laser_range] = math.inf
    return nearest


def undecided(
    segments: FloatArray, discs: FloatArray, pose: FloatArray, body: RobotSection, found: FloatArray
) -> FloatArray:
    """Beams within 1e-7 rad of an edge, or at the limit of the range: either answer holds."""
    half = math.radians(body.laser_fov_deg) / 2.0
    beams = pose[2] + np.linspace(-half, half, body.laser_beams)
    ends = np.vstack((segments[:, :2], segments[:, 2:])) - pose[:2]
    edges = np.arctan2(ends[:, 1], ends[:, 0])
    centre = discs - pose[:2]
    middle = np.arctan2(centre[:, 1], centre[:, 0])
    width = np.arcsin(np.clip(body.radius / np.hypot(centre[:, 0], centre[:, 1]), 0.0, 1.0))
    edges = np.concatenate((edges, middle - width, middle + width))
    apart = np.remainder(beams[:, None] - edges[None, :] + math.pi, math.tau) - math.pi
    close: FloatArray = (np.abs(apart) < 1e-7).any(axis=1) | (np.abs(found - body.laser_range) < 1e-6)
    return close


grid = st.integers(0, 4000).map(lambda number: number / 100.0)
wall = st.tuples(grid, grid, grid, grid).filter(lambda w: (w[0], w[1]) != (w[2], w[3]))


@settings(max_examples=100, deadline=None)
@given(
    walls=st.lists(wall, min_size=1, max_size=30),
    others=st.lists(st.tuples(grid, grid), max_size=5),
    pose=st.tuples(grid, grid, st.floats(-math.pi, math.pi)),
    fov_deg=st.sampled_from([10.0, 180.0, 270.0]),
)
def test_scan_equals_brute_force(
    walls: list[tuple[float, float, float, float]],
    others: list[tuple[float, float]],
    pose: tuple[float, float, float],
    fov_deg: float,
) -> None:
    body = RobotSection(laser_fov_deg=fov_deg)
    segments = np.array(walls)
    assume(segment_distances(np.array([pose[:2]]), segments).min() > 1e-3)
    discs = np.array(
        [other for other in others if math.dist(other, pose[:2]) > 2.0 * body.radius]
    ).reshape(-1, 2)
    poses = np.vstack((np.array([pose]), np.column_stack((discs, np.zeros(len(discs))))))
    scan = Laser(bare_map(segments), body).scans(poses, LOOK)[0]
    expected = oracle(segments, discs, poses[0], body)
    sure = ~undecided(segments, discs, poses[0], body, expected)
    np.testing.assert_allclose(scan[sure], expected[sure], rtol=1e-7, atol=1e-9)


def test_ranges_of_a_straight_wall_are_exact() -> None:
    body = RobotSection(laser_beams=3, laser_fov_deg=90.0)
    walls = bare_map(np.array([[9.0, 0.0, 9.0, 40.0]]))
    scan = Laser(walls, body).scans(np.array([[5.0, 20.0, 0.0]]), LOOK)[0]
    assert scan.tolist() == [np.float32(4.0 * math.sqrt(2.0)), 4.0, np.float32(4.0 * math.sqrt(2.0))]


def test_beams_run_from_right_to_left() -> None:
    walls = bare_map(np.array([[0.0, 17.0, 40.0, 17.0], [0.0, 25.0, 40.0, 25.0]]))
    scan = Laser(walls, BODY).scans(np.array([[20.0, 20.0, 0.0]]), LOOK)[0]
    assert scan.shape == (181,)
    assert scan.dtype == np.float32
    assert scan[0] == 3.0
    assert scan[180] == 5.0
    assert scan[90] == math.inf


def test_no_beam_slips_through_the_corner_of_a_block() -> None:
    """Beams that aim exactly at the joint of two walls, from many places and for many corners."""
    block = MapSection(width=40.0, height=40.0, obstacles=(((18, 18), (22, 18), (22, 22), (18, 22)),))
    walls = load_map(block, {})
    body = RobotSection(laser_beams=3, laser_fov_deg=2.0, laser_range=60.0)
    laser = Laser(walls, body)
    faces = 0
    for step in range(400):
        angle = 0.017 * step
        x, y = 20.0 + 15.0 * math.cos(angle), 20.0 + 15.0 * math.sin(angle)
        for corner in ((18.0, 18.0), (22.0, 18.0), (22.0, 22.0), (18.0, 22.0)):
            pose = np.array([[x, y, math.atan2(corner[1] - y, corner[0] - x)]])
            right, middle, left = laser.scans(pose, LOOK)[0]
            assert middle < math.inf
            if max(right, left) < BEYOND_BLOCK:
                assert middle < BEYOND_BLOCK
                faces += 1
    assert faces > 400


def test_no_beam_leaves_a_closed_room_of_cells() -> None:
    filled = np.zeros((12, 12), dtype=np.bool_)
    filled[::3, ::3] = True
    room = grid_map(filled, GridFrame(0.0, 0.0, 0.3, 0.5))
    body = RobotSection(laser_range=100.0, laser_fov_deg=270.0, laser_beams=271)
    laser = Laser(room, body)
    random = np.random.default_rng(5)
    xmin, ymin, xmax, ymax = room.bounds
    places = random.uniform((xmin, ymin, -math.pi), (xmax, ymax, math.pi), (500, 3))
    for place in places[room.free(places[:, :2])]:
        scan = laser.scans(place[None, :], LOOK)
        assert np.isfinite(scan).all()


def test_a_wall_seen_edge_on_is_hit_at_its_near_end() -> None:
    body = RobotSection(laser_beams=3, laser_fov_deg=2.0)
    laser = Laser(bare_map(np.array([[8.0, 5.0, 6.0, 5.0]])), body)
    assert laser.scans(np.array([[3.0, 5.0, 0.0]]), LOOK)[0, 1] == 3.0


def test_nothing_in_range_is_infinite_and_the_limit_counts() -> None:
    body = RobotSection(laser_beams=3, laser_fov_deg=2.0, laser_range=10.0)
    laser = Laser(bare_map(np.array([[20.0, 0.0, 20.0, 40.0]])), body)
    assert laser.scans(np.array([[10.0, 5.0, 0.0]]), LOOK)[0, 1] == 10.0
    assert laser.scans(np.array([[9.99, 5.0, 0.0]]), LOOK)[0, 1] == math.inf


def test_robots_see_each_other_as_discs_and_not_themselves() -> None:
    laser = Laser(bare_map(np.array([[0.0, 0.0, 40.0, 0.0]])), BODY)
    poses = np.array([[10.0, 20.0, 0.0], [14.0, 20.0, math.pi], [30.0, 20.0, 0.0]])
    scans = laser.scans(poses, np.array([0, 1, 2], dtype=np.int32))
    assert scans[0, 90] == pytest.approx(4.0 - BODY.radius)
    assert scans[1, 90] == pytest.approx(4.0 - BODY.radius)
    assert not np.isfinite(scans[2]).any()
    width = math.degrees(2.0 * math.asin(BODY.radius / 4.0))
    assert np.isfinite(scans[0]).sum() == math.floor(width / 2.0) * 2 + 1


def test_only_those_who_look_get_a_scan() -> None:
    laser = Laser(bare_map(np.array([[0.0, 0.0, 40.0, 0.0]])), BODY)
    poses = np.array([[10.0, 20.0, 0.0], [14.0, 20.0, math.pi]])
    assert laser.scans(poses, np.array([1], dtype=np.int32)).shape == (1, 181)
    assert laser.scans(poses, np.array([], dtype=np.int32)).shape == (0, 181)


def test_the_cheap_angle_is_as_good_as_it_claims() -> None:
    for step in range(100_000):
        angle = math.tau * (step / 100_000 - 0.5)
        wrong = _direction(math.cos(angle), math.sin(angle)) - angle
        assert abs(math.remainder(wrong, math.tau)) < _SLACK - 1e-6
