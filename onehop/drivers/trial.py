"""One leader alone on a map, without radio and team: what `onehop plan` and the planner's campaigns run.

The same World and the same Pathfinder as in a mission. Beside the outcome it keeps what a figure shows:
the path, and each planning moment with its road map.
"""

import math
import time
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray, Ranges
from onehop.contracts.briefings import robot_briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Note
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import Scenario
from onehop.maps.walls import WallMap, segment_distances
from onehop.plugins import plugged
from robot_agent.core.planning import Guidance, Pathfinder, PlannerStatus, make_pathfinder
from robot_agent.core.planning.snapshot import PlanningSnapshot
from world_server.core.laser import Laser
from world_server.core.motion import Motion
from world_server.core.placement import start_poses

LOOKING = np.zeros(1, dtype=np.int32)
"""The rows of the poses that look: the only one."""

PIECE = 64
"""Poses of a path whose clearance is measured at once."""


class TrialOutcome(StrEnum):
    """How a trial ended: with the pathfinder's answer, or before it had one."""

    ARRIVED = "arrived"
    NO_WAY = "no way to the goal"
    TIME_LIMIT = "time limit"


OUTCOMES = {
    PlannerStatus.ARRIVED: TrialOutcome.ARRIVED,
    PlannerStatus.NO_WAY: TrialOutcome.NO_WAY,
    PlannerStatus.DRIVING: TrialOutcome.TIME_LIMIT,
}
"""What a trial's outcome is by the pathfinder's last word."""


@dataclass(frozen=True, slots=True)
class Trial:
    """How one leader fared.

    limit_s: simulated time that it had [s]. path: (ticks + 1, 3) poses [m, m, rad]. snapshots: one for
    each planning moment. plan_ms: (replans,) wall time of those ticks; follow_us: (rest,) of the others.
    contacts: ticks in which the robot touched a wall.
    """

    outcome: TrialOutcome
    limit_s: float
    path: FloatArray
    snapshots: tuple[PlanningSnapshot, ...]
    notes: tuple[tuple[int, Note], ...]
    plan_ms: FloatArray
    follow_us: FloatArray
    contacts: int
    min_clearance: float

    @property
    def answer(self) -> str:
        """The outcome for people; of the time limit, with where it is set."""
        if self.outcome is TrialOutcome.TIME_LIMIT:
            return f"time limit of {self.limit_s:g} s (clock.limit_s)"
        return self.outcome.value

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(elementary.lengths(*np.diff(self.path[:, :2], axis=0).T).sum())

    def summary(self) -> dict[str, bool | int | float | str]:
        """The keys that `onehop plan --json` promises, without shortest_m."""
        return {
            "reached": self.outcome is TrialOutcome.ARRIVED,
            "answer": self.answer,
            "steps": len(self.path) - 1,
            "path_length_m": round(self.length, 3),
            "replans": len(self.snapshots),
            "backtracks": sum(snapshot.backtrack for snapshot in self.snapshots),
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
    body = scenario.body_of(robot)
    laser = Laser(walls, body)
    motion = Motion(walls, [body], scenario.clock.period_ns)
    rng = generator(scenario.seed, f"robot/{robot}/0")
    finder = make_pathfinder(plugged(robot_briefing(scenario, robot, 0)), _pose(poses), rng)
    record, contacts, path = _Record(finder), 0, [poses[0].copy()]
    for tick in range(int(scenario.clock.limit_s * 1000 / scenario.clock.period_ms)):
        guidance = record.step(tick, _pose(poses), laser.scans(poses, LOOKING)[0])
        if guidance.status is not PlannerStatus.DRIVING:
            break
        touched = motion.advance(poses, np.array([[guidance.twist.v, guidance.twist.w]]))
        contacts += int(touched[0] >= -1)
        path.append(poses[0].copy())
    track = np.array(path)
    return Trial(
        outcome=OUTCOMES[record.status],
        limit_s=scenario.clock.limit_s,
        path=track,
        snapshots=tuple(record.snapshots),
        notes=tuple(record.notes),
        plan_ms=np.array(record.plan_s) * 1e3,
        follow_us=np.array(record.follow_s) * 1e6,
        contacts=contacts,
        min_clearance=_least_clearance(walls, track[:, :2]),
    )


class _Record:
    """A pathfinder, and what is kept of its ticks: its snapshots too, if it shows any."""

    def __init__(self, finder: Pathfinder) -> None:
        self.finder = finder
        self.status = PlannerStatus.DRIVING
        self.snapshots: list[PlanningSnapshot] = []
        self.notes: list[tuple[int, Note]] = []
        self.plan_s: list[float] = []
        self.follow_s: list[float] = []

    def step(self, tick: int, pose: Pose, scan: Ranges) -> Guidance:
        """The pathfinder's step, timed."""
        before = getattr(self.finder, "snapshot", None)
        began = time.perf_counter()
        guidance = self.finder.step(pose, scan)
        took = time.perf_counter() - began
        self.status = guidance.status
        self.notes += [(tick, note) for note in guidance.notes]
        after = getattr(self.finder, "snapshot", None)
        if after is not None and after is not before:
            self.snapshots.append(after)
            self.plan_s.append(took)
        else:
            self.follow_s.append(took)
        return guidance


def _pose(poses: FloatArray) -> Pose:
    x, y, heading = poses[0].tolist()
    return Pose(x, y, heading)


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
