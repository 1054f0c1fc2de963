"""Draw a mission's map: what is filled, its outline, start and goal, jammed discs."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.patches import Circle

from onehop.analysis.palette import BAD, INK, WALL, WALL_EDGE
from onehop.analysis.tables import Table
from onehop.contracts.scenario import Scenario
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from onehop.scenario.bundle import Bundle

_RASTER = 700
"""Points along the longer side at which a grid map is asked what is filled."""


def draw_ground(axes: Axes, bundle: Bundle, jams: Table) -> None:
    """Map, goal and what was jammed, axes in metres, at equal scale. jams: the table of that name."""
    walls = load_map(bundle.scenario.map, bundle.files)
    xmin, ymin, xmax, ymax = walls.bounds
    obstacles = bundle.scenario.map.obstacles
    if bundle.scenario.map.file:
        _fill(axes, walls)
    else:
        axes.add_collection(PolyCollection([np.array(o) for o in obstacles], facecolors=WALL, zorder=1))
    segments: Any = walls.segments.reshape(-1, 2, 2)
    axes.add_collection(LineCollection(segments, colors=WALL_EDGE, linewidths=1.0, zorder=1.1))
    _draw_goal(axes, bundle.scenario)
    for x, y, radius in sorted(set(jams.rows("x", "y", "radius"))):
        axes.add_patch(
            Circle(
                (x, y), radius, facecolor="none", edgecolor=BAD, hatch="..",
                linestyle="--", linewidth=0.8, alpha=0.5, zorder=1.2,
            )
        )  # fmt: skip
    margin = 0.02 * max(xmax - xmin, ymax - ymin)
    axes.set_xlim(xmin - margin, xmax + margin)
    axes.set_ylim(ymin - margin, ymax + margin)
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


def _fill(axes: Axes, walls: WallMap) -> None:
    xmin, ymin, xmax, ymax = walls.bounds
    cell = max(xmax - xmin, ymax - ymin) / _RASTER
    x, y = np.arange(xmin + cell / 2, xmax, cell), np.arange(ymin + cell / 2, ymax, cell)
    points = np.column_stack([part.ravel() for part in np.meshgrid(x, y)])
    filled = walls.ground.solid(points).reshape(len(y), len(x))
    axes.imshow(
        np.ma.masked_equal(filled, False), cmap=ListedColormap([WALL]), origin="lower",
        extent=(xmin, xmax, ymin, ymax), interpolation="nearest", zorder=1,
    )  # fmt: skip


def _draw_goal(axes: Axes, scenario: Scenario) -> None:
    goal = scenario.goal
    axes.add_patch(Circle((goal.x, goal.y), goal.tolerance, fill=False, edgecolor=INK, zorder=4))
    axes.plot(goal.x, goal.y, marker="*", markersize=15, color="#F0E442", markeredgecolor=INK, zorder=6)
    axes.annotate(
        "goal", (goal.x, goal.y), textcoords="offset points", xytext=(0, -19), ha="center", fontsize=9
    )
