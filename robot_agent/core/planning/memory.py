"""What a leader remembers of where it was and where it could go on: a bounded graph, no obstacles.

Three kinds of way points: places (the robot was there), frontiers (seen free, beside something unseen),
and closed frontiers (they turned out to lead nowhere new; kept so that none is made there again).
Its size is fixed when it is made: 121 B a way point; `nbytes` says it.
"""

import heapq
import math
from array import array
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from onehop.contracts.arrays import FloatArray
from robot_agent.core.planning.distances import squared_distances

Indices = npt.NDArray[np.intp]

NOTHING = -1
"""Stands where no way point is."""

PLACE, FRONTIER, CLOSED = 1, 2, 4
"""Kinds of way points, one bit each. Plain integers: comparing an element of a NumPy array with an
enum.IntFlag takes 7 us instead of 0.2, and a search compares each way point that it comes to."""

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
        self._peer = array("i", [NOTHING]) * (capacity * DEGREE)
        self._length = array("d", [math.inf]) * (capacity * DEGREE)

    @property
    def nbytes(self) -> int:
        """Bytes that the memory takes, full or empty."""
        edges = sum(column.itemsize * len(column) for column in (self._peer, self._length))
        return self.xy.nbytes + self.kind.nbytes + self._closed_as.nbytes + edges

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
        """A frontier that leads nowhere new; its edges are forgotten."""
        self.kind[number] = CLOSED
        self._closed += 1
        self._closed_as[number] = self._closed
        self.detach(number)

    def move(self, number: int, x: float, y: float) -> None:
        """Put a way point elsewhere; its edges, which led to where it was, are forgotten."""
        self.xy[number] = x, y
        self.detach(number)

    def detach(self, number: int) -> None:
        """Forget the edges of a way point."""
        for peer in self._peer[number * DEGREE : (number + 1) * DEGREE]:
            if peer != NOTHING:
                self.part(number, peer)

    def of_kind(self, kinds: int) -> Indices:
        """Numbers of the way points of this kind, or of these (joined by |), ascending."""
        return np.flatnonzero(self.kind[: self.count] & kinds)

    def join(self, a: int, b: int, length: float) -> None:
        """An edge between two way points; of parallel ones the shorter stays."""
        if a == b:
            return
        for one, other in ((a, b), (b, a)):
            first = one * DEGREE
            peers, lengths = self._peer[first : first + DEGREE], self._length[first : first + DEGREE]
            slot = peers.index(other) if other in peers else lengths.index(max(lengths))
            if length < lengths[slot]:
                self._peer[first + slot] = other
                self._length[first + slot] = length

    def part(self, a: int, b: int) -> None:
        """Take an edge away that turned out to be blocked."""
        for one, other in ((a, b), (b, a)):
            for slot in range(one * DEGREE, (one + 1) * DEGREE):
                if self._peer[slot] == other:
                    self._peer[slot], self._length[slot] = NOTHING, math.inf

    def nearest(self, x: float, y: float, kinds: int) -> tuple[int, float]:
        """The nearest way point of these kinds and its distance [m]; (NOTHING, inf) if there is none."""
        numbers = self.of_kind(kinds)
        if not len(numbers):
            return NOTHING, math.inf
        distance2 = squared_distances(np.array(((x, y),)), self.xy[numbers])[0]
        best = int(np.argmin(distance2))
        return int(numbers[best]), math.sqrt(float(distance2[best]))

    def routes(self, seeds: dict[int, float], origin: dict[int, int]) -> Iterator[tuple[int, float]]:
        """Dijkstra from seeds with their costs: way points and their costs [m], the cheapest first.

        origin: filled on the way with where each way point was reached from; NOTHING for a seed. The
        caller stops when it knows enough.
        """
        cost = dict(seeds)
        origin.update(dict.fromkeys(seeds, NOTHING))
        heap = sorted((length, number) for number, length in seeds.items())
        while heap:
            length, here = heapq.heappop(heap)
            if length > cost[here]:
                continue
            yield here, length
            first = here * DEGREE
            peers, steps = self._peer[first : first + DEGREE], self._length[first : first + DEGREE]
            for there, step in zip(peers, steps, strict=True):
                if there != NOTHING and length + step < cost.get(there, math.inf):
                    cost[there], origin[there] = length + step, here
                    heapq.heappush(heap, (length + step, there))
