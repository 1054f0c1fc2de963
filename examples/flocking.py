"""A flock: each robot tells where it is and how it moves, and goes by what it hears (Reynolds 1987).

Only robots 1 and 2 know the goal. The others keep to the mean direction of those whom they hear, towards
their middle, and away from who is too near.
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
    atan2,
    broadcast,
    cos,
    sin,
    to_local,
)

SPEAKS_EVERY = 5
FORGETS_AFTER = 20
"""Ticks: four words a second; one of whom nothing was heard for a second is not there."""


@dataclass(frozen=True)
class Parameters:
    informed: Annotated[int, Range(0, 300)] = 2
    speed: Annotated[float, Range(0.0, 3.0)] = 0.8  # m/s
    apart: Annotated[float, Range(0.5, 20.0)] = 1.5  # m


class Flocking(Program):
    Parameters = Parameters

    def __init__(self, briefing: Briefing) -> None:
        self.own, self.robot, self.goal = briefing.parameters, briefing.robot, briefing.goal
        self.pilot = Pilot(briefing)
        self.is_there = False
        self.heard: dict[int, tuple[int, float, float, float, float, bool]] = {}

    def step(self, percept: Percept) -> Action:
        pose = percept.pose
        for message in percept.inbox:
            self.heard[message.source] = percept.tick, *struct.unpack("<4d?", message.payload)
        others = [one for _, one in sorted(self.heard.items()) if percept.tick - one[0] < FORGETS_AFTER]
        x = y = 0.0  # what it wants, in the map's frame
        for _, other_x, other_y, vx, vy, is_there in others:
            dx, dy = other_x - pose.x, other_y - pose.y
            away = max(0.1, math.sqrt(dx * dx + dy * dy))
            push = 0.3 * (away - self.own.apart) / away  # towards it if far, from it if near
            x += (2.0 * vx + push * dx) / len(others)
            y += (2.0 * vy + push * dy) / len(others)
            self.is_there |= is_there and away < self.own.apart
        to_x, to_y = self.goal.x - pose.x, self.goal.y - pose.y
        away = math.sqrt(to_x * to_x + to_y * to_y)
        if self.robot <= self.own.informed:
            self.is_there |= away < 0.5 * self.goal.tolerance
            x, y = x + 0.5 * to_x / max(0.1, away), y + 0.5 * to_y / max(0.1, away)
        for _, other_x, other_y, _, _, is_there in others:
            if is_there:
                x, y = other_x - pose.x, other_y - pose.y
        wish = math.sqrt(x * x + y * y)
        twist = STANDSTILL
        if wish > 0.15 and not self.is_there:
            ahead, left = to_local(pose, pose.x + x, pose.y + y)
            speed = self.own.speed * min(1.0, wish)
            twist = self.pilot.drive(percept.scan, atan2(left, ahead), speed)
        v = percept.twist.v
        word = struct.pack(
            "<4d?", pose.x, pose.y, v * cos(pose.heading), v * sin(pose.heading), self.is_there
        )
        speaks = percept.tick % SPEAKS_EVERY == self.robot % SPEAKS_EVERY
        return Action(
            twist,
            outbox=[broadcast(word, lifetime_s=0.25)] if speaks else [],
            values={"neighbours": len(others), "wish": wish},
            remaining_distance=away,
        )
