"""The look that all figures of a report share, and how they are written: PNG and SVG, without pyplot."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from onehop.analysis.palette import BAD, FAINT, INK
from onehop.analysis.report.election_rows import elections
from onehop.analysis.report.report_data import ReportData

DPI = 110
"""Resolution of the PNG files: 10 inches are 1100 pixels."""

_COMPRESSION = 3
"""zlib level of the PNG files: 8 % larger than at level 6, and quicker to write."""

_NAME_WIDTH = 0.07
"""Room that the name of a turn takes, as a share of the time axis; where it lacks, there is no name."""

MOST_CHANGES = 100
"""Where the lead changes more often, lines for it would hide everything else, and there are none."""

_STYLE = {
    "text.parse_math": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "font.size": 9.0,
    "xtick.color": INK,
    "ytick.color": INK,
    "svg.fonttype": "none",
    "svg.hashsalt": "onehop",
}


@contextmanager
def styled() -> Iterator[None]:
    """Figures made and written inside look alike; the caller's own settings come back after it."""
    with mpl.rc_context(_STYLE):  # type: ignore[arg-type]
        yield


def save(figure: Figure, folder: Path, stem: str) -> Path:
    """Write folder/stem.png and .svg; returns the PNG."""
    FigureCanvasAgg(figure)
    path = folder / f"{stem}.png"
    figure.savefig(folder / f"{stem}.svg", metadata={"Date": None})
    figure.savefig(path, dpi=DPI, pil_kwargs={"compress_level": _COMPRESSION})
    return path


def mark_turns(axes: Axes, report: ReportData, named: bool = False) -> None:
    """Lines where robots left and where the lead passed on, and red shade while a fault was in force."""
    for span in report.faults:
        axes.axvspan(span.start_s, span.end_s, color="#F3E3E3", linewidth=0, zorder=0)
    turns = [(one.at_s, f"{one.robot} gone", BAD) for one in report.gone]
    changes = elections(report)
    if len(changes) <= MOST_CHANGES:
        turns += [(after.at_s, f"{after.leader} leads", INK) for _, after in changes]
    room = _NAME_WIDTH * report.end_s
    free_from = {BAD: -room, INK: -room}
    for at_s, text, colour in sorted(turns):
        dash = "--" if colour == BAD else ":"
        axes.axvline(at_s, color=colour, linewidth=0.9, linestyle=dash, zorder=1)
        if named and at_s >= free_from[colour]:
            free_from[colour] = at_s + room
            _name(axes, at_s, text, colour)


def _name(axes: Axes, at_s: float, text: str, colour: str) -> None:
    left = colour == BAD
    axes.annotate(
        text, (at_s, 1.0), xycoords=("data", "axes fraction"), xytext=(-3 if left else 3, 2),
        textcoords="offset points", ha="right" if left else "left", fontsize=8, color=colour,
    )  # fmt: skip
