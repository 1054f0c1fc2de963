"""Where what is seen borders on the unseen, and which places of a road map lie there.

Frontiers are regions on the boundary between open space and unexplored space (Yamauchi, "A
frontier-based approach for autonomous exploration", CIRA 1997). Of that border only what lies beside an
obstacle or closer to the goal than ever before counts: a shortest way bends nowhere else, so these are
the nodes of TangentBug's local tangent graph (Kamon, Rimon and Rivlin, "TangentBug", IJRR 17(9), 1998).
"""

import math
from typing import NamedTuple

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from robot_agent.core.planning.distances import squared_distances
from robot_agent.core.planning.memory import Indices
from robot_agent.core.planning.perception import LocalMap
from robot_agent.core.planning.view import View

SHADOW_WIDTH = 2.0
"""Jump of the range between neighbouring beams that casts a shadow to look into, in inflations: nothing
narrower lets the robot through."""

SHADOW_BEGINS = 0.25
"""How far behind the nearer beam's end its shadow begins, in its widths."""

SHADOW_STEP = 0.7
"""Spacing of the points along a shadow's edge, in its widths."""

OPEN_SPACING = math.radians(4.0)
"""Spacing of the border's points where nothing is in range [rad]: 0.7 m at 10 m."""

BORDER_REACH = 3.0
"""A place this near to the border lies beside it, in inflations: from there the robot sees across."""


class Border(NamedTuple):
    """points: (n, 2) of the border [m], map frame. outward: (n,) direction to the unseen side [rad]."""

    points: FloatArray
    outward: FloatArray


class Candidates(NamedTuple):
    """Places where a frontier can be: points of a road map that a way leads to and that lie beside the
    border, `indices`, ascending.

    Of all points of the road map: points, (n, 2), the robot first [m]; costs, (n,) of the way there [m];
    outward, (n,) direction to the unseen [rad].
    """

    indices: Indices
    points: FloatArray
    costs: FloatArray
    outward: FloatArray


def border(view: View, width: float, goal: FloatArray, record: float) -> Border:
    """The border of what is seen.

    It runs along the edges of shadows, where the ranges of neighbouring beams differ by more than
    `width` [m], and at the end of open beams: of those beside an obstacle whose outline leaves the
    laser's range, and of those that end closer to the goal than `record` [m].
    """
    sight, beams = view.sight, view.beams
    heading = beams.angles + view.pose.heading
    ends = view.origin + view.directions * sight[:, None]
    border_beams = view.outline_ends.copy()
    some = slice(None, None, beams.spanned(OPEN_SPACING))
    closer = elementary.lengths(*(ends[some] - goal).T) < record
    border_beams[some] |= ~view.solid[some] & closer
    far = np.flatnonzero(border_beams)
    points = [ends[far]]
    outward = [heading[far]]
    for beam in np.flatnonzero(np.abs(np.diff(sight)) > width).tolist():
        left_is_far = sight[beam + 1] > sight[beam]
        near, long = (beam, beam + 1) if left_is_far else (beam + 1, beam)
        radius = np.arange(sight[near] + SHADOW_BEGINS * width, sight[long], SHADOW_STEP * width)
        points.append(view.origin + view.directions[long] * radius[:, None])
        aside = -math.pi / 2 if left_is_far else math.pi / 2
        outward.append(np.full(len(radius), heading[long] + aside))
    return Border(np.concatenate(points), np.concatenate(outward))


def candidates(local: LocalMap, seen: Border, reach: float) -> Candidates:
    """The points of the road map within `reach` of the border [m], but for the robot itself."""
    points = local.roadmap.points
    distance2 = squared_distances(points, seen.points)
    beside = distance2.min(axis=1, initial=np.inf) < reach * reach
    beside[0] = False
    outward = np.zeros(len(points))
    if len(seen.points):
        outward = seen.outward[distance2.argmin(axis=1)]
    return Candidates(np.flatnonzero(np.isfinite(local.costs) & beside), points, local.costs, outward)
