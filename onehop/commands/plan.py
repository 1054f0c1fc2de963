"""`onehop plan`: one leader alone finds its way through a map that it does not know."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

from onehop.analysis.driven_path import in_toml, saved_path
from onehop.analysis.shortest import KnownMap, way_length
from onehop.commands.output import emit_json
from onehop.contracts.arrays import FloatArray
from onehop.contracts.errors import InputError
from onehop.contracts.scenario import Scenario
from onehop.drivers.trial import Trial, run_trial
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from onehop.programs.find import search_in
from onehop.scenario import scenario_file
from onehop.wire.output_folder import explained, require_writable

PICTURES = (".png", ".svg", ".pdf")
"""Endings of a figure's name; each says how it is written."""

RASTER_CELLS = 400
"""Cells along the longer side of the map in which the shortest way is searched."""


def plan(
    map_file: Path,
    start: str | None,
    goal: str | None,
    planner: str | None,
    seed: int | None,
    cell: float | None,
    settings: list[str],
    figure: Path | None,
    path: Path | None,
    as_json: bool,
) -> int:
    """Find the way once; exit status 1 when the goal was not reached."""
    if figure is not None:
        _require_picture(figure)
    if path is not None:
        require_writable(path)
    bundle = scenario_file.load_map_mission(
        map_file,
        scenario_file.point(start, "--start"),
        scenario_file.point(goal, "--goal"),
        _changes(settings, planner, cell),
        seed,
    )
    scenario = bundle.scenario
    search_in(bundle.folder)
    walls = load_map(scenario.map, bundle.files)
    with scenario_file.in_file(map_file):
        run = run_trial(scenario, walls)
    first = run.path[0]
    target = (scenario.goal.x, scenario.goal.y)
    shortest = _shortest(walls, scenario.planner.inflation, (first[0], first[1]), target)
    summary: dict[str, Any] = {
        **run.summary(),
        "shortest_m": None if shortest is None else round(way_length(shortest), 3),
    }
    if figure is not None:
        from onehop.analysis.plan_figure import plan_figure

        with explained(figure, "a folder with room for it"):
            figure.write_bytes(plan_figure(run, walls, target, shortest, figure.suffix.lower()[1:]))
    if path is not None and summary["reached"]:
        _save_path(path, run, scenario, walls)
    if as_json:
        emit_json(summary)
    else:
        _print(summary, run, figure)
    return 0 if summary["reached"] else 1


def _changes(settings: list[str], planner: str | None, cell: float | None) -> list[str]:
    """The settings, with the options that stand for one."""
    changes = [*settings]
    if planner is not None:
        changes.append(f"planner.kind={planner}")
    if cell is not None:
        changes.append(f"map.cell={cell}")
    return changes


def _require_picture(figure: Path) -> None:
    """Raise InputError, before the plan is driven, for a figure that could not be written."""
    if figure.suffix.lower() not in PICTURES:
        raise InputError(f"--figure {figure}", "its ending says no format", " or ".join(PICTURES))
    require_writable(figure)


def _save_path(path: Path, run: Trial, scenario: Scenario, walls: WallMap) -> None:
    """Write what was driven as a section of a scenario."""
    goal = (scenario.goal.x, scenario.goal.y)
    corners = saved_path(run.path[:, :2], goal, walls, scenario.planner.inflation)
    legs = sum(math.dist(here, there) for here, there in pairwise(corners))
    remark = f"Driven by planner {scenario.planner.kind}, seed {scenario.seed}, its loops left out: "
    with explained(path, "a folder with room for it"):
        path.write_text(in_toml(corners, f"{remark}{legs:.0f} m."))


def _shortest(
    walls: WallMap, inflation: float, start: tuple[float, float], goal: tuple[float, float]
) -> FloatArray | None:
    """Taut way on the known map for the inflated robot, (n, 2) [m]."""
    xmin, ymin, xmax, ymax = walls.bounds
    known = KnownMap(walls, inflation, max(xmax - xmin, ymax - ymin) / RASTER_CELLS)
    return known.shortest(start, known.distances(goal))


def _print(summary: dict[str, Any], run: Trial, figure: Path | None) -> None:
    print(f"answer         {run.answer}")
    print(f"path           {summary['path_length_m']:.1f} m in {summary['steps']} ticks")
    shortest = summary["shortest_m"]
    if shortest is not None:
        times = shortest > 0 and summary["reached"]
        ratio = f": {summary['path_length_m'] / shortest:.2f} times as far" if times else ""
        print(f"shortest       {shortest:.1f} m on the known map{ratio}")
    else:
        print("shortest       none: the known map has no way for the inflated robot")
    print(f"planning       {summary['replans']} road maps, {summary['backtracks']} steps back")
    print(f"plan time      p50 {summary['plan_ms_p50']:.2f} ms, p99 {summary['plan_ms_p99']:.2f} ms")
    print(
        f"clearance      {summary['min_clearance_m']:.2f} m at the least, {summary['contacts']} contacts"
    )
    if figure is not None:
        print(f"figure         {figure}")
