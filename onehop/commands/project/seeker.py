"""A robot that goes to the goal, tells the others where it is, and keeps away from walls."""

import math
import struct
from dataclasses import dataclass
from typing import Annotated

from onehop.robot import (
    Action,
    Beams,
    Briefing,
    Note,
    Percept,
    Program,
    Range,
    Twist,
    atan2,
    broadcast,
    cos,
    to_local,
)


@dataclass(frozen=True)
class Parameters:
    """Keys of [team.parameters] in mission.toml."""

    speed: Annotated[float, Range(0.0, 3.0)] = 1.0  # m/s
    clearance: Annotated[float, Range(0.2, 10.0)] = 0.9  # m


class Seeker(Program):
    Parameters = Parameters

    def __init__(self, briefing: Briefing) -> None:
        self.id, self.goal, self.own = briefing.robot, briefing.goal, briefing.parameters
        self.beams = Beams(briefing.body)
        self.others: dict[int, float] = {}  # distance to the goal of each robot that was heard
        self.is_there = False

    def step(self, percept: Percept) -> Action:
        for message in percept.inbox:
            if len(message.payload) == 8:  # other programs may say other things
                self.others[message.source] = struct.unpack("<d", message.payload)[0]
        x, y = to_local(percept.pose, self.goal.x, self.goal.y)
        distance = math.sqrt(x * x + y * y)
        before_me = sum(other < distance for other in self.others.values())
        twist, notes = Twist(0.0, 0.0), []
        if distance > 0.5 + 0.5 * before_me and not self.is_there:  # the first ones stand in the middle
            twist = self.drive(percept, atan2(y, x))
        elif not self.is_there:
            self.is_there = True
            notes = [Note("arrived", {"distance": distance})]
        speaks = percept.tick % 20 == self.id % 20  # once a second, each in a tick of its own
        return Action(
            twist,
            outbox=[broadcast(struct.pack("<d", distance), lifetime_s=1.0)] if speaks else [],
            notes=notes,
            values={"to_goal": distance, "heard": len(self.others)},
            remaining_distance=distance,
        )

    def drive(self, percept: Percept, turn: float) -> Twist:
        """In the free direction that is nearest to that of the goal."""
        beams = self.beams
        free = ~beams.near(percept.scan < self.own.clearance, 0.8)
        if not free.any():
            return Twist(0.0, 1.0)
        turn = float(beams.angles[free][abs(beams.angles[free] - turn).argmin()])
        slow = min(1.0, float(percept.scan.min()) / self.own.clearance)
        return Twist(self.own.speed * slow * max(0.0, cos(turn)), 2.0 * turn)
