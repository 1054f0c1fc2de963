"""What does not change while a mission is shown: its ground, its robots, its goal."""

import base64
from typing import Any

import numpy as np

from onehop.analysis.palette import robot_colours
from onehop.contracts.scenario import Scenario
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from onehop.scenario.bundle import Bundle

RASTER = 500
"""Points along the longer side at which a map from a file is asked what is filled."""


def setting(bundle: Bundle) -> dict[str, Any]:
    """Everything that the page draws once. Plain values, as JSON has them."""
    scenario = bundle.scenario
    walls = load_map(scenario.map, bundle.files)
    colours = robot_colours(scenario.team.robots)
    goal = scenario.goal
    return {
        "name": scenario.name,
        "seed": scenario.seed,
        "period_s": scenario.clock.period_ns / 1e9,
        "bounds": list(walls.bounds),
        "obstacles": [[list(corner) for corner in polygon] for polygon in scenario.map.obstacles],
        "filled": _filled(walls) if scenario.map.file else None,
        "walls": np.round(walls.segments, 3).tolist(),
        "goal": {"x": goal.x, "y": goal.y, "tolerance": goal.tolerance},
        "robots": [_robot(scenario, robot, colours[robot]) for robot in scenario.team.robots],
    }


def _robot(scenario: Scenario, robot: int, colour: str) -> dict[str, Any]:
    body = scenario.body_of(robot)
    return {
        "id": robot,
        "colour": colour,
        "radius": body.radius,
        "laser": {"range": body.laser_range, "beams": body.laser_beams, "fov_deg": body.laser_fov_deg},
    }


def _filled(walls: WallMap) -> dict[str, Any]:
    """What is filled of a map without polygons: a picture of bits, the lowest row first."""
    xmin, ymin, xmax, ymax = walls.bounds
    cell = max(xmax - xmin, ymax - ymin) / RASTER
    x, y = np.arange(xmin + cell / 2, xmax, cell), np.arange(ymin + cell / 2, ymax, cell)
    points = np.column_stack([part.ravel() for part in np.meshgrid(x, y)])
    bits = np.packbits(walls.ground.solid(points).reshape(len(y), len(x)), axis=1)
    return {
        "columns": len(x),
        "rows": len(y),
        "cell": cell,
        "bits": base64.b64encode(bits.tobytes()).decode(),
    }
