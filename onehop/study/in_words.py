"""Numbers for people: three digits that count, and an interval behind a mean."""

from collections.abc import Mapping
from typing import Any


def number(value: float) -> str:
    """Three digits that count, and no powers of ten."""
    if abs(value) >= 100.0:
        return f"{value:.0f}"
    return f"{round(value, 3):z.3g}"


def interval(mean: float | None, low: float | None, high: float | None, scale: float = 1.0) -> str:
    """A mean with its 95 % interval, in units of `scale`: "0.8 [0.3, 1.3]"; "-" if there is none."""
    if mean is None:
        return "-"
    if low is None or high is None:
        return number(mean / scale)
    return f"{number(mean / scale)} [{number(low / scale)}, {number(high / scale)}]"


def told(cell: Mapping[str, Any], name: str, scale: float = 1.0) -> str:
    """A mean of a cell of a study (cell_summary.py) with its interval."""
    low, high = cell[f"{name.removesuffix('_mean')}_ci95"]
    return interval(cell[name], low, high, scale)
