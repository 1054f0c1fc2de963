"""The leader's memory of where it was and what it left open: a bounded graph of way points, no obstacles.

Three kinds of way points: places (the robot was there), openings (seen free, beside something unseen),
and closed ones (openings that turned out to lead nowhere new, kept so that they are not opened again).
Its size is fixed when it is made; `nbytes` says it.
"""

import heapq
import math

import numpy as np

from robot_agent.core.planning.view import squared_distances
from robot_agent.core.scan import FloatArray

PLACE, OPENING, CLOSED = 1, 2, 3
DEGREE = 8
"""Edges kept for each way point; the shortest stay."""


class WayPoints:
    """Way points with edges. capacity: how many fit. xy: (capacity, 2) [m]; kind: (capacity,)."""

    def __init__(self, capacity: int) -> None:
        self.capacity = capacity
        self.count = 0
        self.xy: FloatArray = np.zeros((capacity, 2))
        self.kind = np.zeros(capacity, dtype=np.uint8)
        self._peer = np.full((capacity, DEGREE), -1, dtype=np.int32)
        self._length = np.full((capacity, DEGREE), np.inf)

    @property
    def nbytes(self) -> int:
        """Bytes that the memory takes, full or empty."""
        return int(sum(a.nbytes for a in (self.xy, self.kind, self._peer, self._length)))

    @property
    def full(self) -> bool:
        return self.count == self.capacity

    def add(self, x: float, y: float, kind: int) -> int:
        """Remember a way point and say its number; the caller has made sure that there is room."""
        number = self.count
        self.count += 1
        self.xy[number] = x, y
        self.kind[number] = kind
        return number

    def of_kind(self, *kinds: int) -> FloatArray:
        """Numbers of the way points of these kinds, ascending."""
        return np.flatnonzero(np.isin(self.kind[: self.count], kinds))

    def join(self, a: int, b: int, length: float) -> None:
        """An edge between two way points; of parallel ones the shorter stays."""
        if a == b:
            return
        for one, other in ((a, b), (b, a)):
            row = self._peer[one]
            same = np.flatnonzero(row == other)
            slot = int(same[0]) if len(same) else int(np.argmax(self._length[one]))
            if length < self._length[one, slot]:
                row[slot] = other
                self._length[one, slot] = length

    def part(self, a: int, b: int) -> None:
        """Take an edge away that turned out to be blocked."""
        for one, other in ((a, b), (b, a)):
            same = self._peer[one] == other
            self._peer[one, same] = -1
            self._length[one, same] = np.inf

    def nearest(self, x: float, y: float, *kinds: int) -> tuple[int, float]:
        """The nearest way point of these kinds and its distance [m]; (-1, inf) if there is none."""
        numbers = self.of_kind(*kinds)
        if not len(numbers):
            return -1, math.inf
        distance2 = squared_distances(np.array(((x, y),)), self.xy[numbers])[0]
        best = int(np.argmin(distance2))
        return int(numbers[best]), math.sqrt(float(distance2[best]))

    def routes(self, seeds: dict[int, float]) -> tuple[dict[int, float], dict[int, int]]:
        """Dijkstra from several seeds with their costs: cost of each way point, and where it came from."""
        cost = dict(seeds)
        origin = {number: -1 for number in seeds}
        heap = sorted((length, number) for number, length in seeds.items())
        while heap:
            length, here = heapq.heappop(heap)
            if length > cost[here]:
                continue
            peers, steps = self._peer[here].tolist(), self._length[here].tolist()
            for there, step in zip(peers, steps, strict=True):
                if there >= 0 and length + step < cost.get(there, math.inf):
                    cost[there], origin[there] = length + step, here
                    heapq.heappush(heap, (length + step, there))
        return cost, origin
