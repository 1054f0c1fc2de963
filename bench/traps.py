"""The thesis's two traps, many seeds each, as JSON: who gets out within the budget, and how fast.

corner: map1's (thesis fig. 4.1), which `modified` leaves and `original` does not. room: three walls 9 m
apart and 24 m deep, closed towards the goal (fig. 4.2), which `escape` leaves and `modified` does not.
`python bench/traps.py --lines traps.jsonl`: each run is a line of the file as soon as it is done; a run
that is there is not done again.
"""

import argparse
import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    ClockSection,
    GoalSection,
    MapSection,
    PlannerSection,
    Point,
    StartSection,
)
from onehop.drivers.trial import run_trial
from onehop.maps.map_file import load_map

BUDGET_S = {"corner": 600.0, "room": 140.0}
"""Simulated time of a run [s]. In the room: a little more than the slowest `escape` takes. `modified` is
caught there, but not for ever: in 3 of 100 runs of 300 s it followed a side wall out by chance."""

ROOM: tuple[Point, ...] = (
    (51.0, 43.5), (77.0, 43.5), (77.0, 56.5), (51.0, 56.5),
    (51.0, 54.5), (75.0, 54.5), (75.0, 45.5), (51.0, 45.5),
)  # fmt: skip
"""Three walls, 2 m thick. Depth: beyond the laser's range and the width, so that a way of 10 m back from
the end wall does not lead out."""

MAP1 = Path(__file__).parents[1] / "scenarios" / "map1.toml"
CASES = (("corner", "modified"), ("corner", "original"), ("room", "escape"), ("room", "modified"))

Line = dict[str, Any]


def scenario_of(place: str, kind: Any, seed: int) -> Scenario:
    if place == "corner":
        table = tomllib.loads(MAP1.read_text())["map"]
        obstacles = tuple(tuple((float(x), float(y)) for x, y in p) for p in table["obstacles"])
        start, goal = (10.0, 10.0, 45.0), (90.0, 90.0)
    else:
        obstacles, start, goal = (ROOM,), (20.0, 50.0, 0.0), (92.0, 50.0)
    return Scenario(
        name=place,
        seed=seed,
        goal=GoalSection(*goal),
        map=MapSection(width=100.0, height=100.0, obstacles=obstacles),
        start=StartSection(poses=(start,)),
        planner=PlannerSection(kind=kind),
        clock=ClockSection(limit_s=BUDGET_S[place]),
    )


def run(place: str, kind: str, seed: int) -> Line:
    scenario = scenario_of(place, kind, seed)
    trial = run_trial(scenario, load_map(scenario.map, {}))
    return {
        "place": place,
        "kind": kind,
        "seed": seed,
        "answer": trial.outcome.value,
        "seconds": round((len(trial.path) - 1) * scenario.clock.period_ms / 1e3, 2),
        "contacts": trial.contacts,
        "clearance_m": round(trial.min_clearance, 4),
    }


def summary(lines: list[Line]) -> Line:
    """One case's figures."""
    seconds = [line["seconds"] for line in lines if line["answer"] == "arrived"]
    return {
        "place": lines[0]["place"],
        "kind": lines[0]["kind"],
        "seeds": len(lines),
        "arrived": len(seconds),
        "gave_up": sum(line["answer"] == "no way to the goal" for line in lines),
        "seconds_median": float(np.median(seconds)) if seconds else None,
        "seconds_max": max(seconds, default=None),
        "contacts": sum(line["contacts"] for line in lines),
        "min_clearance_m": min(line["clearance_m"] for line in lines),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--lines", type=Path, required=True, help="one line a run; made if missing")
    arguments = parser.parse_args()
    file: Path = arguments.lines
    done = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    known = {(line["place"], line["kind"], line["seed"]): line for line in done}
    figures = []
    for place, kind in CASES:
        lines = []
        for seed in range(1, arguments.seeds + 1):
            if (place, kind, seed) not in known:
                known[place, kind, seed] = run(place, kind, seed)
                with file.open("a") as end:
                    end.write(json.dumps(known[place, kind, seed]) + "\n")
            lines.append(known[place, kind, seed])
        figures.append(summary(lines))
    print(json.dumps({"budget_s": BUDGET_S, "cases": figures}, indent=1))


if __name__ == "__main__":
    main()
