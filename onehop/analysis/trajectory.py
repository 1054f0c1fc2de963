"""One picture of a mission: the map, everyone's path, the formation every 20 s, and what went wrong."""

from pathlib import Path
from textwrap import fill

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.patheffects import withStroke

from onehop.analysis.ground import draw_ground
from onehop.analysis.log import Log
from onehop.analysis.palette import BAD, INK, robot_colours
from onehop.analysis.tables import Table
from onehop.analysis.timeline import LastSeen, begun_faults, departures, leadership
from onehop.contracts.fault_section import FaultSection, fault_in_words
from onehop.contracts.messages import LeadershipTerm
from onehop.contracts.printable import printable
from onehop.wire.log_reader import LogFile

SNAPSHOT_S = 20.0
"""Simulated time between two drawings of the formation [s]."""

_SAMPLE_S = 0.5
"""Status is looked at this often [s]; poses are taken from every tick."""

_NAMED_S = 2.0
"""A lead that lasted less has a ring but no name [s]."""

MOST_FAULTS = 20
"""Faults that the legend has room for."""

_HALO = [withStroke(linewidth=2.5, foreground="white")]


def draw_trajectory(log: LogFile, path: Path) -> None:
    """Write the figure of a mission to `path`; its suffix says the format (png, svg, pdf).

    Raises LogError when the log is damaged.
    """
    mission = Log(log)
    figure = figure_of(mission, _tables(mission))
    FigureCanvasAgg(figure)
    figure.savefig(path, dpi=130)


def figure_of(log: Log, tables: dict[str, Table]) -> Figure:
    """The figure, not yet bound to a canvas; tables: those of _tables."""
    with mpl.rc_context({"text.parse_math": False}):
        figure = Figure(figsize=(10.5, 8.2))
        axes = figure.add_axes((0.06, 0.06, 0.68, 0.89))
        axes.grid(visible=False)
        _draw(axes, log, tables)
    return figure


def _draw(axes: Axes, log: Log, tables: dict[str, Table]) -> None:
    colours = robot_colours(log.robots)
    draw_mission(axes, log, tables)
    gone = departures(tables["poses"], tables["departures"])
    faults = begun_faults(tables["faults"])[:MOST_FAULTS]
    axes.legend(
        handles=_legend(log, gone, faults, colours), loc="upper left", bbox_to_anchor=(1.01, 1.0),
        frameon=False, fontsize=9, borderaxespad=0.0,
    )  # fmt: skip
    axes.set_title(_title(log), loc="left", fontsize=11)


def draw_mission(axes: Axes, log: Log, tables: dict[str, Table], name_holds: bool = True) -> None:
    """Map, paths, formations and what went wrong, without title and legend.

    name_holds: say who is held beside each mark.
    """
    poses, status = tables["poses"], tables["status"]
    colours = robot_colours(log.robots)
    draw_ground(axes, log.bundle, tables["jams"])
    for robot, colour in colours.items():
        carried = [
            tick
            for tick, kind, robots in tables["faults"].rows("tick", "kind", "robots")
            if kind == "kidnap" and robot in robots
        ]
        _draw_path(axes, poses.of(robot), carried, colour)
    radii = {robot: log.scenario.body_of(robot).radius for robot in log.robots}
    _draw_formations(axes, poses, status, colours, radii)
    _draw_holds(axes, poses, colours, name_holds)
    for departure in departures(poses, tables["departures"]):
        _draw_departure(axes, departure, colours[departure.robot])
    for x, y in zip(tables["contacts"]["x"], tables["contacts"]["y"], strict=True):
        axes.plot(x, y, marker="P", color=BAD, markersize=7, zorder=8)
    _draw_leaders(axes, poses, leadership(status, tables["departures"], log.period_ns).main, colours)


def _tables(log: Log) -> dict[str, Table]:
    stride = max(1, log.tick_at(_SAMPLE_S))
    chosen = (
        message
        for message in log.messages("truth", "out/")
        if message.key == "truth" or message.tick % stride == 0
    )
    return log.build(("poses", "status", "departures", "contacts", "jams", "faults"), chosen)


def _draw_path(axes: Axes, own: Table, carried: list[int], colour: str) -> None:
    """carried: ticks with which the robot was put elsewhere."""
    x, y = own["x"].copy(), own["y"].copy()
    x[np.isin(own["tick"], carried)] = np.nan
    away = np.flatnonzero(np.diff(own["tick"]) > 1)
    x[away], y[away] = np.nan, np.nan
    axes.plot(x, y, color=colour, linewidth=1.3, alpha=0.75, zorder=3, solid_capstyle="round")
    if len(own):
        axes.plot(
            x[0], y[0], marker="o", markersize=6, markerfacecolor="white", markeredgecolor=colour,
            markeredgewidth=1.6, zorder=5,
        )  # fmt: skip


def _snapshots(status: Table) -> list[float]:
    """Times of the drawings: every 20 s, and the last moment."""
    if not len(status):
        return []
    end_s = float(status["time_s"][-1])
    regular = [SNAPSHOT_S * k for k in range(1, int(end_s / SNAPSHOT_S) + 1)]
    return [*[time for time in regular if time < end_s - SNAPSHOT_S / 4], end_s]


def _draw_formations(
    axes: Axes, poses: Table, status: Table, colours: dict[int, str], radii: dict[int, float]
) -> None:
    links: list[tuple[tuple[float, float], tuple[float, float]]] = []
    known = np.unique(status["tick"])
    stale: tuple[float, float] = (np.inf, np.inf)
    for time_s in _snapshots(status):
        tick = known[np.searchsorted(status["time_s"][np.searchsorted(status["tick"], known)], time_s)]
        here = poses.where(poses["tick"] == tick)
        said = status.where(status["tick"] == tick)
        places = {
            int(robot): (float(x), float(y))
            for robot, x, y in zip(here["robot"], here["x"], here["y"], strict=True)
        }
        for robot, leader in zip(said["robot"].tolist(), said["leader"].tolist(), strict=True):
            if robot != leader and leader in places and robot in places:
                links.append((places[leader], places[robot]))
        for row, robot in enumerate(here["robot"].tolist()):
            _draw_robot(axes, here, row, colours[robot], radii[robot])
        stale = _label_time(axes, time_s, said, places, stale)
    axes.add_collection(LineCollection(links, colors=INK, linewidths=0.6, alpha=0.55, zorder=3.5))


def _label_time(
    axes: Axes, time_s: float, said: Table, places: dict[int, tuple[float, float]],
    before: tuple[float, float],
) -> tuple[float, float]:  # fmt: skip
    """Write the time beside the leader unless the last label stands there already."""
    acting = [int(i) for i in said["robot"][said["robot"] == said["leader"]] if int(i) in places]
    spot = places[acting[0]] if acting else next(iter(places.values()), before)
    if np.hypot(spot[0] - before[0], spot[1] - before[1]) < 3.0:
        return before
    axes.annotate(
        f"{time_s:.0f} s", spot, textcoords="offset points", xytext=(7, 5), fontsize=7.5, color=INK,
        zorder=9, path_effects=_HALO,
    )  # fmt: skip
    return spot


def _draw_robot(axes: Axes, here: Table, row: int, colour: str, radius: float) -> None:
    """A triangle that can be seen on any map, and the body as large as it is [m]."""
    place = float(here["x"][row]), float(here["y"][row])
    axes.add_patch(Circle(place, radius, facecolor="none", edgecolor=colour, linewidth=0.8, zorder=5))
    heading = float(here["heading"][row])
    axes.plot(
        here["x"][row], here["y"][row], marker=(3, 0, np.degrees(heading) - 90.0), markersize=7.5,
        color=colour, markeredgecolor="white", markeredgewidth=0.5, zorder=5,
    )  # fmt: skip


def _draw_holds(axes: Axes, poses: Table, colours: dict[int, str], named: bool) -> None:
    for robot, colour in colours.items():
        own = poses.of(robot)
        begins = np.flatnonzero(np.diff(own["held"].astype(np.int8), prepend=0) == 1)
        for row in begins:
            axes.plot(
                own["x"][row], own["y"][row], marker="s", markersize=11, markerfacecolor="none",
                markeredgecolor=colour, markeredgewidth=1.8, zorder=7,
            )  # fmt: skip
            if not named:
                continue
            axes.annotate(
                f"{robot} held, {own['time_s'][row]:.0f} s", (own["x"][row], own["y"][row]),
                textcoords="offset points", xytext=(9, -12), fontsize=8, color=INK, zorder=9,
                path_effects=_HALO,
            )  # fmt: skip


def _draw_departure(axes: Axes, departure: LastSeen, colour: str) -> None:
    spot = departure.x, departure.y
    axes.plot(*spot, marker="o", markersize=15, color="white", markeredgecolor=colour, zorder=7)
    axes.plot(*spot, marker="x", markersize=9, color=BAD, markeredgewidth=2.8, zorder=7.5)
    axes.annotate(
        f"{departure.robot} {printable(departure.why, 60)}, {departure.at_s:.0f} s", spot,
        textcoords="offset points", xytext=(12, -4), fontsize=9, fontweight="bold", color=BAD, zorder=9,
        path_effects=_HALO,
    )  # fmt: skip


def _draw_leaders(
    axes: Axes, poses: Table, terms: list[LeadershipTerm], colours: dict[int, str]
) -> None:
    """A ring where somebody takes the lead over from another; those that lasted have their name."""
    ends = [*(term.at_s for term in terms[1:]), np.inf] if terms else []
    previous: int | None = None
    named: list[tuple[float, float]] = []
    for term, end_s in zip(terms, ends, strict=True):
        if previous in (None, term.leader):
            previous = term.leader
            continue
        previous = term.leader
        own = poses.of(term.leader)
        if not len(own):
            continue
        row = min(int(np.searchsorted(own["time_s"], term.at_s)), len(own) - 1)
        spot = float(own["x"][row]), float(own["y"][row])
        axes.plot(
            *spot, marker="o", markersize=14, markerfacecolor="none", markeredgewidth=2.2,
            markeredgecolor=colours[term.leader], zorder=7,
        )  # fmt: skip
        crowded = any(abs(spot[0] - x) < 12.0 and abs(spot[1] - y) < 3.0 for x, y in named)
        if end_s - term.at_s < _NAMED_S or crowded:
            continue
        named.append(spot)
        axes.annotate(
            f"{term.leader} leads, {term.at_s:.0f} s", spot, textcoords="offset points",
            xytext=(-12, 9), ha="right", fontsize=9, fontweight="bold", color=INK, zorder=9,
            path_effects=_HALO,
        )  # fmt: skip


def _legend(
    log: Log, gone: list[LastSeen], faults: list[FaultSection], colours: dict[int, str]
) -> list[Line2D]:
    outcomes = {one.robot: f"{printable(one.why, 60)}, {one.at_s:.0f} s" for one in gone}
    if log.summary is not None:
        lost = {
            entry["robot"]: f"{printable(entry['why'], 60)}, {entry['at_s']:.0f} s"
            for entry in log.summary["lost"]
        }
        outcomes = {**outcomes, **lost, **dict.fromkeys(log.summary["arrived"], "arrived")}
    handles = [
        Line2D(
            [], [], color=colour, marker=(3, 0, -90), markersize=8, linewidth=1.5,
            label=f"{robot}  {outcomes.get(robot, '')}".rstrip(),
        )
        for robot, colour in colours.items()
    ]  # fmt: skip
    ring = {"linestyle": "none", "markerfacecolor": "white", "markeredgecolor": INK}
    handles.append(Line2D([], [], marker="o", markersize=6, label="start", **ring))  # type: ignore[arg-type]
    handles.append(Line2D([], [], color=INK, linewidth=0.6, label="follower to its leader"))
    handles += [
        Line2D(
            [],
            [],
            linestyle="none",
            marker="x",
            markersize=5,
            color=BAD,
            label=fill(f"{f.at_s:g} s: {fault_in_words(f)}", 30),
        )
        for f in faults
    ]
    return handles


def _title(log: Log) -> str:
    scenario = log.scenario
    head = f"{scenario.name}, {len(scenario.team.robots)} robots, seed {scenario.seed}"
    if log.summary is None:
        return f"{head}: the log ends before the mission did"
    return (
        f"{head}: {log.summary['outcome']} after {log.summary['sim_s']:.0f} s "
        f"({printable(log.summary['reason'], 200)})"
    )
