"""The outline of obstacles as a laser hit it: thinned where hits are dense, filled in along walls.

Hits stand for the obstacle between them. Up to a gap through which no robot fits they are joined; a
wider gap is joined only where the hits before and after it show one wall that the beams graze. Spacing
is in grains, a tenth of the inflation, so that a clearance is known to a few millimetres.
"""

import math

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray

LOOSE = 5.0
"""Gap between hits above which points are put in between, in grains: half an inflation; a point farther
than that from the next would leave a dent in the grown outline."""

PASSABLE = 20.0
"""Gap between hits that a robot may fit through, in grains: twice the inflation."""

COLLINEAR = 0.99
"""Cosine of the bend (8 degrees) up to which three hits lie on one wall."""

WIDENING = 0.6 / math.radians(1.0)
"""How much wider than its neighbour a gap in one wall may be, as a share for each radian between beams.
Where beams d apart meet a wall at an angle a, a gap is wider than the one before by 2 d / a; this admits
walls met at 3.3 degrees and more, whatever the laser."""


def outline(hits: FloatArray, grain: float, spacing: float) -> FloatArray:
    """The same outline with other points, (n, 2) -> (m, 2) [m].

    hits: in the order of the beams, `spacing` apart [rad]. Where they are dense one stays for each step
    of `grain` along the outline [m].
    """
    if len(hits) < 3:
        return hits
    gap = hits[1:] - hits[:-1]
    width = elementary.lengths(gap[:, 0], gap[:, 1])
    step = np.floor(np.cumsum(np.minimum(width, grain)) / grain)
    keep = np.ones(len(hits), dtype=np.bool_)
    keep[1] = step[0] > 0.0
    keep[2:-1] = step[1:-1] > step[:-2]
    joined = (width < PASSABLE * grain) | _in_one_wall(gap, width, 1.0 + WIDENING * spacing)
    wide = np.flatnonzero((width > LOOSE * grain) & joined)
    more = (width[wide] / (LOOSE * grain)).astype(np.intp)
    first = np.repeat(wide, more)
    place = np.arange(1, len(first) + 1) - np.repeat(np.cumsum(more) - more, more)
    between = hits[first] + gap[first] * (place / np.repeat(more + 1, more))[:, None]
    return np.concatenate((hits[keep], between))


def _in_one_wall(gap: FloatArray, width: FloatArray, widest: float) -> BoolArray:
    """Which (n, 2) gaps lie in line with the gap before or after them and are less than `widest` times
    as wide: a wall that the beams graze, not a way through it. width: their lengths, (n,) [m].
    """
    straight = (gap[1:] * gap[:-1]).sum(axis=1) > COLLINEAR * width[1:] * width[:-1]
    one = np.zeros(len(width), dtype=np.bool_)
    one[1:] = straight & (width[1:] < widest * width[:-1])
    one[:-1] |= straight & (width[:-1] < widest * width[1:])
    return one
