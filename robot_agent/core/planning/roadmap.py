"""The local road map: random points in the visible part of a fan, joined where the way is clear, and A*.

Thesis 3.4.1: sample, join, search. Points are drawn inside the visible region only, since it is known;
what the laser did not see is not free. Every road map lives for one scan.
"""

import heapq
import math

import numpy as np
import numpy.typing as npt

from onehop.contracts import elementary
from robot_agent.core.planning.view import BoolArray, View, squared_distances
from robot_agent.core.scan import FloatArray

Indices = npt.NDArray[np.intp]

NEIGHBOURS = 6
"""Edges tried from each point, to the nearest others; more cost time and shorten nothing visibly."""

DISCOMFORT = 2.0
"""A way that keeps only the clearance is taken if the comfortable one is more than this much longer."""

EDGE_PROBES = (0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875)
"""Where along an edge its visibility is probed."""


def sample_fan(view: View, draws: FloatArray, centre: float, half: float, margin: float) -> FloatArray:
    """Points of the visible region inside the fan, (n, 2) float64 [m], map frame.

    draws: (n, 2) uniform in [0, 1): direction, and radius as a share of the free range. centre, half:
    direction [rad, map frame] and half opening of the fan; it is cut to the field of view. margin: room
    to leave to the end of the laser's range, beyond which anything may stand [m].
    """
    angles = view.fan.angles
    offset = math.remainder(centre - view.pose.heading, 2.0 * math.pi)
    low = min(max(offset - half, float(angles[0])), float(angles[-1]))
    high = max(min(offset + half, float(angles[-1])), float(angles[0]))
    bearing = low + (high - low) * draws[:, 0]
    beam = np.rint((bearing - angles[0]) / (angles[1] - angles[0])).astype(np.intp)
    reach = np.minimum(view.sight[beam], view.fan.range - margin)
    radius = reach * np.sqrt(draws[:, 1]) * 0.98
    heading = bearing + view.pose.heading
    directions = np.column_stack((elementary.cosines(heading), elementary.sines(heading)))
    return np.asarray(view.origin + directions * radius[:, None])


class RoadMap:
    """Points known to be free, with edges known to be clear. Point 0 is the robot (virtual start).

    points: (n, 2) float64 [m]. marks: (n,) index of the extra point that a point is, or -1.
    """

    def __init__(
        self, view: View, samples: FloatArray, extras: FloatArray, clearance: float, comfort: float
    ) -> None:
        self.view = view
        self.clearance = clearance
        self.comfort = comfort
        candidates = np.concatenate((extras, samples))
        marks = np.concatenate((np.arange(len(extras)), np.full(len(samples), -1)))
        free, room = view.free(candidates, clearance)
        good = free & view.visible(candidates) & view.surrounded(candidates, clearance)
        self.points: FloatArray = np.concatenate((view.origin[None], candidates[good]))
        self.room: FloatArray = np.concatenate((view.free(view.origin[None], clearance)[1], room[good]))
        self.marks: Indices = np.concatenate(([-1], marks[good])).astype(np.intp)
        self._join()

    def _join(self) -> None:
        n = len(self.points)
        distance2 = squared_distances(self.points, self.points)
        np.fill_diagonal(distance2, np.inf)
        k = min(NEIGHBOURS, n - 1)
        self._pairs: tuple[Indices, Indices] = (np.empty(0, dtype=np.intp), np.empty(0, dtype=np.intp))
        if k < 1:
            self.neighbours: Indices = np.empty((n, 0), dtype=np.intp)
            self.lengths: FloatArray = np.empty((n, 0))
            return
        reach = np.partition(distance2, k - 1, axis=1)[:, k - 1]
        joined = distance2 <= np.maximum(reach[:, None], reach)
        joined[0, 1:] = True
        a, b = np.nonzero(np.triu(joined, 1))
        clear, wide = self._clear(a, b)
        length = np.sqrt(distance2[a, b]) * np.where(wide, 1.0, DISCOMFORT)
        self._store(a[clear], b[clear], length[clear])

    def _clear(self, a: Indices, b: Indices) -> tuple[BoolArray, BoolArray]:
        """Which edges are visible all along and keep the clearance; which of them keep the comfort.

        Two ends with so much room that their discs, less the comfort, meet need no test.
        """
        start, end = self.points[a], self.points[b]
        clear = np.ones(len(a), dtype=np.bool_)
        inner = np.flatnonzero(a > 0)
        for share in EDGE_PROBES:
            clear[inner] &= self.view.visible(start[inner] + share * (end[inner] - start[inner]))
        wide = self.room[a] + self.room[b] - 2.0 * self.comfort >= elementary.lengths(*(end - start).T)
        rest = np.flatnonzero(clear & ~wide)
        clear[rest], wide[rest] = self.view.passable_twice(
            start[rest], end[rest], self.clearance, self.comfort
        )
        return clear, wide

    def _store(self, a: Indices, b: Indices, length: FloatArray) -> None:
        """Adjacency as padded rows: neighbours (n, width), lengths (n, width) with inf as padding."""
        self._pairs = a, b
        n = len(self.points)
        sources, targets = np.concatenate((a, b)), np.concatenate((b, a))
        order = np.lexsort((targets, sources))
        sources, targets, both = sources[order], targets[order], np.concatenate((length, length))[order]
        degree = np.bincount(sources, minlength=n)
        width = int(degree.max(initial=0))
        slot = np.arange(len(sources)) - np.repeat(np.cumsum(degree) - degree, degree)
        self.neighbours = np.zeros((n, width), dtype=np.intp)
        self.lengths = np.full((n, width), np.inf)
        self.neighbours[sources, slot] = targets
        self.lengths[sources, slot] = both

    @property
    def edges(self) -> FloatArray:
        """All edges, (k, 4) x0, y0, x1, y1 [m]."""
        a, b = self._pairs
        return np.concatenate((self.points[a], self.points[b]), axis=1)

    def costs(self) -> FloatArray:
        """Length of the shortest way from the robot to each point, (n,) [m]; inf where there is none."""
        cost = np.full(len(self.points), np.inf)
        cost[0] = 0.0
        while self.lengths.shape[1]:
            better = np.minimum(cost, (cost[self.neighbours] + self.lengths).min(axis=1))
            if (better >= cost - 1e-9).all():
                break
            cost = better
        return cost

    def path(self, goal: int) -> FloatArray | None:
        """Shortest way from the robot to point `goal`, (n, 2) [m], robot first; None if none."""
        chain = self.chain(goal)
        return None if chain is None else self.shorten(self.points[chain])

    def chain(self, goal: int) -> list[int] | None:
        """The points of the shortest way to point `goal` by A*, the robot first; None if none."""
        points = self.points
        guess = elementary.lengths(*(points - points[goal]).T).tolist()
        cost, origin = {0: 0.0}, {0: 0}
        heap = [(guess[0], 0)]
        while heap:
            estimate, here = heapq.heappop(heap)
            if here == goal:
                break
            if estimate > cost[here] + guess[here] + 1e-12:
                continue
            row = zip(self.neighbours[here].tolist(), self.lengths[here].tolist(), strict=True)
            for there, length in row:
                reached = cost[here] + length
                if reached < cost.get(there, math.inf):
                    cost[there], origin[there] = reached, here
                    heapq.heappush(heap, (reached + guess[there], there))
        if goal not in cost:
            return None
        chain = [goal]
        while chain[-1] != 0:
            chain.append(origin[chain[-1]])
        return chain[::-1]

    def shorten(self, path: FloatArray) -> FloatArray:
        """The same way without detours: every point is dropped that a clear straight line can skip."""
        keep, here = [0], 0
        while here < len(path) - 1:
            ahead = np.arange(here + 1, len(path))
            start = np.broadcast_to(path[here], (len(ahead), 2))
            clear = self.view.passable(start, path[ahead], self.comfort)
            if here > 0:
                for share in EDGE_PROBES:
                    clear &= self.view.visible(start + share * (path[ahead] - start))
            last = ahead[clear]
            here = int(last[-1]) if len(last) else here + 1
            keep.append(here)
        return path[keep]
