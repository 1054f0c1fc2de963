"""The phase diagram as heat maps: measures under each policy, what changes, and the frontier."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from onehop.analysis.palette import INK
from onehop.campaign.lines import Row
from onehop.contracts.arrays import FloatArray
from onehop.study.comparison import chosen, mean
from onehop.study.in_words import number
from onehop.study.phase.frontier import BETTER_IF_LESS, Effect, Place, edges, effects

LEVELS, CHANGES = "cividis", "PuOr"
"""Colour maps that are read with every common kind of colour blindness."""


class Shown(NamedTuple):
    """A measure of the diagram, its name for people, and how many of its units are one shown."""

    measure: str
    heading: str
    scale: float = 1.0


SHOWN = (
    Shown("lost", "lost robots"),
    Shown("throughput_bps", "throughput [kb/s]", 1e3),
    Shown("below_threshold_s", "below threshold [s]"),
    Shown("error_m", "formation error [m]"),
)


def heat_maps(
    rows: Sequence[Row], columns: Sequence[float], lines: Sequence[float], policies: Sequence[str]
) -> Figure:
    """A row a measure; a column a policy, then one for what each other policy changes from the first.

    columns: k_rho_min [1/s]. lines: lengths of the delay [s].
    """
    changes = [(policies[0], policy) for policy in policies[1:]]
    wide = len(policies) + len(changes)
    figure = Figure(
        figsize=(1.4 + wide * (1.0 + 0.62 * len(columns)), 1.2 + 4 * (0.9 + 0.42 * len(lines))),
        layout="constrained",
    )
    grid = figure.subplots(len(SHOWN), wide, squeeze=False)
    places = [(k, hold_s) for k in columns for hold_s in lines]
    for row, shown in zip(grid, SHOWN, strict=True):
        levels = [_levels(rows, columns, lines, policy, shown) for policy in policies]
        low, high = _ends(levels)
        for axes, policy, values in zip(row, policies, levels, strict=False):
            _draw(axes, values, columns, lines, [[_word(v) for v in line] for line in values])
            axes.images[0].set(cmap=LEVELS, clim=(low, high))
            _contrast(axes, values)
            axes.set_title(f"{shown.heading}, policy “{policy}”", fontsize=9.5, loc="left")
        for axes, change in zip(row[len(policies) :], changes, strict=True):
            effect = effects(rows, places, shown.measure, change)
            _draw_change(axes, effect, columns, lines, shown)
            axes.set_title(f"change: “{change[1]}” − “{change[0]}”", fontsize=9.5, loc="left")
    for axes in grid[-1]:
        axes.set_xlabel("k_rho_min [1/s]")
    for axes in grid[:, 0]:
        axes.set_ylabel("held for [s]")
    return figure


def _levels(
    rows: Sequence[Row], columns: Sequence[float], lines: Sequence[float], policy: str, shown: Shown
) -> FloatArray:
    """(lines, columns) means of a measure, nan where there is none."""
    values = [
        [
            mean(chosen(rows, {"k_rho_min": k, "hold_s": hold_s, "policy": policy}), shown.measure).mean
            for k in columns
        ]
        for hold_s in lines
    ]
    return np.array(values, dtype=np.float64) / shown.scale


def _ends(levels: Sequence[FloatArray]) -> tuple[float, float]:
    known = np.concatenate([one[np.isfinite(one)] for one in levels])
    return (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)


def _draw(
    axes: Axes,
    values: FloatArray,
    columns: Sequence[float],
    lines: Sequence[float],
    words: Sequence[Sequence[str]],
) -> None:
    axes.imshow(values, origin="lower", aspect="auto")
    axes.set_xticks(range(len(columns)), [f"{k:g}" for k in columns])
    axes.set_yticks(range(len(lines)), [f"{hold_s:g}" for hold_s in lines])
    axes.tick_params(length=0)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    for line, row in enumerate(words):
        for column, word in enumerate(row):
            axes.text(column, line, word, ha="center", va="center", fontsize=8)


def _contrast(axes: Axes, values: FloatArray) -> None:
    """White words on dark squares."""
    image = axes.images[0]
    for text in axes.texts:
        x, y = text.get_position()
        red, green, blue, _ = image.cmap(image.norm(values[int(y), int(x)]))
        text.set_color("white" if 0.3 * red + 0.59 * green + 0.11 * blue < 0.5 else INK)


def _draw_change(
    axes: Axes,
    effect: dict[Place, Effect],
    columns: Sequence[float],
    lines: Sequence[float],
    shown: Shown,
) -> None:
    """What changes, violet where it is better; the frontier around the places where it matters."""
    values = np.array(
        [[effect[k, hold_s].estimate.mean for k in columns] for hold_s in lines], dtype=np.float64
    )
    values /= shown.scale
    words = [[_change_word(effect[k, hold_s], shown.scale) for k in columns] for hold_s in lines]
    _draw(axes, values, columns, lines, words)
    most = float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0
    better_if_less = BETTER_IF_LESS[shown.measure]
    most = most or 1.0
    axes.images[0].set(
        cmap=f"{CHANGES}_r" if better_if_less else CHANGES, norm=TwoSlopeNorm(0.0, -most, most)
    )
    _contrast(axes, values)
    for text, one in zip(axes.texts, (effect[k, h] for h in lines for k in columns), strict=True):
        text.set_fontweight("bold" if one.matters else "normal")
    frontier = LineCollection(edges(columns, lines, effect), colors=INK, linewidths=2.4, clip_on=False)
    axes.add_collection(frontier)


def _word(value: float) -> str:
    return number(value) if np.isfinite(value) else ""


def _change_word(effect: Effect, scale: float) -> str:
    value = effect.estimate.mean
    if value is None:
        return ""
    return f"{'+' if value > 0 else ''}{number(value / scale)}"
