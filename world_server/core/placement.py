"""Where the team starts: the scenario's own poses, or random ones by seed; and what may not be.

Start, goal and a path that is given must be clear of obstacles by the planner's inflation, or no robot
could plan or drive there.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from onehop.contracts.errors import ScenarioError
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import Point
from onehop.maps.walls import WallMap

_GAP = 0.2
"""Distance beyond touching inflation zones that random starts keep from each other [m]."""

_FILLING = 0.2
"""Part of the start disc that the robots' zones may cover: random placing ends quickly below 0.5."""

_DRAWS, _BATCH = 20, 20
"""Random places tried for one robot before the disc is given up as too full: so many times so many."""

_GROWTH, _GROWN = 1.15, 8
"""An automatic disc that is too full grows by this factor, at most so often (3 times the radius)."""


def start_poses(scenario: Scenario, walls: WallMap) -> FloatArray:
    """Start poses in order of robot id, (n, 3) [m, m, rad].

    Raises ScenarioError when start, goal, a pose or the given path is not free, or when there is no room
    for the team.
    """
    inflation = scenario.planner.inflation
    require_free(walls, "goal.x, goal.y", scenario.goal.x, scenario.goal.y, inflation)
    if scenario.planner.kind == "path":
        require_clear_path(walls, scenario.planner.path, inflation)
    if scenario.start.poses:
        return _given_poses(scenario, walls)
    start = scenario.start
    require_free(walls, "start.x, start.y", start.x, start.y, inflation)
    count = len(scenario.team.robots)
    apart = 2.0 * inflation + _GAP
    random = generator(scenario.seed, "world/placement")
    radius = start.radius or 0.5 * apart * math.sqrt(count / _FILLING)
    for _ in range(1 if start.radius else _GROWN):
        poses = _scatter(random, walls, scenario, radius, apart)
        if poses is not None:
            return poses
        radius *= _GROWTH
    raise ScenarioError(
        "start.x, start.y" if not start.radius else "start.radius",
        f"no room for {count} robots around ({start.x}, {start.y})",
        f"a place with {apart:.1f} m from robot to robot and {inflation} m to walls, "
        "fewer robots, or a smaller planner.inflation",
    )


def _scatter(
    random: np.random.Generator, walls: WallMap, scenario: Scenario, radius: float, apart: float
) -> FloatArray | None:
    """Random poses in the start disc, uniform over its area; None when one robot finds no place.

    Every place can be seen from the disc's centre, so that nobody starts in another room.
    """
    start, inflation = scenario.start, scenario.planner.inflation
    poses: list[tuple[float, float, float]] = []
    for _ in scenario.team.robots:
        for _ in range(_DRAWS):
            share, direction, turn = random.random((3, _BATCH))
            distance, angle = radius * np.sqrt(share), math.tau * direction
            x = start.x + distance * elementary.cosines(angle)
            y = start.y + distance * elementary.sines(angle)
            fits = walls.free(np.column_stack((x, y)), inflation)
            for other in poses:
                fits &= elementary.lengths(x - other[0], y - other[1]) >= apart
            seen = (
                k
                for k in np.flatnonzero(fits).tolist()
                if walls.sees(start.x, start.y, x[k], y[k], inflation)
            )
            chosen = next(seen, None)
            if chosen is not None:
                heading = math.pi - math.tau * turn[chosen]
                poses.append((float(x[chosen]), float(y[chosen]), heading))
                break
        else:
            return None
    return np.array(poses)


def _given_poses(scenario: Scenario, walls: WallMap) -> FloatArray:
    poses = np.array(scenario.start.poses, dtype=np.float64)
    poses[:, 2] = -np.remainder(np.pi - np.radians(poses[:, 2]), 2.0 * np.pi) + np.pi
    radii = [body.radius for body in scenario.bodies]
    for number, (x, y, _) in enumerate(poses):
        require_free(walls, f"start.poses[{number}]", x, y, scenario.planner.inflation)
        for other in range(number):
            distance = math.hypot(x - poses[other, 0], y - poses[other, 1])
            least = radii[number] + radii[other]
            if distance < least:
                raise ScenarioError(
                    f"start.poses[{number}]",
                    f"only {distance:.2f} m from start.poses[{other}]",
                    f"at least {least:g} m, the radii of both",
                )
    return poses


def require_free(walls: WallMap, where: str, x: float, y: float, inflation: float) -> None:
    if walls.is_free(x, y, inflation):
        return
    xmin, ymin, xmax, ymax = walls.bounds
    problem, remedy = f"({x}, {y}) is not {inflation} m clear of obstacles", ""
    if not (xmin <= x <= xmax and ymin <= y <= ymax):
        problem = f"({x}, {y}) is outside of the map"
        remedy = f"x from {xmin:.2f} to {xmax:.2f} and y from {ymin:.2f} to {ymax:.2f}; "
    near = walls.nearest_free(min(max(x, xmin), xmax), min(max(y, ymin), ymax), inflation)
    if near:
        remedy += f"the nearest free point is ({near[0]}, {near[1]})"
    else:
        remedy += f"found no place that is {inflation} m clear: "
        remedy += f"change how the map is read ({walls.reading}), or " if walls.reading else ""
        remedy += "make planner.inflation smaller"
    raise ScenarioError(where, problem, remedy)


def require_clear_path(walls: WallMap, path: Sequence[Point], inflation: float) -> None:
    """Raise ScenarioError for a path on which the planner's inflation is not kept."""
    for number, (here, there) in enumerate(pairwise(path)):
        if not walls.sees(*here, *there, inflation):
            raise ScenarioError(
                f"planner.path[{number + 1}]",
                f"the way from {list(here)} to {list(there)} is not {inflation} m clear of obstacles",
                "a path around them, or a smaller planner.inflation",
            )
