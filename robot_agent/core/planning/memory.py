"""What a leader remembers of where it was and what it left open: a bounded graph, no obstacles.

Three kinds of way points: places (the robot was there), openings (seen free, beside something unseen),
and closed ones (openings that turned out to lead nowhere new, kept so that they are not opened again).
Its size is fixed when it is made; `nbytes` says it.
"""

import heapq
import math

import numpy as np
import numpy.typing as npt

from robot_agent.core.planning.view import squared_distances
from robot_agent.core.scan import FloatArray

Indices = npt.NDArray[np.intp]

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
        self._closed = 0
        self._closed_as = np.zeros(capacity, dtype=np.int64)
        self._peer = np.full((capacity, DEGREE), -1, dtype=np.int32)
        self._length = np.full((capacity, DEGREE), np.inf)

    @property
    def nbytes(self) -> int:
        """Bytes that the memory takes, full or empty."""
        arrays = (self.xy, self.kind, self._closed_as, self._peer, self._length)
        return int(sum(array.nbytes for array in arrays))

    @property
    def has_room(self) -> bool:
        """Can another way point be remembered, if need be in the place of a closed one?"""
        return self.count < self.capacity or bool((self.kind == CLOSED).any())

    def add(self, x: float, y: float, kind: int) -> int:
        """Remember a way point and say its number; there must be room. The oldest closed one goes."""
        number = self.count
        if self.count < self.capacity:
            self.count += 1
        else:
            closed = self.of_kind(CLOSED)
            number = int(closed[np.argmin(self._closed_as[closed])])
        self.xy[number] = x, y
        self.kind[number] = kind
        return number

    def close(self, number: int) -> None:
        """An opening that leads nowhere new; its edges are forgotten."""
        self.kind[number] = CLOSED
        self._closed += 1
        self._closed_as[number] = self._closed
        for peer in self._peer[number][self._peer[number] >= 0].tolist():
            self.part(number, peer)

    def of_kind(self, *kinds: int) -> Indices:
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
        """Dijkstra from seeds with their costs: cost of each way point, and where it came from."""
        cost = dict(seeds)
        origin = dict.fromkeys(seeds, -1)
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
