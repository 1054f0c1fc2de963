"""Random and given start poses, and starts and goals that are refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.errors import ScenarioError
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    GoalSection,
    MapSection,
    PlannerSection,
    StartSection,
    TeamSection,
)
from onehop.maps.grid import GridFrame, grid_map
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from world_server.core.placement import start_poses

WALL = ((20.0, 0.0), (20.5, 0.0), (20.5, 36.0), (20.0, 36.0))
YARD = MapSection(width=40.0, height=40.0, obstacles=(WALL,))
WALLS = load_map(YARD, {})
PLAN = Scenario(name="yard", goal=GoalSection(35.0, 35.0), map=YARD, start=StartSection(10.0, 10.0))


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32), x=st.floats(1.0, 19.0), y=st.floats(1.0, 35.0))
def test_random_robots_are_apart_clear_and_in_one_room(seed: int, x: float, y: float) -> None:
    poses = start_poses(replace(PLAN, seed=seed, start=StartSection(x, y)), WALLS)
    assert poses.shape == (6, 3)
    assert (WALLS.clearance(poses[:, :2]) >= 0.5).all()
    gaps = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).transpose(2, 0, 1))
    assert gaps[np.triu_indices(6, 1)].min() >= 1.2
    assert (poses[:, 0] < 20.0).all()
    assert (np.abs(poses[:, 2]) <= math.pi).all()


def test_a_team_of_six_starts_within_eight_metres_of_each_other() -> None:
    for seed in range(50):
        poses = start_poses(replace(PLAN, seed=seed), WALLS)
        gaps = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).transpose(2, 0, 1))
        assert gaps.max() < 8.0


def test_a_large_team_finds_room() -> None:
    poses = start_poses(replace(PLAN, team=TeamSection(size=50)), WALLS)
    assert len(poses) == 50
    assert np.hypot(poses[:, 0] - 10.0, poses[:, 1] - 10.0).max() < 15.0


def test_the_seed_alone_fixes_the_start() -> None:
    np.testing.assert_array_equal(start_poses(PLAN, WALLS), start_poses(PLAN, WALLS))
    assert (start_poses(PLAN, WALLS) != start_poses(replace(PLAN, seed=2), WALLS)).any()


def test_headings_point_everywhere() -> None:
    poses = [start_poses(replace(PLAN, seed=seed), WALLS) for seed in range(60)]
    headings = np.concatenate(poses)[:, 2]
    assert np.histogram(headings, bins=6, range=(-math.pi, math.pi))[0].min() > 30


def test_a_given_radius_is_kept() -> None:
    poses = start_poses(replace(PLAN, start=StartSection(10.0, 10.0, radius=8.0)), WALLS)
    assert 4.0 < np.hypot(poses[:, 0] - 10.0, poses[:, 1] - 10.0).max() <= 8.0


def test_places_are_spread_evenly_over_the_disc() -> None:
    """The mean distance of points in a disc of radius r from its centre is 2 r / 3."""
    field = load_map(MapSection(width=60.0, height=60.0), {})
    wide = replace(PLAN, start=StartSection(30.0, 30.0, radius=25.0))
    poses = np.concatenate([start_poses(replace(wide, seed=seed), field) for seed in range(100)])
    assert np.hypot(poses[:, 0] - 30.0, poses[:, 1] - 30.0).mean() == pytest.approx(50.0 / 3.0, abs=0.8)


def test_given_poses_are_in_degrees_and_in_order_of_id() -> None:
    start = StartSection(poses=((3.0, 4.0, 90.0), (5.0, 6.0, -180.0), (7.0, 8.0, 370.0)))
    poses = start_poses(replace(PLAN, start=start, team=TeamSection(size=3)), WALLS)
    expected = [[3.0, 4.0, math.pi / 2], [5.0, 6.0, math.pi], [7.0, 8.0, math.radians(10.0)]]
    np.testing.assert_allclose(poses, expected)


@pytest.mark.parametrize(
    ("change", "where", "remedy"),
    [
        ({"start": StartSection(20.2, 20.0)}, "start.x, start.y", "nearest free point"),
        ({"start": StartSection(19.7, 20.0)}, "start.x, start.y", "(19."),
        ({"start": StartSection(-3.0, 20.0)}, "start.x, start.y", "nearest free point is (0.5"),
        (
            {"start": StartSection(-3.0, 20.0)},
            "start.x, start.y",
            "x from 0.00 to 40.00 and y from 0.00",
        ),
        ({"goal": GoalSection(35.0, 1e7)}, "goal.x, goal.y", "nearest free point is (35.0, 39.5)"),
        ({"goal": GoalSection(20.2, 20.0)}, "goal.x, goal.y", "nearest free point"),
        ({"start": StartSection(10.0, 10.0, radius=1.0)}, "start.radius", "fewer robots"),
        (
            {
                "start": StartSection(poses=((3.0, 4.0, 0.0), (0.3, 4.0, 0.0))),
                "team": TeamSection(size=2),
            },
            "start.poses[1]",
            "nearest free point",
        ),
        (
            {
                "start": StartSection(poses=((3.0, 4.0, 0.0), (3.3, 4.0, 0.0))),
                "team": TeamSection(size=2),
            },
            "start.poses[1]",
            "the radii of both",
        ),
    ],
)
def test_an_impossible_start_or_goal_is_refused_with_a_remedy(
    change: dict[str, object], where: str, remedy: str
) -> None:
    with pytest.raises(ScenarioError) as refusal:
        start_poses(replace(PLAN, **change), WALLS)  # type: ignore[arg-type]
    assert refusal.value.where == where
    assert remedy in refusal.value.remedy
    assert "\n" not in str(refusal.value)


def test_the_suggested_point_is_accepted() -> None:
    near = WALLS.nearest_free(20.2, 20.0, 0.5)
    assert near is not None
    start_poses(replace(PLAN, goal=GoalSection(*near)), WALLS)


def test_a_map_too_narrow_for_any_robot_is_refused() -> None:
    tight = load_map(MapSection(width=0.8, height=40.0), {})
    with pytest.raises(ScenarioError, match=r"found no place that is 0.5 m clear: make planner"):
        start_poses(replace(PLAN, goal=GoalSection(0.4, 3.0)), tight)


def grid_of(rows: list[str], frame: GridFrame, reading: str = "") -> WallMap:
    """A map of cells of 1 m, the top row first, x a wall."""
    filled = np.array([[sign == "x" for sign in row] for row in reversed(rows)])
    return grid_map(filled, frame, reading=reading)


@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_a_point_outside_of_a_far_map_is_told_its_bounds(yaw: float) -> None:
    """UTM coordinates: a map that lies 5,400 km from the point."""
    far = grid_of(["...."] * 4, GridFrame(500000.0, 5400000.0, yaw, 1.0))
    with pytest.raises(ScenarioError) as refusal:
        start_poses(PLAN, far)
    assert refusal.value.problem == "(35.0, 35.0) is outside of the map"
    xmin, ymin, xmax, ymax = far.bounds
    assert (
        f"x from {xmin:.2f} to {xmax:.2f} and y from {ymin:.2f} to {ymax:.2f}; the"
        in refusal.value.remedy
    )
    words = refusal.value.remedy.partition("the nearest free point is ")[2].strip("()").split(", ")
    assert far.is_free(float(words[0]), float(words[1]), 0.5)


def test_a_map_without_room_says_how_it_was_read() -> None:
    frame, reading = GridFrame(0.0, 0.0, 0.0, 1.0), "40 % of m.pgm is free; by mode raw"
    narrow = grid_of(["x.x.", ".x.x"], frame, reading)
    tight = replace(PLAN, goal=GoalSection(1.0, 1.0), planner=PlannerSection(inflation=0.9))
    with pytest.raises(ScenarioError) as refusal:
        start_poses(tight, narrow)
    assert refusal.value.remedy == (
        "found no place that is 0.9 m clear: change how the map is read "
        "(40 % of m.pgm is free; by mode raw), or make planner.inflation smaller"
    )


def test_a_room_too_small_for_the_team_is_refused() -> None:
    closet = load_map(MapSection(width=2.4, height=2.4), {})
    cramped = replace(PLAN, start=StartSection(1.2, 1.2), goal=GoalSection(1.2, 1.2))
    with pytest.raises(ScenarioError, match="no room for 6 robots"):
        start_poses(cramped, closet)


def test_a_given_path_is_refused_where_it_comes_too_close_to_a_wall() -> None:
    def start(*path: tuple[float, float]) -> None:
        start_poses(replace(PLAN, planner=PlannerSection(kind="path", path=path)), WALLS)

    start((10.0, 10.0), (10.0, 38.0), (30.0, 38.0), (35.0, 35.0))
    with pytest.raises(ScenarioError) as refusal:
        start((10.0, 10.0), (10.0, 30.0), (35.0, 35.0))
    assert refusal.value.where == "planner.path[2]"
    assert "from [10.0, 30.0] to [35.0, 35.0] is not 0.5 m clear" in refusal.value.problem
    with pytest.raises(ScenarioError, match=r"planner\.path\[1\]"):
        start((10.0, 10.0), (19.6, 10.0), (10.0, 38.0))
