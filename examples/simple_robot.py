"""A robot of plain arithmetic: the same floats in every language (bare_robot.py, rust_robot).

It drives to the goal, slower when something is near, tells the others where it is once a second, and
stops beside those that are nearer. Sine and cosine are its own, from +, -, * and /.
"""

import math
import struct
from dataclasses import dataclass
from typing import Annotated

from onehop.robot import Action, Briefing, Note, Percept, Program, Range, Twist, broadcast

PI = 3.141592653589793


def sine(angle: float) -> float:
    """Of an angle between -pi and pi [rad], to 0.001: a parabola, made rounder by another one."""
    arc = 4.0 / PI * angle - 4.0 / (PI * PI) * angle * abs(angle)
    return 0.775 * arc + 0.225 * arc * abs(arc)


def cosine(angle: float) -> float:
    return sine(angle + PI / 2.0 if angle <= PI / 2.0 else angle - 3.0 * PI / 2.0)


@dataclass(frozen=True)
class Parameters:
    speed: Annotated[float, Range(0.0, 3.0)] = 0.5  # m/s


class Simple(Program):
    Parameters = Parameters

    def __init__(self, briefing: Briefing) -> None:
        self.robot, self.goal, self.speed = briefing.robot, briefing.goal, briefing.parameters.speed
        self.heard: dict[int, tuple[float, float]] = {}  # where each of the others was
        self.has_arrived = False

    def step(self, percept: Percept) -> Action:
        for message in percept.inbox:
            if len(message.payload) == 16:
                x, y = struct.unpack("<2d", message.payload)
                self.heard[message.source] = x, y
        pose, goal = percept.pose, self.goal
        dx, dy = goal.x - pose.x, goal.y - pose.y
        distance = math.sqrt(dx * dx + dy * dy)
        nearer = 0
        for x, y in self.heard.values():
            nearer += math.sqrt((goal.x - x) * (goal.x - x) + (goal.y - y) * (goal.y - y)) < distance
        v = w = 0.0
        notes = []
        if self.has_arrived or distance < 0.4 + 0.6 * nearer:
            notes = [] if self.has_arrived else [Note("arrived", {"distance": distance})]
            self.has_arrived = True
        else:
            s, c = sine(pose.heading), cosine(pose.heading)
            ahead, left = (c * dx + s * dy) / distance, (c * dy - s * dx) / distance
            third = len(percept.scan) // 6
            nearest = float(percept.scan[third : len(percept.scan) - third].min())
            near = min(1.0, max(0.0, nearest - 0.4))
            v = self.speed * max(0.0, ahead) * near
            w = 2.0 * left if ahead > 0.0 else 1.0
        speaks = percept.tick % 20 == self.robot % 20
        return Action(
            Twist(v, w),
            outbox=[broadcast(struct.pack("<2d", pose.x, pose.y))] if speaks else [],
            notes=notes,
            values={"to_goal": distance, "heard": len(self.heard)},
            remaining_distance=distance,
        )
