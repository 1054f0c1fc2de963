"""One leader alone on a map, without radio and team: what `onehop plan` and the planner's campaigns run.

The same World and the same Pathfinder as in a mission. Beside the outcome it keeps what a figure shows:
the path, and each planning moment with its road map.
"""

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from onehop.contracts.briefings import robot_briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Note
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import Scenario
from onehop.maps.walls import WallMap, segment_distances
from robot_agent.core.planning import PlannerStatus, make_pathfinder
from robot_agent.core.planning.snapshot import PlanningSnapshot
from world_server.core.laser import Laser
from world_server.core.motion import Motion
from world_server.core.placement import start_poses

PIECE = 64
"""Poses of a path whose clearance is measured at once."""


@dataclass(frozen=True, slots=True)
class Trial:
    """How one leader fared.

    progress: the pathfinder's last word, DRIVING when the time limit came first. path: (ticks + 1, 3)
    poses [m, m, rad]. surveys: one for each planning moment. plan_ms: (replans,) wall time of those
    ticks; follow_us: (rest,) of the others. contacts: ticks in which the robot touched a wall.
    """

    progress: PlannerStatus
    path: FloatArray
    surveys: tuple[PlanningSnapshot, ...]
    notes: tuple[tuple[int, Note], ...]
    plan_ms: FloatArray
    follow_us: FloatArray
    contacts: int
    min_clearance: float

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(elementary.lengths(*np.diff(self.path[:, :2], axis=0).T).sum())

    def summary(self) -> dict[str, bool | int | float | str]:
        """The keys that `onehop plan --json` promises, without shortest_m."""
        return {
            "reached": self.progress is PlannerStatus.ARRIVED,
            "answer": self.progress.value,
            "steps": len(self.path) - 1,
            "path_length_m": round(self.length, 3),
            "replans": len(self.surveys),
            "backtracks": sum(survey.backtrack for survey in self.surveys),
            "min_clearance_m": round(self.min_clearance, 4),
            "contacts": self.contacts,
            "plan_ms_p50": _percentile(self.plan_ms, 50),
            "plan_ms_p99": _percentile(self.plan_ms, 99),
            "follow_us_mean": round(float(self.follow_us.mean()), 1) if len(self.follow_us) else 0.0,
        }


def run_trial(scenario: Scenario, walls: WallMap) -> Trial:
    """Let the scenario's first robot find its way alone.

    It starts in the middle of the start disc, heading for the goal, or in the first given pose. Raises
    ScenarioError when start or goal is not free.
    """
    scenario = _alone(scenario)
    robot = scenario.team.robots[0]
    poses = start_poses(scenario, walls)
    laser = Laser(walls, scenario.robot)
    motion = Motion(walls, scenario.robot, scenario.clock.period_ns)
    briefing = robot_briefing(scenario, robot, 0)
    first = Pose(*map(float, poses[0]))
    finder = make_pathfinder(briefing, first, generator(scenario.seed, f"robot/{robot}/0"))
    looking = np.zeros(1, dtype=np.int32)
    path, surveys, notes = [poses[0].copy()], [], []
    plan_s: list[float] = []
    follow_s: list[float] = []
    contacts, seen, progress = 0, None, PlannerStatus.DRIVING
    for tick in range(int(scenario.clock.limit_s * 1000 / scenario.clock.period_ms)):
        scan = laser.scans(poses, looking)[0]
        began = time.perf_counter()
        guidance = finder.step(Pose(*map(float, poses[0])), scan)
        took = time.perf_counter() - began
        notes += [(tick, note) for note in guidance.notes]
        if finder.survey is not None and finder.survey is not seen:
            seen = finder.survey
            surveys.append(seen)
            plan_s.append(took)
        else:
            follow_s.append(took)
        progress = guidance.progress
        if progress is not PlannerStatus.DRIVING:
            break
        touched = motion.advance(poses, np.array([[guidance.twist.v, guidance.twist.w]]))
        contacts += int(touched[0] >= -1)
        path.append(poses[0].copy())
    track = np.array(path)
    return Trial(
        progress=progress,
        path=track,
        surveys=tuple(surveys),
        notes=tuple(notes),
        plan_ms=np.array(plan_s) * 1e3,
        follow_us=np.array(follow_s) * 1e6,
        contacts=contacts,
        min_clearance=_least_clearance(walls, track[:, :2]),
    )


def _least_clearance(walls: WallMap, way: FloatArray) -> float:
    """Least distance between a way, (n, 2), and the walls [m].

    Piece by piece: if all of a piece lies within r of its first point, no wall matters to it that is
    2 r farther from that point than the nearest one.
    """
    least = math.inf
    for first in range(0, len(way), PIECE):
        piece = way[first : first + PIECE]
        reach = 2.0 * float(np.hypot(*(piece - piece[0]).T).max())
        distances = segment_distances(piece[:1], walls.segments)[0]
        near = walls.segments[distances <= distances.min(initial=math.inf) + reach]
        least = min(least, float(replace(walls, segments=near).clearance(piece).min()))
    return least


def _alone(scenario: Scenario) -> Scenario:
    """The same mission for one robot only, heading for the goal if no pose was given."""
    robot = scenario.team.robots[0]
    start = scenario.start
    if start.poses:
        start = replace(start, poses=start.poses[:1])
    else:
        ahead = elementary.atan2(scenario.goal.y - start.y, scenario.goal.x - start.x)
        start = replace(start, poses=((start.x, start.y, math.degrees(ahead)),))
    return replace(scenario, start=start, team=replace(scenario.team, ids=(robot,)), faults=())


def _percentile(values: FloatArray, share: float) -> float:
    return round(float(np.percentile(values, share)), 3) if len(values) else 0.0
