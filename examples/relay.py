"""A relay chain: robots that stand between a base and a rover, so that what the base says arrives.

The one with the lowest id is the base and stays; the one with the highest is the rover and drives to
the goal, waiting for nobody. Both speak twice a second, and everyone says again at once what is new. The
k-th of n relays goes to where k / (n + 1) of the way from base to rover lie behind it.
"""

import math
import struct
from dataclasses import dataclass
from typing import Annotated

from driving import Pilot

from onehop.robot import (
    STANDSTILL,
    Action,
    Briefing,
    Percept,
    Program,
    Range,
    Twist,
    atan2,
    broadcast,
    to_local,
)

SPEAKS_EVERY = 10
"""Ticks."""

NEVER = -1


@dataclass(frozen=True)
class Parameters:
    chain: bool = True  # false: the relays stay at home
    speed: Annotated[float, Range(0.0, 3.0)] = 0.8  # of the rover [m/s]
    near: Annotated[float, Range(0.0, 100.0)] = 1.0  # of its place a relay stands still [m]


@dataclass
class Source:
    """What is known of one end of the chain. said: the latest tick in which it spoke."""

    said: int = NEVER
    x: float = 0.0
    y: float = 0.0


class Relay(Program):
    Parameters = Parameters

    def __init__(self, briefing: Briefing) -> None:
        self.own, self.goal = briefing.parameters, briefing.goal
        self.place, self.last = briefing.robots.index(briefing.robot), len(briefing.robots) - 1
        self.base, self.rover = Source(), Source()
        self.period_s = briefing.period_ns / 1e9
        self.pilot = Pilot(briefing)
        self.drives = False

    def step(self, percept: Percept) -> Action:
        news = False
        for message in percept.inbox:
            base_said, base_x, base_y, rover_said, rover_x, rover_y = struct.unpack(
                "<iddidd", message.payload
            )
            news |= self.learn(self.base, base_said, base_x, base_y)
            news |= self.learn(self.rover, rover_said, rover_x, rover_y)
        pose, tick = percept.pose, percept.tick
        own = {0: self.base, self.last: self.rover}.get(self.place)
        if own is not None and tick % SPEAKS_EVERY == self.place % SPEAKS_EVERY:
            news |= self.learn(own, tick, pose.x, pose.y)
        x, y = self.wanted(percept)
        ahead, left = to_local(pose, x, y)
        away = math.sqrt(ahead * ahead + left * left)
        word = struct.pack(
            "<iddidd", self.base.said, self.base.x, self.base.y,
            self.rover.said, self.rover.x, self.rover.y,
        )  # fmt: skip
        return Action(
            self.drive(percept, atan2(left, ahead), away),
            outbox=[broadcast(word, lifetime_s=0.5)] if news else [],
            values={"base_age_s": (tick - self.base.said) * self.period_s}
            if self.base.said != NEVER
            else {},
        )

    def learn(self, source: Source, said: int, x: float, y: float) -> bool:
        """Whether this is newer than what was known."""
        if said <= source.said:
            return False
        source.said, source.x, source.y = said, x, y
        return True

    def wanted(self, percept: Percept) -> tuple[float, float]:
        """Where it should be: its place in the chain, the goal, or where it is."""
        if self.place == self.last:
            return self.goal.x, self.goal.y
        if self.place == 0 or not self.own.chain or NEVER in (self.base.said, self.rover.said):
            return percept.pose.x, percept.pose.y
        share = self.place / self.last
        base, rover = self.base, self.rover
        return base.x + share * (rover.x - base.x), base.y + share * (rover.y - base.y)

    def drive(self, percept: Percept, turn: float, away: float) -> Twist:
        """It sets out when it is far from its place, and stands still when it is near."""
        near = 0.5 * self.goal.tolerance if self.place == self.last else self.own.near
        self.drives = away > (near if self.drives else 1.5 * near)
        if not self.drives:
            return STANDSTILL
        speed = self.own.speed if self.place == self.last else min(2.0, 0.5 * away + 0.3)
        return self.pilot.drive(percept.scan, turn, speed)
