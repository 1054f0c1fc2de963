"""What a leader drove, as a path that a scenario can give (`planner.path`).

Loops are left out: where it came back to a place, it goes on from there. The rest is thinned to the
corners of a polyline that stays beside what was driven and keeps the inflation from the walls.
"""

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from onehop.contracts.errors import InputError
from onehop.contracts.sections import MOST_PATH_POINTS, Point
from onehop.maps.walls import WallMap, segment_distances

BESIDE = 0.2
"""Distance from what was driven, at most [m]."""

SAME_PLACE = 0.5
"""A place this near to an earlier one closes a loop, in inflations."""


def saved_path(driven: FloatArray, goal: Point, walls: WallMap, inflation: float) -> tuple[Point, ...]:
    """The path along what was driven, (n, 2) [m], and to the goal, in whole centimetres.

    InputError when it comes nearer to a wall than the inflation, whatever its corners.
    """
    way = without_loops(np.concatenate((driven, [goal])), walls, inflation)
    corners, here = [_rounded(way[0])], 0
    while here < len(way) - 1:
        there = _farthest(way, here, corners[-1], walls, inflation)
        if there is None:
            x, y = corners[-1]
            raise InputError(
                "--path", f"near ({x}, {y}) the way comes too close to a wall", "another --seed"
            )
        corners.append(_rounded(way[there]))
        here = there
    if len(corners) > MOST_PATH_POINTS:
        raise InputError(
            "--path", f"{len(corners)} points", f"at most {MOST_PATH_POINTS}; another --seed"
        )
    return tuple(corners)


def without_loops(driven: FloatArray, walls: WallMap, inflation: float) -> FloatArray:
    """What was driven, (n, 2) [m], without what lies between two visits of a place."""
    keep, here = [0], 0
    while here < len(driven) - 1:
        away = elementary.lengths(*(driven[here + 1 :] - driven[here]).T)
        again = here + 1 + np.flatnonzero(away < SAME_PLACE * inflation)[::-1]
        x, y = driven[here]
        seen = (k for k in again.tolist() if walls.sees(x, y, driven[k, 0], driven[k, 1], inflation))
        here = next(seen, here + 1)
        keep.append(here)
    return driven[keep]


def in_toml(path: tuple[Point, ...], remark: str) -> str:
    """The section of a scenario that makes its leader drive along a path."""
    points = "".join(f"    [{x:g}, {y:g}],\n" for x, y in path)
    return f'# {remark}\n[planner]\nkind = "path"\npath = [\n{points}]\n'


def _farthest(way: FloatArray, here: int, corner: Point, walls: WallMap, inflation: float) -> int | None:
    """The farthest place to which a straight leg from this corner is clear and beside the way."""
    best, there = None, here + 1
    while there < len(way):
        x, y = _rounded(way[there])
        leg = np.array([[*corner, x, y]])
        if segment_distances(way[here : there + 1], leg).max() > BESIDE:
            break
        if walls.sees(*corner, x, y, inflation):
            best = there
        there += 1
    return best


def _rounded(place: FloatArray) -> Point:
    return round(float(place[0]), 2), round(float(place[1]), 2)
