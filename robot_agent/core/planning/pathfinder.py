"""Makes the way-finding method that the scenario names."""

import numpy as np

from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose
from robot_agent.core.planning.frontier_planner import FrontierPlanner
from robot_agent.core.planning.path_planner import PathPlanner
from robot_agent.core.planning.snapshot import ObservablePathfinder
from robot_agent.core.planning.thesis_planner import ThesisPlanner


def make_pathfinder(briefing: Briefing, pose: Pose, rng: np.random.Generator) -> ObservablePathfinder:
    """A pathfinder for a leader that stands at `pose`; rng is its own random stream.

    `escape` is what scenarios call the frontier planner; `modified` and `original` are the thesis's,
    `path` drives along its saved one.
    """
    if briefing.planner.kind == "escape":
        return FrontierPlanner(briefing, pose, rng)
    if briefing.planner.kind == "path":
        return PathPlanner(briefing, pose, rng)
    return ThesisPlanner(briefing, pose, rng, limited=briefing.planner.kind == "modified")
