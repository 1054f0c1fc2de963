"""The figure: ratio of throughput to ns-3's, with its 95 % interval, one row a case."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from onehop.analysis.palette import BAD, INK

from .tables import TOLERANCE, Row

REACH = 0.15
"""The axis goes so far to both sides of 1; what lies outside is an arrow with its number."""
COLUMNS = (("link", "chain", "exposed"), ("cell", "hidden", "reuse"))
INSIDE, OPEN = "#15803d", "#b45309"


def draw(rows: Sequence[Row], path: Path) -> None:
    """Write the figure to `path` (svg)."""
    figure = Figure(figsize=(11.0, 9.0), layout="constrained")
    for axes, groups in zip(figure.subplots(1, 2), COLUMNS, strict=True):
        _panel(axes, [row for group in groups for row in rows if row.group == group])
    figure.suptitle("Throughput of Onehop by that of ns-3, 95 % interval", color=INK)
    with mpl.rc_context({"svg.hashsalt": "onehop", "svg.fonttype": "none"}):
        figure.savefig(path, metadata={"Date": None})


def _panel(axes: Axes, rows: Sequence[Row]) -> None:
    axes.axvspan(1.0 - TOLERANCE, 1.0 + TOLERANCE, color="#dcfce7", zorder=0)
    axes.axvline(1.0, color=INK, linewidth=0.6, zorder=1)
    for y, row in enumerate(rows):
        _case(axes, y, row)
    axes.set_yticks(range(len(rows)), [f"{row.group}: {row.what}" for row in rows], fontsize=6.5)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlim(1.0 - REACH, 1.0 + REACH)
    axes.tick_params(labelsize=6.5, length=0)
    axes.grid(axis="x", linewidth=0.3, color="#cbd5e1")
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)


def _case(axes: Axes, y: int, row: Row) -> None:
    found = row.ratio("mbps")
    if found is None:
        return
    apart = found.high < 1.0 - TOLERANCE or found.low > 1.0 + TOLERANCE
    colour = INSIDE if found.within(TOLERANCE) else BAD if apart else OPEN
    if abs(found.value - 1.0) > REACH:
        edge, marker = (1.0 + 0.97 * REACH, ">") if found.value > 1.0 else (1.0 - 0.97 * REACH, "<")
        axes.plot(edge, y, marker=marker, color=colour, markersize=5)
        axes.annotate(
            f"{found.value:.2f}",
            (edge, y),
            xytext=(-6 if found.value > 1.0 else 6, 0),
            textcoords="offset points",
            ha="right" if found.value > 1.0 else "left",
            va="center",
            fontsize=6.5,
            color=colour,
        )
        return
    axes.plot((found.low, found.high), (y, y), color=colour, linewidth=1.4, solid_capstyle="butt")
    axes.plot(found.value, y, marker="o", color=colour, markersize=3.5)
