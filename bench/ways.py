"""Ways of `escape` between random places of maps, against the shortest and beside TangentBug's, as JSON.

`python bench/ways.py --lines ways.jsonl scenarios/map1.toml ../shared/maps/ros/depot.yaml ...` drives a
leader alone between pairs of places that the known map shows to be connected for the inflated robot.
Each pair is a line of the file as soon as it is driven; a pair that is there is not driven again.
"""

import argparse
import json
import math
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from tangent_bug import tangent_bug

from onehop.analysis.shortest import KnownMap, way_length
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    ClockSection,
    GoalSection,
    MapSection,
    PlannerSection,
    RobotSection,
    StartSection,
)
from onehop.drivers.trial import run_trial
from onehop.maps.map_file import load_map, map_files
from onehop.maps.walls import WallMap

SMALL_MAPS = {
    "depot": (PlannerSection(inflation=0.25), RobotSection(radius=0.15, leader_speed=0.5)),
    "tb3_sandbox": (
        PlannerSection(inflation=0.2),
        RobotSection(radius=0.12, leader_speed=0.3, laser_range=3.5),
    ),
}
"""Robots that fit the ROS maps, which are a few tens of metres: a TurtleBot3 sees 3.5 m."""

LIMIT_S = 12000.0
"""Simulated time of one pair [s]."""

Line = dict[str, Any]


def read_map(path: Path) -> tuple[Scenario, WallMap]:
    """A scenario for one leader on a map file: a scenario's polygons, a ROS map or a MovingAI grid."""
    planner, body = SMALL_MAPS.get(path.stem, (PlannerSection(), RobotSection()))
    if path.suffix == ".toml":
        table = tomllib.loads(path.read_text())["map"]
        polygons = tuple(tuple((float(x), float(y)) for x, y in p) for p in table["obstacles"])
        section = MapSection(width=table["width"], height=table["height"], obstacles=polygons)
        walls = load_map(section, {})
    else:
        section = MapSection(file=str(path))
        files = {str(path): path.read_bytes()}
        files |= {
            name: (path.parent / name).read_bytes() for name in map_files(str(path), files[str(path)])
        }
        walls = load_map(section, files)
    return Scenario(
        name=path.stem, goal=GoalSection(0, 0), map=section, planner=planner, robot=body
    ), walls


def pairs(known: KnownMap, walls: WallMap, count: int) -> Iterator[tuple[tuple[int, ...], float]]:
    """Connected pairs, at least a tenth of the map apart: rows and columns, and the shortest way [m]."""
    cells, random = np.argwhere(known.free), generator(7, "pairs")
    span = max(walls.bounds[2] - walls.bounds[0], walls.bounds[3] - walls.bounds[1])
    while count:
        r0, c0, r1, c1 = cells[random.integers(len(cells), size=2)].ravel().tolist()
        start, goal = (float(known.x[c0]), float(known.y[r0])), (float(known.x[c1]), float(known.y[r1]))
        if math.dist(start, goal) < 0.1 * span:
            continue
        way = known.shortest(start, known.distances(goal))
        if way is not None:
            count -= 1
            yield (r0, c0, r1, c1), way_length(way)


def drive(scenario: Scenario, walls: WallMap, known: KnownMap, cells: tuple[int, ...]) -> Line:
    """One pair, driven by `escape` and by TangentBug."""
    r0, c0, r1, c1 = cells
    start, goal = (float(known.x[c0]), float(known.y[r0])), (float(known.x[c1]), float(known.y[r1]))
    mission = replace(
        scenario,
        start=StartSection(x=start[0], y=start[1]),
        goal=GoalSection(*goal),
        clock=ClockSection(limit_s=LIMIT_S),
    )
    run = run_trial(mission, walls)
    bug = tangent_bug(known.free, c0, r0, c1, r1, scenario.robot.laser_range / known.cell)
    return {
        "start": start,
        "goal": goal,
        "answer": run.outcome.value,
        "length_m": round(run.length, 3),
        "rest_m": round(math.dist(run.path[-1][:2], goal), 3),
        "clearance_m": round(run.min_clearance, 4),
        "contacts": run.contacts,
        "tangent_bug_m": round(bug * known.cell, 3) if bug > 0 else None,
    }


def campaign(path: Path, count: int, lines: Path) -> Line:
    """All pairs of one map, those that `lines` does not have yet driven now."""
    done = [json.loads(line) for line in lines.read_text().splitlines()] if lines.exists() else []
    known_lines = {(line["map"], line["pair"]): line for line in done}
    scenario, walls = read_map(path)
    known = KnownMap(walls, scenario.planner.inflation, min(0.25, scenario.planner.inflation / 2))
    mine = [known_lines[path.name, pair] for pair in range(count) if (path.name, pair) in known_lines]
    if len(mine) < count:
        for pair, (cells, shortest) in enumerate(pairs(known, walls, count)):
            if (path.name, pair) in known_lines:
                continue
            line = {"map": path.name, "pair": pair, "shortest_m": round(shortest, 3)}
            line |= drive(scenario, walls, known, cells)
            mine.append(line)
            with lines.open("a") as file:
                file.write(json.dumps(line) + "\n")
    return summary(mine, scenario)


def summary(lines: list[Line], scenario: Scenario) -> Line:
    """One map's figures. Ratios are those of pairs that the planner in question solved.

    The leader stops within the goal's tolerance; what is left to the goal counts as driven.
    """
    solved = [line for line in lines if line["answer"] == "arrived"]
    escape = [(line["length_m"] + line["rest_m"]) / line["shortest_m"] for line in solved]
    tangent = [line["tangent_bug_m"] / line["shortest_m"] for line in lines if line["tangent_bug_m"]]
    return {
        "map": lines[0]["map"],
        "pairs": len(lines),
        "reached": len(solved),
        "failed": [line for line in lines if line["answer"] != "arrived"],
        "contacts": sum(line["contacts"] for line in lines),
        "min_clearance_m": min(line["clearance_m"] for line in lines),
        "inflation_m": scenario.planner.inflation,
        "escape": shares(escape),
        "tangent_bug": {"reached": len(tangent), **shares(tangent)},
    }


def shares(ratios: list[float]) -> dict[str, float]:
    return {
        "median": round(float(np.median(ratios)), 3),
        "p95": round(float(np.percentile(ratios, 95)), 3),
        "worst": round(max(ratios), 3),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("maps", nargs="+", type=Path)
    parser.add_argument("--pairs", type=int, default=50)
    parser.add_argument("--lines", type=Path, required=True, help="one line a pair; made if missing")
    arguments = parser.parse_args()
    figures = [campaign(path, arguments.pairs, arguments.lines) for path in arguments.maps]
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
