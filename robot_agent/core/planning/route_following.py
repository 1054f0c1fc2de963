"""Driving along a route over remembered way points, of which the road map shows only the next piece."""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.geometry import wrap_angle
from robot_agent.core.planning.frontier_choice import OUT_OF_VIEW
from robot_agent.core.planning.frontiers import Frontiers
from robot_agent.core.planning.memory import NOTHING
from robot_agent.core.planning.path_tracking import PathTracker
from robot_agent.core.planning.perception import LocalMap

MOST_TRIES = 6
"""Planning moments at which the next piece may be driven towards without being in reach: each draws
other samples, so what none of them reaches is blocked."""

WORTH_DRIVING = 0.5
"""A way point in reach this near is not driven to, in inflations: one further along comes next."""

PASSED = 0.9
"""A way point out of reach this near was passed, in inflations."""


class RouteFollower:
    """Brings a robot to a way point. target: where it goes, or NOTHING. tries: planning moments in which
    the next piece of the route was not in reach.
    """

    def __init__(self, frontiers: Frontiers, tracker: PathTracker, inflation: float) -> None:
        self.frontiers = frontiers
        self.tracker = tracker
        self.inflation = inflation
        self.target = NOTHING
        self.tries = 0

    def aim(self, target: int) -> bool:
        """Go to a way point from now on; says whether it is another one than before."""
        if target == self.target:
            return False
        self.target, self.tries = target, 0
        return True

    def ended(self) -> None:
        """The target is reached, or it is no target any more."""
        self.tries = 0

    @property
    def stuck(self) -> bool:
        """Was the next piece tried often enough?"""
        return self.tries > MOST_TRIES

    def follow(self, local: LocalMap, chain: list[int], forget: bool) -> bool:
        """Take the way to the furthest way point of the chain (target first) that is in reach.

        forget: may a piece that cannot be driven be forgotten? Says whether the robot goes back over
        places where it was.
        """
        pose, xy = local.view.pose, self.frontiers.memory.xy
        here = (pose.x, pose.y)
        for number in chain:
            if number in local.reach and math.dist(here, xy[number]) > WORTH_DRIVING * self.inflation:
                self.tracker.follow(local.roadmap.path(local.reach[number]))
                return len(chain) > 1
        ahead = [n for n in chain if math.dist(here, xy[n]) > PASSED * self.inflation]
        if not ahead:
            self.tracker.face(float(self.frontiers.gaze[chain[0]]))
            return True
        x, y = xy[ahead[-1]].tolist()
        bearing = elementary.atan2(y - pose.y, x - pose.x)
        if abs(wrap_angle(bearing - pose.heading)) > OUT_OF_VIEW:
            self.tracker.face(bearing)
            return True
        self.tries += 1
        if self.stuck and forget:
            self._forget(ahead)
        self.tracker.follow(np.array((here, (x, y))))
        return True

    def _forget(self, ahead: list[int]) -> None:
        """The next piece of the route cannot be driven. ahead: way points to drive to, target first."""
        self.tries = 0
        if len(ahead) == 1:
            self.frontiers.close(ahead[0])
        else:
            self.frontiers.part(ahead[-1], ahead[-2])
