"""Programs that tests run, good and bad."""

import struct
import time
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from onehop.robot import (
    Action,
    Briefing,
    Message,
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

FAILS_AT = 30


@dataclass(frozen=True)
class Inner:
    gain: Annotated[float, Range(0.0, 10.0)] = 2.0


@dataclass(frozen=True)
class Parameters:
    speed: Annotated[float, Range(0.0, 3.0)] = 1.0
    how: Literal["", "raises", "returns nothing", "says text", "exits", "hangs", "recurses"] = ""
    inner: Inner = field(default_factory=Inner)


class Seeker(Program):
    """Drives to the goal and tells everyone how far it is; it fails in a way of its choice."""

    Parameters = Parameters

    def __init__(self, briefing: Briefing) -> None:
        self.briefing = briefing
        self.own: Parameters = briefing.parameters
        self.heard: dict[int, float] = {}

    def step(self, percept: Percept) -> Action:
        if self.own.how and percept.tick == FAILS_AT:
            return self.fail(percept)
        for message in percept.inbox:
            self.hear(message)
        goal = self.briefing.goal
        x, y = to_local(percept.pose, goal.x, goal.y)
        away = float(np.sqrt(x * x + y * y))
        turn = atan2(y, x)
        speed = self.own.speed * max(0.0, cos(turn)) if away > 0.4 + 0.6 * self.briefing.robot else 0.0
        say = percept.tick % 20 == self.briefing.robot
        return Action(
            Twist(speed, self.own.inner.gain * turn if speed else 0.0),
            outbox=[broadcast(struct.pack("<d", away), size=100)] if say else [],
            notes=[Note("set_out", {"distance": away})] if percept.tick == 0 else [],
            values={"to_goal": np.float64(away), "heard": len(self.heard)},
        )

    def hear(self, message: Message) -> None:
        self.heard[message.source] = message.throughput_bps

    def fail(self, percept: Percept) -> Any:
        match self.own.how:
            case "raises":
                raise LookupError(f"no map\nof {self!r}")
            case "says text":
                return Action(outbox=[broadcast("text")])  # type: ignore[arg-type]
            case "exits":
                raise SystemExit(0)
            case "recurses":
                return self.fail(percept)
            case "hangs":
                while True:
                    time.sleep(0.01)
        return None


class Dawdler(Seeker):
    """A Seeker that thinks for two ticks of 50 ms."""

    def step(self, percept: Percept) -> Action:
        time.sleep(0.11)
        return super().step(percept)


class Unready(Program):
    """Fails before its first step."""

    def __init__(self, briefing: Briefing) -> None:
        raise RuntimeError(f"robot {briefing.robot} has no battery")

    def step(self, percept: Percept) -> Action:
        raise NotImplementedError


class NotOne:
    """No program."""
