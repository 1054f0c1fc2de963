"""The frames of a film: the map once, and over it the robots, their trails and links.

Only what moves is drawn for each frame, over a copy of the still picture; that takes some milliseconds,
where redrawing the figure takes a hundred.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.backends import backend_agg
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from onehop.analysis.ground import draw_ground
from onehop.analysis.log import Log
from onehop.analysis.palette import BAD, INK, robot_colours
from onehop.analysis.tables import Table
from onehop.contracts.errors import InputError

TRAIL_S = 15.0
"""How long a trail stays behind a robot [s of simulated time]."""

TRAIL_ALPHA = 0.6
"""Opacity of a trail."""

LEAST_BODY = 8.4
"""Diameter of a robot in the picture at least [points]: smaller bodies could not be seen."""

Pixels = npt.NDArray[np.uint8]


class FilmFrames:
    """The still picture and everything that moves over it. size: width and height of a frame [pixels].

    Raises InputError for a log without a tick.
    """

    def __init__(self, log: Log) -> None:
        self._log = log
        tables = log.tables("poses", "status", "jams")
        self._colours = robot_colours(log.robots)
        if not len(tables["poses"]):
            raise InputError(str(log.path), "has not one tick to show", "give a log of a longer mission")
        self._ticks, self._places, self._headings = _tracks(tables["poses"], log.robots)
        self._leaders = _leaders(tables["status"], log.robots, self._ticks)
        figure = Figure(figsize=(7.2, 7.2), dpi=100)
        self._axes = figure.add_axes((0.085, 0.065, 0.90, 0.90))
        draw_ground(self._axes, log.bundle, tables["jams"])
        canvas: Any = backend_agg.FigureCanvasAgg(figure)
        self._canvas = canvas
        self._canvas.draw()
        self._still = self._canvas.copy_from_bbox(figure.bbox)
        width, height = self._canvas.get_width_height()
        self.size = width, height
        self._make_movers()

    def _make_movers(self) -> None:
        """Artists that are moved for each frame."""
        colours = [self._colours[robot] for robot in self._log.robots]
        axes: Any = self._axes
        metre = axes.transData.transform((1.0, 0.0)) - axes.transData.transform((0.0, 0.0))
        points = 72.0 * float(metre[0]) / axes.figure.dpi
        bodies = [2.0 * points * body.radius for body in self._log.scenario.bodies]
        self._trails = [
            Line2D([], [], color=colour, linewidth=1.3, alpha=TRAIL_ALPHA, zorder=3)
            for colour in colours
        ]
        self._links = LineCollection([], colors=INK, linewidths=0.7, alpha=0.6, zorder=4)
        self._bodies: PathCollection = axes.scatter(
            np.zeros(len(colours)), np.zeros(len(colours)), c=colours, edgecolors="white",
            s=[max(LEAST_BODY, size) ** 2 for size in bodies],
            linewidths=0.8, zorder=5,
        )  # fmt: skip
        self._noses = LineCollection([], colors=INK, linewidths=1.4, zorder=6)
        self._crosses = Line2D(
            [], [], linestyle="none", marker="x", color=BAD, markersize=9, markeredgewidth=2.5, zorder=7
        )
        self._clock = axes.text(
            0.01, 0.985, "", transform=axes.transAxes, va="top", fontsize=11, zorder=8
        )
        for artist in (*self._trails, self._crosses):
            axes.add_line(artist)
        for collection in (self._links, self._noses):
            axes.add_collection(collection)

    def frames(self, step_s: float) -> Iterator[Pixels]:
        """(height, width, 3) uint8 pictures, one every step_s of simulated time, and the last moment."""
        stride = max(1, round(step_s * 1e9 / self._log.period_ns))
        rows = [*range(0, len(self._ticks), stride)]
        for row in [*rows, len(self._ticks) - 1]:
            yield self._draw(row)

    def _draw(self, row: int) -> Pixels:
        self._canvas.restore_region(self._still)
        self._place(row)
        renderer = self._canvas.get_renderer()
        movers = [*self._trails, self._links, self._bodies, self._noses, self._crosses, self._clock]
        for artist in movers:
            artist.draw(renderer)
        return np.asarray(self._canvas.buffer_rgba())[:, :, :3].copy()

    def _place(self, row: int) -> None:
        period_s = self._log.period_ns / 1e9
        here, trail = self._places[row], max(0, row - round(TRAIL_S / period_s))
        for number, line in enumerate(self._trails):
            line.set_data(
                self._places[trail : row + 1, number, 0], self._places[trail : row + 1, number, 1]
            )
        self._bodies.set_offsets(here)
        nose = 1.3 * np.column_stack((np.cos(self._headings[row]), np.sin(self._headings[row])))
        self._noses.set_segments(list(np.stack((here, here + nose), axis=1)))
        self._links.set_segments(
            [
                np.array([here[leader], here[number]])
                for number, leader in enumerate(self._leaders[row].tolist())
                if leader >= 0 and leader != number
            ]
        )
        gone = self._gone(row)
        self._crosses.set_data(gone[:, 0], gone[:, 1])
        self._clock.set_text(f"{self._log.scenario.name}   {self._ticks[row] * period_s:6.1f} s")

    def _gone(self, row: int) -> npt.NDArray[np.float64]:
        """Last places of those that are not there now but were."""
        absent = np.flatnonzero(np.isnan(self._places[row, :, 0]))
        spots = []
        for number in absent.tolist():
            seen = np.flatnonzero(np.isfinite(self._places[:row, number, 0]))
            if len(seen):
                spots.append(self._places[seen[-1], number])
        return np.array(spots).reshape(-1, 2)


def _tracks(
    poses: Table, robots: tuple[int, ...]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Ticks (n,), places (n, robots, 2) [m], headings (n, robots) [rad]; nan while a robot is away."""
    ticks, rows = np.unique(poses["tick"], return_inverse=True)
    columns = np.searchsorted(np.array(robots), poses["robot"])
    places = np.full((len(ticks), len(robots), 2), np.nan)
    headings = np.full((len(ticks), len(robots)), np.nan)
    places[rows, columns, 0], places[rows, columns, 1] = poses["x"], poses["y"]
    headings[rows, columns] = poses["heading"]
    return ticks, places, headings


def _leaders(
    status: Table, robots: tuple[int, ...], ticks: npt.NDArray[np.int64]
) -> npt.NDArray[np.int64]:
    """Column of the leader that each robot obeys, (n, robots); -1 for none."""
    leaders = np.full((len(ticks), len(robots)), -1, dtype=np.int64)
    rows = np.searchsorted(ticks, status["tick"]).clip(0, len(ticks) - 1)
    columns = np.searchsorted(np.array(robots), status["robot"])
    known = np.isin(status["leader"], np.array(robots))
    leaders[rows[known], columns[known]] = np.searchsorted(np.array(robots), status["leader"][known])
    return leaders
