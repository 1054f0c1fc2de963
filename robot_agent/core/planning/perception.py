"""What a leader sees at a planning moment: its view, a road map in it, and way points in reach."""

import math
from typing import NamedTuple

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray, Ranges
from onehop.contracts.beams import Beams
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose
from robot_agent.core.planning.memory import FRONTIER, PLACE, WayPoints
from robot_agent.core.planning.recent_obstacles import RecentObstacles
from robot_agent.core.planning.roadmap import RoadMap
from robot_agent.core.planning.sampling import (
    corner_samples,
    goal_sample,
    outline_end_samples,
    sample_fan,
    spread_draws,
)
from robot_agent.core.planning.view import View

GRAIN = 0.1
"""Spacing of the points of an outline, in inflations: a clearance is wrong by 0.6 mm at most."""

WAY_SPARE = 0.04
"""What a way keeps from hits beyond the inflation, in inflations, with beams one degree apart: a corner
between two hits stands out by up to half of their distance, 2 cm at 2.2 m."""

STEP_SPARE = 0.01
"""What each step keeps beyond the inflation, in inflations: the same for a corner one inflation away,
and less than a way keeps, so that the robot need not follow it to the millimetre."""

COMFORT = 1.4
"""What a way keeps where it costs little, in inflations."""

FINE = 0.0175
"""Spacing of the beams that WAY_SPARE and STEP_SPARE are made for, one degree rounded up [rad]. With
beams farther apart corners stand out more, in proportion; with closer ones other errors remain."""

RECENT_REACH = 6.0
"""How far obstacles are remembered that left the view, in inflations: twice what is driven between two
planning moments."""

CORNER_GAP = 2.0
"""Jump of the range beside a corner, in inflations: nothing narrower lets the robot through."""

SPARE_ROOM = 1.1
"""Points that are put beside a corner or the end of the range have this much more room than they need,
or rounding would drop them."""

GOAL_SHIFT = 0.5
"""How far from the goal a place may be that stands for it, in its tolerances: half, since a robot ends
its way before it is exactly there."""

EIGHTHS: FloatArray = np.arange(8) * math.pi / 4
"""Eight directions [rad]."""

GOAL_PLACES: FloatArray = np.concatenate(
    [
        np.zeros((1, 2)),
        *(
            share * np.column_stack((elementary.cosines(EIGHTHS), elementary.sines(EIGHTHS)))
            for share in (0.5, 1.0)
        ),
    ]
)
"""Places around a goal, the goal first, in units of the greatest distance from it."""


class Clearances(NamedTuple):
    """Distances to keep from what the beams hit [m]: way, of a planned way; comfort, of one that does
    not have to go through a tight place; step, of each step that is driven.
    """

    way: float
    comfort: float
    step: float


def clearances(inflation: float, spacing: float) -> Clearances:
    """What keeps the inflation [m] with beams `spacing` apart [rad]."""
    coarse = max(1.0, spacing / FINE)
    way, step = 1.0 + WAY_SPARE * coarse, 1.0 + STEP_SPARE * coarse
    return Clearances(way * inflation, max(COMFORT, way) * inflation, step * inflation)


class LocalMap(NamedTuple):
    """One planning moment's knowledge, map frame.

    samples: (n, 2) points drawn [m]. costs: of the way to each point of the road map [m], inf where
    there is none. goal: the point at the goal, or None if no way leads there. known: way points in
    view, ascending. reach: those that a way leads to, and the point of the road map that each is.
    """

    view: View
    samples: FloatArray
    roadmap: RoadMap
    costs: FloatArray
    goal: int | None
    known: list[int]
    reach: dict[int, int]

    def lengths(self) -> dict[int, float]:
        """Way points in reach, ascending, and the length of the way there [m]."""
        return {number: float(self.costs[point]) for number, point in sorted(self.reach.items())}

    def way_to_room(self, distance: float) -> FloatArray:
        """A straight way to where there is most room, `distance` away in one of eight directions [m]."""
        view, clearance = self.view, self.roadmap.clearance
        bearing = EIGHTHS + view.pose.heading
        step = np.column_stack((elementary.cosines(bearing), elementary.sines(bearing)))
        ends = view.origin + distance * step
        room = view.free(ends, clearance)[1]
        clear = view.passable(np.broadcast_to(view.origin, ends.shape), ends, clearance)
        best = ends[int(np.argmax(np.where(clear, room, -1.0)))]
        return np.array((view.origin, best))


class Perception:
    """Looks at planning moments. It remembers the obstacles that just left the view, and no other."""

    def __init__(self, briefing: Briefing, beams: Beams, rng: np.random.Generator) -> None:
        self.beams, self.rng = beams, rng
        self.samples = briefing.planner.samples
        self.goal: FloatArray = np.array((briefing.goal.x, briefing.goal.y))
        self.tolerance = briefing.goal.tolerance
        self.inflation = briefing.planner.inflation
        self.clearances = clearances(self.inflation, beams.spacing)
        self.recent = RecentObstacles(RECENT_REACH * self.inflation)

    def look(self, pose: Pose, scan: Ranges, memory: WayPoints) -> LocalMap:
        """Draw a road map in what is seen from here, with the goal and the remembered way points."""
        hidden = self.recent.hidden(pose, self.beams.half_view)
        view = View(self.beams, pose, scan, GRAIN * self.inflation, hidden)
        self.recent.keep(view)
        samples = self._samples(view)
        numbers = memory.of_kind(PLACE | FRONTIER)
        known = numbers[view.visible(memory.xy[numbers])].tolist()
        extras = np.concatenate((self._free_goal(view), memory.xy[known]))
        roadmap = RoadMap(view, samples, extras, self.clearances.way, self.clearances.comfort)
        costs = roadmap.costs()
        reached = np.flatnonzero((roadmap.marks >= 0) & np.isfinite(costs))
        points = dict(zip(roadmap.marks[reached].tolist(), reached.tolist(), strict=True))
        goal = points.pop(0, None)
        reach = {known[mark - 1]: point for mark, point in points.items()}
        return LocalMap(view, samples, roadmap, costs, goal, known, reach)

    def _samples(self, view: View) -> FloatArray:
        """Points to make a road map of, (n, 2) [m]: all over the view, and where ways bend or go on."""
        clearance, comfort = self.clearances.way, self.clearances.comfort
        draws = spread_draws(self.samples, self.rng)
        margin = SPARE_ROOM * clearance
        return np.concatenate(
            (
                sample_fan(view, draws, view.pose.heading, math.pi, clearance),
                outline_end_samples(view, margin),
                corner_samples(view, CORNER_GAP * self.inflation, SPARE_ROOM * comfort),
                goal_sample(view, self.goal, margin),
            )
        )

    def _free_goal(self, view: View) -> FloatArray:
        """The goal, or a free place in its tolerance where the goal itself is not free, (1, 2) [m]."""
        if math.dist(view.origin, self.goal) > self.beams.range:
            return self.goal[None]
        places = self.goal + GOAL_SHIFT * self.tolerance * GOAL_PLACES
        good = np.flatnonzero(view.visible(places) & view.free(places, self.clearances.way)[0])
        return places[good[0], None] if len(good) else self.goal[None]
