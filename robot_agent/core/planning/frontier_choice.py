"""Which frontier is the most promising, and the way over way points to it.

Under the freespace assumption (Koenig, Tovey and Smirnov, "Performance bounds for planning in unknown
terrain", Artificial Intelligence 147, 2003) the best frontier has the least sum of the known way to it
and the straight distance from it to the goal. Differs: that distance weighs more (GOAL_WEIGHT), and a
frontier with a wall right before it towards the goal counts as farther (WALLS_GO_ON), because a leader
that only just passed a door would otherwise go on along the wall for ever.
"""

import math
from typing import NamedTuple

from onehop.contracts import elementary
from onehop.contracts.geometry import Pose, wrap_angle
from robot_agent.core.planning.frontiers import Frontiers
from robot_agent.core.planning.memory import FRONTIER, NOTHING, PLACE
from robot_agent.core.planning.path_tracking import Point

GOAL_WEIGHT = 1.3
"""Weight of the straight distance to the goal against the way to a frontier. At 1 a robot that went past
a door goes on along the wall for ever: every step away from the door makes it cost as much more."""

WALLS_GO_ON = 0.5
"""Way that a frontier with a wall between it and the goal is taken to cost more, in laser ranges: a wall
that leaves the view is likelier to go on than to end right there."""

CLEARLY = 1.0
"""How much better another frontier must be to give up the present one, in spacings of frontiers."""

OUT_OF_VIEW = 1.2
"""Bearing from which a way point may lie out of view [rad]: near the edge of a view of 180 degrees a
place counts as seen only with room beside it."""


class Route(NamedTuple):
    """A way over way points to `target`, `cost` long [m]; target NOTHING: there is none.

    origin: where each way point on it is reached from.
    """

    target: int
    cost: float
    origin: dict[int, int]

    def chain(self) -> list[int]:
        """Its way points, the target first."""
        chain = [self.target]
        while self.origin[chain[-1]] != NOTHING:
            chain.append(self.origin[chain[-1]])
        return chain


def best_frontier(frontiers: Frontiers, seeds: dict[int, float], kept: int, wall: float) -> Route:
    """To the reachable frontier of the least estimate, or to `kept` if none is clearly better.

    seeds: way points in reach and their costs [m]. wall: what a walled frontier costs more [m]. No
    frontier that costs more than the best one's estimate can be better, so the search ends there.
    """
    memory, goal, margin = frontiers.memory, frontiers.goal, CLEARLY * frontiers.spacing
    origin: dict[int, int] = {}
    best, value, kept_cost, best_cost = NOTHING, math.inf, math.inf, math.inf
    for number, cost in memory.routes(seeds, origin):
        if cost > value + margin:
            break
        if memory.kind[number] == FRONTIER:
            estimate = cost + GOAL_WEIGHT * math.dist(memory.xy[number], goal)
            if frontiers.walled[number]:
                estimate += wall
            if (estimate, number) < (value, best):
                best, value, best_cost = number, estimate, cost
            if number == kept:
                kept_cost, kept_value = cost, estimate
    if kept_cost < math.inf and kept_value <= value + margin:
        return Route(kept, kept_cost, origin)
    return Route(best, best_cost, origin)


def closest_place(frontiers: Frontiers, seeds: dict[int, float]) -> Route:
    """To the reachable place that is closest to the goal."""
    memory, goal = frontiers.memory, frontiers.goal
    origin: dict[int, int] = {}
    costs = {
        number: cost for number, cost in memory.routes(seeds, origin) if memory.kind[number] == PLACE
    }
    best = min(costs, key=lambda n: (math.dist(memory.xy[n], goal), n))
    return Route(best, costs[best], origin)


class Sighting(NamedTuple):
    """A way point that was in reach: where it was, what it cost [m], and from where."""

    place: Point
    cost: float
    seen_from: Point


class RecentReach:
    """Way points that were in reach a moment ago and are now behind the robot.

    Without them one would seem to be farther off than before because the robot turned its back to it,
    and it would turn back, and so on.
    """

    def __init__(self) -> None:
        self._sightings: dict[int, Sighting] = {}

    def complete(self, frontiers: Frontiers, pose: Pose, seeds: dict[int, float]) -> dict[int, float]:
        """What is in reach now, with costs [m], and what still is because it was; remembers both."""
        memory, here, found = frontiers.memory, (pose.x, pose.y), {}
        for number, ((x, y), cost, seen_from) in self._sightings.items():
            moved = math.dist(seen_from, here)
            same = memory.kind[number] & (PLACE | FRONTIER) and (x, y) == tuple(memory.xy[number])
            bearing = wrap_angle(elementary.atan2(y - pose.y, x - pose.x) - pose.heading)
            behind = abs(bearing) > OUT_OF_VIEW
            if number not in seeds and same and moved < frontiers.spacing and behind:
                found[number] = cost + moved
        now = {n: Sighting(tuple(memory.xy[n].tolist()), cost, here) for n, cost in seeds.items()}
        self._sightings = {n: self._sightings[n] for n in found} | now
        return seeds | found
