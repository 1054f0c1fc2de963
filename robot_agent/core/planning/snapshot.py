"""What a pathfinder did at one planning moment, for whoever wants to look at it."""

from dataclasses import dataclass
from typing import Protocol

from onehop.contracts.arrays import FloatArray
from onehop.contracts.geometry import Pose
from robot_agent.core.planning.guidance import Pathfinder
from robot_agent.core.planning.roadmap import RoadMap


@dataclass(frozen=True, slots=True)
class PlanningSnapshot:
    """One planning moment, map frame [m].

    samples: (n, 2) points drawn. roadmap: what was made of them. way: (p, 2) taken, ending at the
    virtual goal; empty when the robot only turns. backtrack: it goes back to where it was.
    """

    pose: Pose
    samples: FloatArray
    roadmap: RoadMap
    way: FloatArray
    backtrack: bool


class ObservablePathfinder(Pathfinder, Protocol):
    """A pathfinder that shows its last planning moment; a new one is a new object."""

    snapshot: PlanningSnapshot | None
