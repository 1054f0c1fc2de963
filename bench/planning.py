"""Time and memory of the planner as one JSON object.

Time of a local plan (200 samples and A*) beside OMPL's PRM on the same scene, time of a step that only
follows its way, and memory. OMPL is an optional development dependency (pip install ompl); without it
the object says "not installed".
"""

import argparse
import importlib
import json
import math
import resource
import time
from typing import Any

import numpy as np

from onehop.contracts.beams import Beams
from onehop.contracts.briefings import robot_briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import GoalSection, MapSection, RobotSection
from onehop.maps.map_file import load_map
from robot_agent.core.planning import make_pathfinder
from robot_agent.core.planning.roadmap import RoadMap
from robot_agent.core.planning.sampling import sample_fan
from robot_agent.core.planning.view import NO_POINTS, View
from world_server.core.laser import Laser

BLOCKS = tuple(
    ((x, y), (x + 1.5, y), (x + 1.5, y + 2.0), (x, y + 2.0))
    for x, y in ((13.0, 9.0), (15.0, 14.0), (17.0, 6.0), (12.0, 16.0), (18.5, 11.5), (14.0, 4.0))
)


def scene() -> tuple[View, RobotSection]:
    """Six blocks in the half disc before a robot that stands in a 30 m field."""
    body = RobotSection()
    walls = load_map(MapSection(width=30.0, height=30.0, obstacles=BLOCKS), {})
    scan = Laser(walls, body).scans(np.array([(10.0, 11.0, 0.0)]), np.zeros(1, dtype=np.int32))[0]
    return View(Beams(body), Pose(10.0, 11.0, 0.0), scan, 0.05), body


def local_plan(rounds: int) -> dict[str, float]:
    """CPU time of view, 200 samples, road map and A* [ms]."""
    view, body = scene()
    scan = np.where(view.solid, view.sight, np.inf).astype(np.float32)
    beams, random, took = Beams(body), generator(1, "bench"), []
    for _ in range(rounds):
        began = time.process_time()
        look = View(beams, view.pose, scan, 0.05)
        samples = sample_fan(look, random.random((200, 2)), 0.0, math.pi / 2, 0.52)
        roadmap = RoadMap(look, samples, NO_POINTS, 0.52, 0.7)
        left = np.hypot(*(roadmap.points - (25.0, 14.0)).T)
        roadmap.path(int(np.argmin(np.where(np.isfinite(roadmap.costs()), left, np.inf))))
        took.append((time.process_time() - began) * 1e3)
    return percentiles(took)


def ompl_prm(rounds: int) -> dict[str, dict[str, float]] | str:
    """CPU time of OMPL's PRM until it has 200 milestones and a solution [ms].

    The checker is in Python, which costs most of it; so there is a second figure with the checker's
    time taken off, as if checking were free.
    """
    try:
        base, geometric = importlib.import_module("ompl.base"), importlib.import_module("ompl.geometric")
    except ImportError:
        return "not installed"
    view, _ = scene()
    obstacles, beams = view.obstacles, view.beams
    left = float(beams.angles[0])
    step = float(beams.angles[1]) - left

    checking = 0.0

    def valid(state: Any) -> bool:
        nonlocal checking
        began = time.process_time()
        verdict = free(state)
        checking += time.process_time() - began
        return verdict

    def free(state: Any) -> bool:
        x, y = state[0], state[1]
        dx, dy = x - 10.0, y - 11.0
        beam = round((math.atan2(dy, dx) - left) / step)
        if not 0 <= beam < len(beams.angles) or math.hypot(dx, dy) > view.sight[beam]:
            return False
        return bool(((obstacles[:, 0] - x) ** 2 + (obstacles[:, 1] - y) ** 2).min() >= 0.52**2)

    took, unchecked = [], []
    for _ in range(rounds):
        began, checking = time.process_time(), 0.0
        space = base.RealVectorStateSpace(2)
        bounds = base.RealVectorBounds(2)
        for axis, (low, high) in enumerate(((10.0, 20.0), (1.0, 21.0))):
            bounds.setLow(axis, low)
            bounds.setHigh(axis, high)
        space.setBounds(bounds)
        information = base.SpaceInformation(space)
        information.setStateValidityChecker(valid)
        information.setStateValidityCheckingResolution(0.02)
        information.setup()
        problem = base.ProblemDefinition(information)
        start, goal = space.allocState(), space.allocState()
        start[0], start[1], goal[0], goal[1] = 10.01, 11.0, 19.0, 13.8
        problem.setStartAndGoalStates(start, goal, 0.5)
        planner = geometric.PRM(information)
        planner.setProblemDefinition(problem)
        planner.setup()
        enough = base.PlannerTerminationCondition(
            lambda planner=planner: planner.milestoneCount() >= 200
        )
        planner.growRoadmapPtc(enough)
        planner.solve(base.timedPlannerTerminationCondition(1.0))
        took.append((time.process_time() - began) * 1e3)
        unchecked.append(took[-1] - checking * 1e3)
    return {"all": percentiles(took), "without_checker": percentiles(unchecked)}


def following(ticks: int) -> dict[str, float]:
    """Wall time of a step in an open field, planning moments left out, and with them shared out [us]."""
    scenario = Scenario(
        name="open", goal=GoalSection(900.0, 15.0), map=MapSection(width=1000.0, height=30.0)
    )
    walls = load_map(scenario.map, {})
    laser = Laser(walls, scenario.robot)
    finder = make_pathfinder(robot_briefing(scenario, 1, 0), Pose(5.0, 15.0, 0.0), generator(1, "bench"))
    plain, every, pose = [], [], np.array([[5.0, 15.0, 0.0]])
    for _ in range(ticks):
        scan = laser.scans(pose, np.zeros(1, dtype=np.int32))[0]
        place, before = Pose(*map(float, pose[0])), finder.snapshot
        began = time.perf_counter()
        twist = finder.step(place, scan).twist
        took = (time.perf_counter() - began) * 1e6
        every.append(took)
        if finder.snapshot is before:
            plain.append(took)
        heading = pose[0, 2] + 0.5 * twist.w * 0.05
        pose[0] += twist.v * 0.05 * math.cos(heading), twist.v * 0.05 * math.sin(heading), twist.w * 0.05
    return {"follow_us_p50": float(np.median(plain)), "with_planning_us_mean": float(np.mean(every))}


def percentiles(values: list[float]) -> dict[str, float]:
    return {"p50_ms": float(np.percentile(values, 50)), "p99_ms": float(np.percentile(values, 99))}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--rounds", type=int, default=300)
    arguments = parser.parse_args()
    local_plan(20)
    ours, peer = local_plan(arguments.rounds), ompl_prm(max(20, arguments.rounds // 10))
    figures: dict[str, object] = {"local_plan_200": ours, "ompl_prm_200": peer, "step": following(4000)}
    if isinstance(peer, dict):
        figures["times_faster_p50"] = {
            name: round(share["p50_ms"] / ours["p50_ms"], 1) for name, share in peer.items()
        }
    figures["max_rss_mb_of_this_process"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
