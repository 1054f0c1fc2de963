"""The figures of 4.1 and 3.4: both planners at map 1's corner, and several ways over one map."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from onehop.analysis.palette import BAD, INK, OKABE_ITO, WALL, WALL_EDGE
from onehop.analysis.report.canvas import save, styled
from onehop.campaign.lines import Row
from onehop.maps.map_file import load_map
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.study.chapter4.ways import DRAWN, LIMIT_S, MODIFIED, PLANNERS
from onehop.study.comparison import chosen
from onehop.study.page import Picture


def draw(scenarios: Path, rows: Sequence[Row], folder: Path) -> list[Picture]:
    """Write both figures."""
    bundle = scenario_file.load(scenarios / "map1.toml")
    with styled():
        return [
            Picture(
                "Original and modified PRM at map 1's corner",
                "One leader alone, the same seed: the way in the time that it had. Cross: where it was "
                f"after {LIMIT_S:g} s. Thesis: fig. 4.1.",
                save(_corner(bundle, rows), folder, "ways-corner"),
            ),
            Picture(
                "Ways of Algorithm 2 over one map",
                f"The first {DRAWN} seeds: another way each time. Thesis: fig. 3.7.",
                save(_many(bundle, rows), folder, "ways-modified"),
            ),
        ]


def _corner(bundle: Bundle, rows: Sequence[Row]) -> Figure:
    figure = Figure(figsize=(11.0, 5.6), layout="constrained")
    for axes, planner in zip(figure.subplots(1, 2), PLANNERS, strict=True):
        _ground(axes, bundle)
        kept = [row for row in chosen(rows, {"planner": planner}) if row["way"] is not None]
        if kept:
            _way(axes, kept[0], OKABE_ITO[0])
            word = "arrived after" if kept[0]["arrived"] else "not there after"
            title = f"{planner}, seed {kept[0]['seed']}: {word} {kept[0]['sim_s']:.0f} s"
            axes.set_title(title, loc="left", fontsize=10)
    return figure


def _many(bundle: Bundle, rows: Sequence[Row]) -> Figure:
    figure = Figure(figsize=(7.2, 7.0), layout="constrained")
    axes = figure.subplots()
    _ground(axes, bundle)
    kept = [row for row in chosen(rows, {"planner": MODIFIED}) if row["way"] is not None]
    for place, row in enumerate(kept):
        _way(axes, row, OKABE_ITO[place % len(OKABE_ITO)])
    there = sum(row["arrived"] for row in kept)
    axes.set_title(f"{there} of {len(kept)} leaders arrive", loc="left", fontsize=10)
    return figure


def _ground(axes: Axes, bundle: Bundle) -> None:
    scenario = bundle.scenario
    walls = load_map(scenario.map, bundle.files)
    xmin, ymin, xmax, ymax = walls.bounds
    polygons = [np.array(obstacle) for obstacle in scenario.map.obstacles]
    axes.add_collection(PolyCollection(polygons, facecolors=WALL, edgecolors=WALL_EDGE, zorder=1))
    segments = list(walls.segments.reshape(-1, 2, 2))
    axes.add_collection(LineCollection(segments, colors=WALL_EDGE, linewidths=1.0, zorder=1))
    axes.plot(scenario.start.x, scenario.start.y, marker="^", color=INK, zorder=5)
    axes.plot(scenario.goal.x, scenario.goal.y, marker="s", color=OKABE_ITO[0], zorder=5)
    axes.grid(visible=False)
    axes.set(xlim=(xmin, xmax), ylim=(ymin, ymax), aspect="equal", xlabel="x [m]", ylabel="y [m]")


def _way(axes: Axes, row: Row, colour: str) -> None:
    x, y = np.array(row["way"]).T
    axes.plot(x, y, color=colour, linewidth=1.1, alpha=0.85, zorder=3)
    if not row["arrived"]:
        axes.plot(x[-1], y[-1], marker="x", color=BAD, markersize=9, markeredgewidth=2.4, zorder=6)
