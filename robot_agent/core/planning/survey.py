"""What a pathfinder did at one planning moment, for whoever wants to look at it."""

from dataclasses import dataclass
from typing import Protocol

from onehop.contracts.geometry import Pose
from robot_agent.core.planning.guidance import Pathfinder
from robot_agent.core.scan import FloatArray


@dataclass(frozen=True, slots=True)
class Survey:
    """One planning moment, map frame [m].

    samples: (n, 2) points drawn. points: (m, 2) of the road map, edges: (k, 4) x0, y0, x1, y1.
    way: (p, 2) taken, ending at the virtual goal; empty when the robot only turns. backtrack: it goes
    back to where it was.
    """

    pose: Pose
    samples: FloatArray
    points: FloatArray
    edges: FloatArray
    way: FloatArray
    backtrack: bool


class SurveyedPathfinder(Pathfinder, Protocol):
    """A pathfinder that shows its last planning moment; a new one is a new object."""

    survey: Survey | None
