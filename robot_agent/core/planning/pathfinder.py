"""Makes the way-finding method that the scenario names."""

import numpy as np

from onehop.contracts.geometry import Pose
from onehop.contracts.scenario import Briefing
from robot_agent.core.planning.escape import Escape
from robot_agent.core.planning.stepwise import Stepwise
from robot_agent.core.planning.survey import SurveyedPathfinder


def make_pathfinder(briefing: Briefing, pose: Pose, rng: np.random.Generator) -> SurveyedPathfinder:
    """A pathfinder for a leader that stands at `pose`; rng is its own random stream."""
    if briefing.planner.kind == "escape":
        return Escape(briefing, pose, rng)
    return Stepwise(briefing, pose, rng, limited=briefing.planner.kind == "modified")
