"""The maps of the thesis's studies: passable, with the difficulties that they promise."""

import math
import tomllib
from collections import deque
from pathlib import Path

import numpy as np
import pytest

from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GoalSection, MapSection, StartSection
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from world_server.core.placement import start_poses

SCENARIOS = Path(__file__).parents[3] / "scenarios"
NAMES = ["map1", "map2", "map3"]
STEP = 0.25
INFLATION = 0.5
START, GOAL = (10.0, 10.0), (90.0, 90.0)


def read(name: str) -> Scenario:
    """Map, start and goal of a study scenario."""
    document = tomllib.loads((SCENARIOS / f"{name}.toml").read_text())
    ground = document["map"]
    obstacles = tuple(tuple((float(x), float(y)) for x, y in polygon) for polygon in ground["obstacles"])
    return Scenario(
        name=document["name"],
        goal=GoalSection(**document["goal"]),
        map=MapSection(width=ground["width"], height=ground["height"], obstacles=obstacles),
        start=StartSection(**document["start"]),
    )


def walls_of(name: str) -> WallMap:
    return load_map(read(name).map, {})


def distances(walls: WallMap, clearance: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Length of the way from every grid point to the goal for a disc, in steps of 8 directions [m]."""
    count = round(100.0 / STEP) + 1
    axis = np.arange(count) * STEP
    points = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    free = walls.free(points, clearance).reshape(count, count)
    distance = np.full((count, count), math.inf)
    goal = (round(GOAL[0] / STEP), round(GOAL[1] / STEP))
    distance[goal] = 0.0
    queue = deque([goal])
    while queue:
        column, row = queue.popleft()
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            x, y = column + dx, row + dy
            further = distance[column, row] + STEP * math.hypot(dx, dy)
            inside = 0 <= x < count and 0 <= y < count
            if inside and free[x, y] and further < distance[x, y] - 1e-9:
                distance[x, y] = further
                queue.append((x, y))
    return distance


def at(distance: np.ndarray[tuple[int, ...], np.dtype[np.float64]], x: float, y: float) -> float:
    return float(distance[round(x / STEP), round(y / STEP)])


@pytest.mark.parametrize("name", NAMES)
def test_a_study_map_is_a_square_of_a_hundred_metres_with_start_and_goal(name: str) -> None:
    scenario = read(name)
    assert scenario.name == name
    assert list(scenario.problems()) == []
    assert (scenario.map.width, scenario.map.height) == (100.0, 100.0)
    assert (scenario.start.x, scenario.start.y) == START
    assert (scenario.goal.x, scenario.goal.y) == GOAL


@pytest.mark.parametrize("name", NAMES)
def test_six_robots_can_start_there_with_any_seed(name: str) -> None:
    scenario, walls = read(name), walls_of(name)
    for seed in range(20):
        poses = start_poses(
            Scenario(scenario.name, scenario.goal, scenario.map, start=scenario.start, seed=seed),
            walls,
        )
        assert len(poses) == 6


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_column_of_robots_can_pass(name: str) -> None:
    """A disc with half the width of the narrowest passage gets through: 2.5 m and more are free."""
    assert at(distances(walls_of(name), 1.25), *START) < math.inf


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_straight_way_is_blocked_but_the_detour_is_bearable(name: str) -> None:
    walls = walls_of(name)
    assert not walls.sees(*START, *GOAL, INFLATION)
    straight = math.dist(START, GOAL)
    assert 1.05 * straight < at(distances(walls, INFLATION), *START) < 2.0 * straight


@pytest.mark.slow
@pytest.mark.parametrize(("name", "corner"), [("map1", (73.0, 73.0)), ("map3", (79.0, 73.0))])
def test_the_corner_is_a_trap_deeper_and_wider_than_the_laser_sees(
    name: str, corner: tuple[float, float]
) -> None:
    """Thesis 4.1: from the corner every way out first leads more than 10 m away from the goal."""
    distance = distances(walls_of(name), INFLATION)
    straight = math.dist(corner, GOAL)
    assert at(distance, *corner) > 2.0 * straight
    count = distance.shape[0]
    axis = np.arange(count) * STEP
    x, y = np.meshgrid(axis, axis, indexing="ij")
    near = np.hypot(x - corner[0], y - corner[1]) <= 10.0
    reachable = np.isfinite(distance) & near & (x < corner[0] + 1.0) & (y < corner[1] + 1.0)
    closest = np.hypot(x - GOAL[0], y - GOAL[1])[reachable].min()
    assert closest > straight - 1.5
