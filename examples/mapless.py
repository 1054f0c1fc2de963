"""Coverage without a map: go where nobody has been, as far as one sees and has heard.

A robot remembers the squares of the ground in which it has been, and tells the others the latest of
them. It keeps no map of walls: of each direction it asks how many new squares lie before the first thing
that its laser sees, and takes the best; where there is none it goes where nobody has been for longest.
"""

import math
import struct
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from driving import Pilot

from onehop.robot import Action, Briefing, Percept, Program, Range, broadcast, cos, sin, wrap_angle

DECIDES_EVERY = 10
SPEAKS_EVERY = 10
"""Ticks."""

TOLD = 8
"""Squares that each word holds: those of words that were lost come again."""


@dataclass(frozen=True)
class Parameters:
    talks: bool = True
    speed: Annotated[float, Range(0.0, 3.0)] = 1.5  # m/s
    square: Annotated[float, Range(0.1, 20.0)] = 2.0  # m


class Mapless(Program):
    Parameters = Parameters

    def __init__(self, briefing: Briefing) -> None:
        self.own, self.robot = briefing.parameters, briefing.robot
        self.pilot = Pilot(briefing)
        self.visited: dict[tuple[int, int], int] = {}  # square: latest tick in which somebody was there
        self.latest: list[tuple[int, int]] = []  # its own squares
        self.heading = 0.0

    def step(self, percept: Percept) -> Action:
        pose, tick = percept.pose, percept.tick
        for message in percept.inbox:
            words = struct.unpack(f"<{len(message.payload) // 2}h", message.payload)
            for place in zip(words[0::2], words[1::2], strict=True):
                self.visited[place] = tick
        here = self.square_at(pose.x, pose.y)
        self.visited[here] = tick
        if here not in self.latest[-1:]:
            self.latest = [*self.latest, here][-TOLD:]
        if tick % DECIDES_EVERY == self.robot % DECIDES_EVERY or tick == 0:
            self.heading = self.decide(percept)
        word = struct.pack(f"<{2 * len(self.latest)}h", *(n for place in self.latest for n in place))
        speaks = self.own.talks and tick % SPEAKS_EVERY == self.robot % SPEAKS_EVERY
        return Action(
            self.pilot.drive(percept.scan, wrap_angle(self.heading - pose.heading), self.own.speed),
            outbox=[broadcast(word, lifetime_s=0.5)] if speaks else [],
            values={"squares": len(self.visited)},
        )

    def square_at(self, x: float, y: float) -> tuple[int, int]:
        return math.floor(x / self.own.square), math.floor(y / self.own.square)

    def decide(self, percept: Percept) -> float:
        """The best heading, in the map's frame [rad]."""
        pose, best, found = percept.pose, -math.inf, percept.pose.heading + math.pi
        seen = np.minimum(percept.scan.astype(float), 10.0)
        for angle, free in zip(self.pilot.candidates, self.pilot.free_distances(seen), strict=True):
            c, s = cos(pose.heading + angle), sin(pose.heading + angle)
            steps = int(free / (0.5 * self.own.square))
            places = [
                self.square_at(
                    pose.x + c * n * 0.5 * self.own.square, pose.y + s * n * 0.5 * self.own.square
                )
                for n in range(1, steps + 1)
            ]
            new = sum(place not in self.visited for place in places)
            oldest = max(
                (percept.tick - self.visited.get(place, percept.tick) for place in places), default=0
            )
            value = new + 0.001 * oldest - 0.5 * abs(float(angle)) if places else -math.inf
            if value > best:
                best, found = value, pose.heading + float(angle)
        return wrap_angle(found)
