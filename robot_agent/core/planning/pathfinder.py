"""Makes the way-finding method that the scenario names."""

from collections.abc import Callable

import numpy as np

from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.plugin_names import PLANNERS
from robot_agent.core.planning.frontier_planner import FrontierPlanner
from robot_agent.core.planning.guidance import Pathfinder
from robot_agent.core.planning.path_planner import PathPlanner
from robot_agent.core.planning.thesis_planner import ThesisPlanner

PlannerMaker = Callable[[Briefing, Pose, np.random.Generator], Pathfinder]
"""Makes a pathfinder for a leader that stands at a pose; its random stream is its own."""


def modified(briefing: Briefing, pose: Pose, rng: np.random.Generator) -> ThesisPlanner:
    """The thesis's planner (3.4) with the fan of directions that it limits."""
    return ThesisPlanner(briefing, pose, rng, limited=True)


def original(briefing: Briefing, pose: Pose, rng: np.random.Generator) -> ThesisPlanner:
    """The planner that the thesis starts from (4.1)."""
    return ThesisPlanner(briefing, pose, rng, limited=False)


BUILT_IN: dict[str, PlannerMaker] = {
    "escape": FrontierPlanner,
    "modified": modified,
    "original": original,
    "path": PathPlanner,
}


def make_pathfinder(briefing: Briefing, pose: Pose, rng: np.random.Generator) -> Pathfinder:
    """A pathfinder for a leader that stands at `pose`; rng is its own random stream.

    `escape` is what scenarios call the frontier planner; `modified` and `original` are the thesis's,
    `path` drives along its saved one. Others are handed in.
    """
    make: PlannerMaker = briefing.plugin(PLANNERS) or BUILT_IN[briefing.planner.kind]
    return make(briefing, pose, rng)
