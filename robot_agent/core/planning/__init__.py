"""Way-finding: from laser scans to a twist that brings a leader to its goal."""

from robot_agent.core.planning.guidance import Guidance, Pathfinder, PlannerStatus
from robot_agent.core.planning.pathfinder import make_pathfinder

__all__ = ["Guidance", "Pathfinder", "PlannerStatus", "make_pathfinder"]
