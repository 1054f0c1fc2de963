"""Unicycle arcs, and contacts that stop a robot at its last free place."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from onehop.contracts.arrays import FloatArray
from onehop.contracts.sections import MapSection, RobotSection
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from world_server.core.motion import NOBODY, WALL, Motion

BODY = RobotSection()
PERIOD_NS = 50_000_000
PERIOD = 0.05
YARD = load_map(MapSection(width=40.0, height=40.0), {})
BLOCK = load_map(
    MapSection(width=40.0, height=40.0, obstacles=(((20, 10), (21, 10), (21, 30), (20, 30)),)), {}
)


def drive(
    walls: WallMap, poses: list[tuple[float, float, float]], twists: list[tuple[float, float]],
    period_ns: int = PERIOD_NS, body: RobotSection = BODY,
) -> tuple[FloatArray, FloatArray, list[int]]:  # fmt: skip
    """Poses, twists and contacts after one period."""
    after, driven = np.array(poses, dtype=np.float64), np.array(twists, dtype=np.float64)
    touched = Motion(walls, [body] * len(poses), period_ns).advance(after, driven)
    return after, driven, touched.tolist()


@pytest.mark.parametrize("w", [3.0, -3.0, 0.5, 1e-3, 1e-6, 1e-9, 1e-12, 0.0])
def test_arc_solves_the_unicycle_equations_for_every_turn_rate(w: float) -> None:
    """Thesis eq. 3.3, integrated by Simpson's rule on 2000 steps: smooth through w = 0."""
    v, heading = 2.0, 0.7
    time = np.linspace(0.0, PERIOD, 2001)
    weights = np.full(2001, 2.0)
    weights[1::2], weights[0], weights[-1] = 4.0, 1.0, 1.0
    step = PERIOD / 2000 / 3.0
    x = 20.0 + v * step * (weights @ np.cos(heading + w * time))
    y = 20.0 + v * step * (weights @ np.sin(heading + w * time))
    after, _, touched = drive(YARD, [(20.0, 20.0, heading)], [(v, w)])
    assert after[0] == pytest.approx([x, y, heading + w * PERIOD], abs=1e-12)
    assert touched == [NOBODY]


def test_a_full_circle_comes_back() -> None:
    poses, twists = np.array([[20.0, 20.0, 0.0]]), np.array([[1.0, 1.0]])
    motion = Motion(YARD, [BODY], round(math.tau / 100 * 1e9))
    for _ in range(100):
        motion.advance(poses, twists)
    assert poses[0, :2] == pytest.approx([20.0, 20.0], abs=1e-6)


def test_heading_stays_in_half_open_turn() -> None:
    after, _, _ = drive(YARD, [(20.0, 20.0, 3.1), (30.0, 20.0, -3.1)], [(0.0, 3.0), (0.0, -3.0)])
    assert after[0, 2] == pytest.approx(3.25 - math.tau)
    assert after[1, 2] == pytest.approx(math.tau - 3.25)


@pytest.mark.parametrize("speed", [0.1, 3.0, -3.0])
def test_a_wall_stops_a_robot_at_its_last_free_place(speed: float) -> None:
    heading = 0.0 if speed > 0 else math.pi
    after, driven, touched = drive(BLOCK, [(19.799, 20.0, heading)], [(speed, 0.0)])
    assert touched == [WALL]
    assert after[0, 0] == pytest.approx(19.8, abs=1e-8)
    assert driven[0].tolist() == [0.0, 0.0]


def test_no_robot_goes_through_a_thin_wall() -> None:
    """3 m/s for a second in one period: 3 m of drive against a wall without thickness."""
    thin = WallMap(np.array([[20.0, 10.0, 20.0, 30.0]]), YARD.bounds, YARD.ground)
    after, _, touched = drive(thin, [(18.0, 20.0, 0.0)], [(3.0, 0.0)], period_ns=10**9)
    assert touched == [WALL]
    assert after[0, 0] == pytest.approx(19.8, abs=1e-8)


def test_a_stopped_robot_turns_and_drives_away() -> None:
    poses, twists = np.array([[19.79, 20.0, 0.0]]), np.array([[3.0, 3.0]])
    motion = Motion(BLOCK, [BODY], PERIOD_NS)
    touched = motion.advance(poses, twists)
    assert touched.tolist() == [WALL]
    assert poses[0, 2] == pytest.approx(0.15)
    poses[0, 2], twists[0] = math.pi, (3.0, 0.0)
    touched = motion.advance(poses, twists)
    assert touched.tolist() == [NOBODY]
    assert poses[0, 0] == pytest.approx(19.65, abs=1e-6)


def test_a_robot_slides_along_a_wall_it_only_touches() -> None:
    after, _, touched = drive(BLOCK, [(19.8, 20.0, math.pi / 2)], [(3.0, 0.0)])
    assert touched == [NOBODY]
    assert after[0, 1] == pytest.approx(20.15)


def test_two_robots_that_meet_stop_in_the_middle() -> None:
    after, driven, touched = drive(YARD, [(19.75, 20.0, 0.0), (20.25, 20.0, math.pi)], [(3.0, 0.0)] * 2)
    assert touched == [1, 0]
    assert after[:, 0] == pytest.approx([19.8, 20.2], abs=1e-8)
    assert (driven == 0.0).all()


def test_only_the_robot_that_drives_into_another_is_stopped() -> None:
    poses = [(20.0, 20.0, 0.0), (20.41, 20.0, 0.0)]
    after, driven, touched = drive(YARD, poses, [(3.0, 0.0), (1.0, 0.0)])
    assert touched == [1, NOBODY]
    assert driven[1, 0] == 1.0
    assert after[1, 0] == pytest.approx(20.46)
    assert after[0, 0] == pytest.approx(20.015, abs=1e-6)


def test_a_standing_robot_is_an_obstacle() -> None:
    after, _, touched = drive(YARD, [(20.0, 20.0, 0.0), (20.45, 20.0, 1.0)], [(3.0, 0.0), (0.0, 0.0)])
    assert touched == [1, NOBODY]
    assert after[0, 0] == pytest.approx(20.05, abs=1e-8)
    assert after[1].tolist() == [20.45, 20.0, 1.0]


def test_a_robot_behind_a_stopped_one_stops_too() -> None:
    poses = [(19.79, 20.0, 0.0), (19.37, 20.0, 0.0), (18.95, 20.0, 0.0)]
    after, _, touched = drive(BLOCK, poses, [(3.0, 0.0)] * 3)
    assert touched == [WALL, 0, 1]
    assert after[:, 0] == pytest.approx([19.8, 19.4, 19.0], abs=1e-7)


spot = st.floats(0.3, 5.7)
crowd = st.lists(
    st.tuples(spot, spot, st.floats(-math.pi, math.pi), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
    min_size=1,
    max_size=8,
)
PEN = load_map(
    MapSection(width=6.0, height=6.0, obstacles=(((2.8, 2.8), (3.2, 2.8), (3.2, 3.2), (2.8, 3.2)),)), {}
)


def admissible(members: list[tuple[float, float, float, float, float]]) -> FloatArray:
    """Those of a random crowd who neither overlap each other nor a wall, (n, 5); somebody always is."""
    chosen: list[tuple[float, float, float, float, float]] = []
    for one in members:
        apart = all(math.dist(one[:2], other[:2]) >= 2.0 * BODY.radius for other in chosen)
        if apart and PEN.is_free(one[0], one[1], BODY.radius):
            chosen.append(one)
    assume(chosen)
    return np.array(chosen).reshape(-1, 5)


@settings(max_examples=60, deadline=None)
@given(crowd)
def test_nobody_ever_overlaps_anything(members: list[tuple[float, float, float, float, float]]) -> None:
    state = admissible(members)
    poses = np.ascontiguousarray(state[:, :3])
    motion = Motion(PEN, [BODY] * len(state), PERIOD_NS)
    for _ in range(40):
        motion.advance(poses, np.ascontiguousarray(state[:, 3:]))
        assert (PEN.clearance(poses[:, :2]) >= BODY.radius - 2e-9).all()
        gaps = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).transpose(2, 0, 1))
        assert gaps[np.triu_indices(len(poses), 1)].min(initial=math.inf) >= 2.0 * BODY.radius - 2e-9


@settings(max_examples=60, deadline=None)
@given(crowd, st.randoms(use_true_random=False))
def test_the_order_of_the_robots_does_not_matter(
    members: list[tuple[float, float, float, float, float]], random: "st.DrawFn"
) -> None:
    state = admissible(members)
    order = list(range(len(state)))
    random.shuffle(order)  # type: ignore[attr-defined]
    poses, twists = np.ascontiguousarray(state[:, :3]), np.ascontiguousarray(state[:, 3:])
    mixed, mixed_twists = poses[order].copy(), twists[order].copy()
    motion = Motion(PEN, [BODY] * len(state), PERIOD_NS)
    for _ in range(20):
        motion.advance(poses, twists)
        motion.advance(mixed, mixed_twists)
        twists[:], mixed_twists[:] = state[:, 3:], state[order, 3:]
        np.testing.assert_array_equal(poses[order], mixed)


radius = st.floats(0.05, 0.5)


@settings(max_examples=60, deadline=None)
@given(crowd, st.lists(radius, min_size=8, max_size=8))
def test_bodies_of_different_size_never_overlap_anything(
    members: list[tuple[float, float, float, float, float]], sizes: list[float]
) -> None:
    chosen: list[tuple[tuple[float, float, float, float, float], float]] = []
    for one, size in zip(members, sizes, strict=False):
        apart = all(math.dist(one[:2], other[:2]) >= size + its for other, its in chosen)
        if apart and PEN.is_free(one[0], one[1], size):
            chosen.append((one, size))
    state = np.array([one for one, _ in chosen]).reshape(-1, 5)
    radii = np.array([size for _, size in chosen])
    poses = np.ascontiguousarray(state[:, :3])
    motion = Motion(PEN, [RobotSection(radius=size) for size in radii] or [BODY], PERIOD_NS)
    for _ in range(40):
        motion.advance(poses, np.ascontiguousarray(state[:, 3:]))
        assert (PEN.clearance(poses[:, :2]) >= radii - 2e-9).all()
        gaps = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).transpose(2, 0, 1))
        gaps -= radii[:, None] + radii[None, :]
        assert gaps[np.triu_indices(len(poses), 1)].min(initial=math.inf) >= -2e-9
