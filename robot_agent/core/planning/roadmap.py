"""The local road map: random points in the visible part of a fan, joined where the way is clear, and A*.

Thesis 3.4.1: sample (sampling.py), join, search. Every road map lives for one scan.
"""

import heapq
import math

import numpy as np
import numpy.typing as npt

from onehop.contracts import elementary
from onehop.contracts.arrays import BoolArray, FloatArray
from robot_agent.core.planning.distances import squared_distances
from robot_agent.core.planning.view import NO_POINTS, View

Indices = npt.NDArray[np.intp]

NEIGHBOURS = 6
"""Edges tried from each point, to the nearest others; more cost time and shorten nothing visibly."""

DISCOMFORT = 2.0
"""A way that keeps only the clearance is taken if the comfortable one is more than this much longer."""

PROBES: FloatArray = np.arange(1, 8)[:, None] / 8.0
"""Where along an edge its visibility is probed."""


class RoadMap:
    """Points known to be free, with edges known to be clear. Point 0 is the robot (virtual start).

    Guarantee: with a clearance 4 % above the inflation, every edge keeps the inflation from the outline
    drawn through neighbouring hits (outline.py), or as much as the robot has already. What no
    beam hit is not covered: a corner between two hits stands out by up to half of their distance.

    points: (n, 2) float64 [m]. marks: (n,) index of the extra point that a point is, or -1.
    direct: (n,) cost of the straight way from the robot [m], inf where it is not clear. neighbours:
    (width, n) what else each point is joined to, and costs of these edges, inf where there are fewer.
    """

    def __init__(
        self, view: View, samples: FloatArray, extras: FloatArray, clearance: float, comfort: float
    ) -> None:
        self.view = view
        self.clearance = clearance
        self.comfort = comfort
        candidates = np.concatenate((view.origin[None], extras, samples))
        good = view.visible(candidates) & view.surrounded(candidates, clearance)
        free, room = view.free(candidates, clearance)
        good &= free
        good[0] = True
        kept = good.nonzero()[0]
        self.points: FloatArray = candidates[kept]
        self.room = room[kept]
        self.marks: Indices = np.where(kept <= len(extras), kept - 1, -1)
        self._ahead, self._left = view.local(self.points)
        self._join()

    def _join(self) -> None:
        """Try the robot with every point, and points with those nearest to them.

        Two points that the robot reaches straight and in comfort are not joined: no way can be shorter.
        """
        n = len(self.points)
        seen = np.arange(1, n)
        here = np.zeros(n - 1, dtype=np.intp)
        clear, wide, length = self._clear(here, seen)
        self.direct: FloatArray = np.concatenate(((0.0,), _costs(clear, wide, length)))
        a, b = self._near_pairs(np.concatenate(((True,), clear & wide)))
        shown = self._shown(a, b)
        a, b = a[shown], b[shown]
        inner, wide, length = self._clear(a, b)
        a, b = a[inner], b[inner]
        self._store(a, b, _costs(inner, wide, length)[inner])
        self.pairs = np.concatenate((here[clear], a)), np.concatenate((seen[clear], b))

    def _near_pairs(self, straight: BoolArray) -> tuple[Indices, Indices]:
        """Pairs a < b of points but for the robot, of which one is among the other's nearest, and not
        both are `straight`.
        """
        n = len(self.points) - 1
        k = min(NEIGHBOURS, n - 1)
        if k < 1 or straight.all():
            return np.empty(0, dtype=np.intp), np.empty(0, dtype=np.intp)
        distance2 = squared_distances(self.points[1:], self.points[1:])
        distance2.flat[:: n + 1] = np.inf
        reach = np.sort(distance2, axis=1)[:, k - 1]
        joined = np.flatnonzero(distance2 <= np.maximum(reach[:, None], reach))
        a = joined // n
        b = joined - n * a
        a, b = a + 1, b + 1
        wanted = (a < b) & ~(straight[a] & straight[b])
        return a[wanted], b[wanted]

    def _shown(self, a: Indices, b: Indices) -> BoolArray:
        """Which edges between points a and b are visible all along."""
        ahead, left = self._ahead, self._left
        shown = self.view.shows(
            ahead[a] + PROBES * (ahead[b] - ahead[a]), left[a] + PROBES * (left[b] - left[a])
        )
        return np.asarray(shown.all(axis=0))

    def _clear(self, a: Indices, b: Indices) -> tuple[BoolArray, BoolArray, FloatArray]:
        """Which edges keep the clearance, which the comfort, and how long they are, (n,) each [m].

        Two ends with so much room that their discs, less the comfort, meet need no test.
        """
        start, end = self.points[a], self.points[b]
        offset = end - start
        length = elementary.lengths(offset[:, 0], offset[:, 1])
        wide: BoolArray = self.room[a] + self.room[b] - 2.0 * self.comfort >= length
        clear = wide.copy()
        rest = np.flatnonzero(~wide)
        clear[rest], wide[rest] = self.view.passable_twice(
            start[rest], end[rest], self.clearance, self.comfort
        )
        return clear, wide, length

    def _store(self, a: Indices, b: Indices, length: FloatArray) -> None:
        """Adjacency as padded columns."""
        n = len(self.points)
        sources, targets = np.concatenate((a, b)), np.concatenate((b, a))
        order = np.argsort(sources, kind="stable")
        sources, targets = sources[order], targets[order]
        degree = np.bincount(sources, minlength=n)
        width = int(degree.max())
        slot = np.arange(len(sources)) - (np.cumsum(degree) - degree)[sources]
        self.neighbours: Indices = np.zeros((width, n), dtype=np.intp)
        self.lengths: FloatArray = np.full((width, n), np.inf)
        self.neighbours[slot, sources] = targets
        self.lengths[slot, sources] = np.concatenate((length, length))[order]

    @property
    def edges(self) -> FloatArray:
        """All edges, (k, 4) x0, y0, x1, y1 [m]."""
        a, b = self.pairs
        return np.concatenate((self.points[a], self.points[b]), axis=1)

    def costs(self) -> FloatArray:
        """Length of the shortest way from the robot to each point, (n,) [m]; inf where there is none."""
        cost = self.direct
        while len(self.lengths):
            better = np.minimum(cost, (cost[self.neighbours] + self.lengths).min(axis=0))
            if (better >= cost - 1e-9).all():
                break
            cost = better
        return cost

    def path(self, goal: int) -> FloatArray:
        """Shortest way from the robot to point `goal`, (n, 2) [m], robot first; empty if none."""
        chain = self.chain(goal)
        return self.shorten(chain) if chain else NO_POINTS

    def chain(self, goal: int) -> list[int]:
        """The points of the shortest way to point `goal` by A*, the robot first; empty if none.

        The search begins with the robot expanded: all points that it sees are on the heap, but for those
        over which no way can be shorter than the straight one.
        """
        if goal == 0:
            return [0]
        offset = self.points - self.points[goal]
        rest = elementary.lengths(offset[:, 0], offset[:, 1])
        first = (self.direct + rest < min(self.direct[goal] + 1e-9, math.inf)).nonzero()[0]
        guess, cost = rest.tolist(), dict(zip(first.tolist(), self.direct[first].tolist(), strict=True))
        origin = dict.fromkeys(cost, 0)
        heap = [(length + guess[point], point) for point, length in cost.items()]
        heapq.heapify(heap)
        while heap:
            estimate, here = heapq.heappop(heap)
            if here == goal:
                break
            if estimate > cost[here] + guess[here] + 1e-12:
                continue
            row = zip(self.neighbours[:, here].tolist(), self.lengths[:, here].tolist(), strict=True)
            for there, length in row:
                reached = cost[here] + length
                if reached < cost.get(there, math.inf):
                    cost[there], origin[there] = reached, here
                    heapq.heappush(heap, (reached + guess[there], there))
        if goal not in cost:
            return []
        chain = [goal]
        while chain[-1] != 0:
            chain.append(origin[chain[-1]])
        return chain[::-1]

    def shorten(self, chain: list[int]) -> FloatArray:
        """The way along these points without those that a clear straight line can skip, (k, 2) [m]."""
        path = self.points[chain]
        keep, here = [0], 0
        while here < len(path) - 1:
            start = np.broadcast_to(path[here], (len(path) - here - 1, 2))
            clear = self.view.passable(start, path[here + 1 :], self.comfort)
            if here > 0:
                rest = np.array(chain[here + 1 :])
                clear &= self._shown(np.full(len(rest), chain[here]), rest)
            last = clear.nonzero()[0]
            here += int(last[-1]) + 1 if len(last) else 1
            keep.append(here)
        return path[keep]


def _costs(clear: BoolArray, wide: BoolArray, length: FloatArray) -> FloatArray:
    """Costs of edges by what they keep [m]."""
    return np.where(clear, np.where(wide, length, DISCOMFORT * length), np.inf)
