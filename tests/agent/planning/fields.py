"""Obstacle fields and missions of one leader for the planner's tests."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np

from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    ClockSection,
    GoalSection,
    MapSection,
    PlannerSection,
    Point,
    RobotSection,
    StartSection,
)
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from robot_agent.core.planning.view import View
from world_server.core.laser import Laser

ROOT = Path(__file__).resolve().parents[3]

THREE_WALLS: tuple[Point, ...] = (
    (43.0, 43.5), (62.0, 43.5), (62.0, 56.5), (43.0, 56.5),
    (43.0, 54.5), (60.0, 54.5), (60.0, 45.5), (43.0, 45.5),
)  # fmt: skip
"""Three walls around a room 9 m wide, open to the left (thesis 4.1: less than 10 m)."""


def box(x0: float, y0: float, x1: float, y1: float) -> tuple[Point, ...]:
    return ((x0, y0), (x1, y0), (x1, y1), (x0, y1))


CLOSED_ROOM = (
    box(70, 70, 71, 95), box(71, 70, 94, 71), box(94, 70, 95, 95), box(71, 94, 94, 95),
)  # fmt: skip
"""Four walls without a door."""


def field(*obstacles: tuple[Point, ...], size: float = 100.0) -> MapSection:
    return MapSection(width=size, height=size, obstacles=obstacles)


def study_map(name: str) -> MapSection:
    """The map of scenarios/<name>.toml."""
    table = tomllib.loads((ROOT / "scenarios" / f"{name}.toml").read_text())["map"]
    polygons = tuple(tuple((float(x), float(y)) for x, y in polygon) for polygon in table["obstacles"])
    return MapSection(width=table["width"], height=table["height"], obstacles=polygons)


def alone(
    ground: MapSection,
    start: tuple[float, float, float],
    goal: Point,
    kind: str = "escape",
    seed: int = 1,
    limit_s: float = 900.0,
) -> tuple[Scenario, WallMap]:
    """A mission of one leader: start as x, y, heading in degrees."""
    scenario = Scenario(
        name="field",
        seed=seed,
        goal=GoalSection(*goal),
        map=ground,
        start=StartSection(poses=(start,)),
        planner=replace(PlannerSection(), kind=kind),
        clock=ClockSection(limit_s=limit_s),
    )
    return scenario, load_map(ground, {})


def look(ground: MapSection, x: float, y: float, heading: float, beams: int = 181) -> View:
    """What a laser with that many beams shows from there."""
    body = replace(RobotSection(), laser_beams=beams)
    laser = Laser(load_map(ground, {}), body)
    scan = laser.scans(np.array([(x, y, heading)]), np.zeros(1, dtype=np.int32))[0]
    return View(Beams(body), Pose(x, y, heading), scan, 0.05)
