"""The interface between way-finding and the team: what a leader asks at every tick, and what it gets."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from onehop.contracts.arrays import Ranges
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Note

ARRIVED_WITHIN = 0.6
"""Distance from the goal at which a leader has arrived, in the goal's tolerances: below 1, so that
nothing that is measured afterwards finds it outside."""


class PlannerStatus(StrEnum):
    """How far a pathfinder is."""

    DRIVING = "driving"
    ARRIVED = "arrived"
    NO_WAY = "no way to the goal"


@dataclass(frozen=True, slots=True)
class Guidance:
    """One tick of way-finding. status: how far the pathfinder is.

    remaining: estimate of the distance still to drive [m]. passage: free width of the passage that the
    robot is in or about to enter, seen by the laser to both sides [m]; inf in the open.
    waypoint: virtual goal in force, map frame [m].
    """

    twist: Twist
    status: PlannerStatus
    remaining: float
    passage: float
    waypoint: tuple[float, float]
    notes: tuple[Note, ...]


class Pathfinder(Protocol):
    """A way-finding method. One instance serves one leadership term; a new leader starts a new one."""

    def step(self, pose: Pose, scan: Ranges) -> Guidance:
        """Decide the twist for this tick."""
        ...
