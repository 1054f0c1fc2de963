"""Programs that depend on more than they are given."""

import random
import time

from onehop.robot import Action, Briefing, Percept, Program

steps = 0


class Fickle(Program):
    """Shows a number that is another one the next time; it stands still."""

    def __init__(self, briefing: Briefing) -> None:
        self.robot = briefing.robot

    def step(self, percept: Percept) -> Action:
        return Action(values={"level": self.level(percept)})

    def level(self, percept: Percept) -> float:
        return float(percept.tick)


class ByClock(Fickle):
    def level(self, percept: Percept) -> float:
        return time.perf_counter() if percept.tick >= 7 else 0.0


class ByChance(Fickle):
    def level(self, percept: Percept) -> float:
        return random.random() if percept.tick >= 7 else 0.0


class ByOrder(Fickle):
    def level(self, percept: Percept) -> float:
        names = {f"robot-{number}" for number in range(50)}
        first = next(iter([name for name in set(names)]))  # noqa: C416
        return float(first.partition("-")[2]) if percept.tick >= 7 else 0.0


class ByOthers(Fickle):
    """Counts steps of all robots in its process."""

    def level(self, percept: Percept) -> float:
        global steps
        steps += 1
        return float(steps) if percept.tick >= 7 else 0.0


class Failing(Fickle):
    def level(self, percept: Percept) -> float:
        return 1.0 / (percept.tick - 7)


class Slow(Fickle):
    def level(self, percept: Percept) -> float:
        time.sleep(0.002)
        return super().level(percept)
