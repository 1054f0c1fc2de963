"""The figure of `onehop plan`: map, fan samples, road maps, virtual goals, path, and steps back."""

import io

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from onehop.contracts.arrays import FloatArray
from onehop.drivers.trial import Trial
from onehop.maps.walls import WallMap

_DPI = 110

_UNDATED = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
"""By format, what leaves out of a file that which differs from one writing to the next."""


def plan_figure(
    trial: Trial,
    walls: WallMap,
    goal: tuple[float, float],
    shortest: FloatArray | None,
    file_format: str,
) -> bytes:
    """The figure as a file. shortest: (n, 2) way on the known map [m], or None to leave it out.

    file_format: "png", "svg" or "pdf".
    """
    figure = _drawn(trial, walls, goal, shortest)
    picture = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "onehop"}):
        figure.savefig(picture, format=file_format, dpi=_DPI, metadata=_UNDATED[file_format])
    return picture.getvalue()


def _drawn(
    trial: Trial, walls: WallMap, goal: tuple[float, float], shortest: FloatArray | None
) -> Figure:
    xmin, ymin, xmax, ymax = walls.bounds
    aspect = (ymax - ymin) / (xmax - xmin)
    figure = Figure(figsize=(9.0, min(max(9.0 * aspect, 4.0), 16.0)), layout="constrained")
    axes = figure.add_subplot()
    _road_maps(axes, trial)
    axes.add_collection(
        LineCollection(list(walls.segments.reshape(-1, 2, 2)), colors="#222222", linewidths=1.0)
    )
    if shortest is not None:
        axes.plot(
            *shortest.T,
            color="#2a9d8f",
            linestyle="--",
            linewidth=1.2,
            label="shortest on the known map",
        )
    axes.plot(*trial.path[:, :2].T, color="#1d4ed8", linewidth=1.6, label="path")
    _virtual_goals(axes, trial)
    axes.plot(*trial.path[0, :2], marker="^", color="black", linestyle="", label="start")
    axes.plot(*goal, marker="s", color="#dc2626", linestyle="", label="goal")
    axes.set(xlim=(xmin, xmax), ylim=(ymin, ymax), aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.set_title(f"{trial.answer}: {trial.length:.1f} m, {len(trial.snapshots)} planning moments")
    axes.legend(loc="upper left", fontsize="small", framealpha=0.9)
    return figure


def _road_maps(axes: Axes, trial: Trial) -> None:
    edges = [moment.roadmap.edges.reshape(-1, 2, 2) for moment in trial.snapshots]
    samples = [moment.samples for moment in trial.snapshots]
    if not edges:
        return
    axes.add_collection(
        LineCollection(list(np.concatenate(edges)), colors="#93c5fd", linewidths=0.15, alpha=0.35)
    )
    axes.plot(*np.concatenate(samples).T, ",", color="#9ca3af", alpha=0.6, label="fan samples")


def _virtual_goals(axes: Axes, trial: Trial) -> None:
    ends = [(moment.way[-1], moment.backtrack) for moment in trial.snapshots if len(moment.way)]
    for back, colour, label in ((False, "#f59e0b", "virtual goal"), (True, "#a21caf", "step back")):
        points = np.array([end for end, backtrack in ends if backtrack is back]).reshape(-1, 2)
        axes.plot(*points.T, "o", markersize=3, color=colour, label=label)
