"""What goes wrong in a mission: faults drawn by kind, each kind from a random stream of its own.

With a **budget** the team is to survive them: some robots, the core, are whole again when the chaos
ends, and what is broken for good (dead, stopped, cut off) are others. Without it anything may break for
good, and a mission can only be asked for what it must never do.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from onehop.chaos.places import Places, Ways
from onehop.contracts.fault_section import DIRECTIONS, FaultEvent, FaultKind, FaultSection
from onehop.contracts.randomness import generator
from onehop.contracts.sections import Point

KIND_SHARE = 0.3
"""Share of missions in which a kind of trouble occurs."""

MOST_OF_A_KIND = 3

_DRAWS = 20

EVENTS: tuple[FaultEvent, ...] = ("leader elected", "formed", "narrow", "arrived")

Faults = list[FaultSection]


@dataclass(frozen=True, slots=True)
class Dice:
    """Draws one kind of trouble. core: robots that nothing breaks for good; all others are doomed.

    ways: to the goal. until_s: when the chaos ends [s].
    """

    random: np.random.Generator
    robots: tuple[int, ...]
    core: tuple[int, ...]
    places: Places
    ways: Ways
    until_s: float
    budget: bool

    @property
    def doomed(self) -> tuple[int, ...]:
        return tuple(robot for robot in self.robots if robot not in self.core)

    def number(self, low: float, high: float) -> float:
        """Uniform, in hundredths."""
        return round(float(self.random.uniform(low, high)), 2)

    def at(self) -> float:
        """A time within the chaos [s]."""
        return self.number(0.0, self.until_s)

    def lasting(self, at_s: float, longest_s: float) -> float:
        """A duration that ends within the chaos [s]; without a budget sometimes 0: it never ends."""
        if not self.budget and self.random.random() < 0.3:
            return 0.0
        return self.number(0.1, max(0.1, min(longest_s, self.until_s - at_s)))

    def reachable(self) -> Point | None:
        """A free place from which there is a way to the goal."""
        draws = (self.places.drawn(self.random) for _ in range(_DRAWS))
        return next((one for one in draws if one and math.isfinite(self.ways.length(one))), None)

    def some(self, of: tuple[int, ...], most: int = 12) -> tuple[int, ...]:
        """At least one of some robots."""
        count = int(self.random.integers(1, min(most, len(of)) + 1))
        return tuple(sorted(int(robot) for robot in self.random.permutation(of)[:count]))

    def one_of(self, of: tuple[int, ...]) -> tuple[int, ...]:
        return self.some(of, 1)


def draw_faults(
    seed: int, robots: tuple[int, ...], places: Places, ways: Ways, until_s: float, budget: bool
) -> tuple[FaultSection, ...]:
    """The faults of a seed, in order of their times, those that wait for an event last.

    ways: to the goal. until_s: when those that end have ended [s].
    """
    chosen = generator(seed, "chaos/core")
    size = int(chosen.integers(1, len(robots) + 1))
    core = tuple(sorted(int(robot) for robot in chosen.permutation(robots)[:size]))
    faults: Faults = []
    for kind, draw in TROUBLES.items():
        random = generator(seed, f"chaos/{kind}")
        dice = Dice(random, robots, core if budget else (), places, ways, until_s, budget)
        if random.random() < KIND_SHARE:
            for _ in range(int(random.integers(1, MOST_OF_A_KIND + 1))):
                faults += draw(dice)
    return tuple(sorted(faults, key=_time))


def _time(fault: FaultSection) -> tuple[bool, float]:
    return fault.at_s is None, fault.at_s or 0.0


def _death(dice: Dice) -> Faults:
    return [FaultSection("kill", dice.at(), dice.one_of(dice.doomed))] if dice.doomed else []


def _death_and_restart(dice: Dice) -> Faults:
    robots, at = dice.some(dice.robots, 3), dice.at()
    return [
        FaultSection("kill", at, robots),
        FaultSection("restart", round(at + dice.lasting(at, 15.0), 2), robots),
    ]


def _restart(dice: Dice) -> Faults:
    return [FaultSection("restart", dice.at(), dice.some(dice.robots, 2))]


def _stop(dice: Dice) -> Faults:
    """For a while, or until somebody lets it go on."""
    at, robots = dice.at(), dice.some(dice.robots, 3)
    duration_s = dice.lasting(at, 15.0)
    if dice.random.random() < 0.5:
        return [FaultSection("stop", at, robots, duration_s=duration_s)]
    end = FaultSection("continue", round(at + duration_s, 2), robots)
    return [FaultSection("stop", at, robots), end]


def _stop_for_good(dice: Dice) -> Faults:
    return [FaultSection("stop", dice.at(), dice.one_of(dice.doomed))] if dice.doomed else []


def _hold(dice: Dice) -> Faults:
    at = dice.at()
    return [FaultSection("hold", at, dice.some(dice.robots), duration_s=dice.lasting(at, 20.0))]


def _kidnap(dice: Dice) -> Faults:
    place = dice.reachable()
    if place is None:
        return []
    robots, turn = dice.one_of(dice.robots), dice.number(-180.0, 180.0)
    return [FaultSection("kidnap", dice.at(), robots, x=place[0], y=place[1], heading_deg=turn)]


def _blind(dice: Dice) -> Faults:
    at = dice.at()
    return [FaultSection("blind", at, dice.some(dice.robots, 2), duration_s=dice.lasting(at, 4.0))]


def _slow(dice: Dice) -> Faults:
    at, delay = dice.at(), int(dice.random.integers(1, 21))
    robots, duration_s = dice.some(dice.robots, 2), dice.lasting(at, 10.0)
    return [FaultSection("slow", at, robots, duration_s=duration_s, delay_ticks=delay)]


def _cut(dice: Dice) -> Faults:
    """Two sides, or one from all the rest, both ways or one."""
    at, side = dice.at(), dice.some(dice.robots)
    rest = tuple(robot for robot in dice.robots if robot not in side)
    others = dice.some(rest) if rest and dice.random.random() < 0.5 else ()
    direction = DIRECTIONS[int(dice.random.choice(3, p=(0.5, 0.25, 0.25)))]
    duration_s = dice.lasting(at, 25.0)
    return [FaultSection("cut", at, side, others, duration_s, direction=direction)]


def _cut_off(dice: Dice) -> Faults:
    """For good."""
    return [FaultSection("cut", dice.at(), dice.some(dice.doomed))] if dice.doomed else []


def _corrupt(dice: Dice) -> Faults:
    at = dice.at()
    robots = dice.some(dice.robots) if dice.random.random() < 0.5 else ()
    share, duration_s = dice.number(0.02, 1.0), dice.lasting(at, 20.0)
    return [FaultSection("corrupt", at, robots, duration_s=duration_s, probability=share)]


def _jam(dice: Dice) -> Faults:
    at, place = dice.at(), dice.places.drawn(dice.random) or (0.0, 0.0)
    return [
        FaultSection(
            "jam", at, duration_s=dice.lasting(at, 20.0), x=place[0], y=place[1],
            radius=dice.number(2.0, 20.0), noise_dbm=dice.number(-80.0, -30.0),
        )
    ]  # fmt: skip


def _heal(dice: Dice) -> Faults:
    robots = dice.some(dice.robots) if dice.random.random() < 0.5 else ()
    return [FaultSection("heal", dice.at(), robots)]


def _decapitation(dice: Dice) -> Faults:
    """Who is elected leader dies, at once or a little later, and comes back."""
    nth, after_s = int(dice.random.integers(1, 4)), dice.number(0.0, 4.0)
    later_s = round(after_s + dice.number(0.1, 12.0), 2)
    again = FaultSection("restart", on="leader elected", nth=nth, after_s=later_s)
    return [FaultSection("kill", on="leader elected", nth=nth, after_s=after_s), again]


def _at_an_event(dice: Dice) -> Faults:
    """Who brings about an event is cut off, held, stopped or slow for a while."""
    kinds: tuple[FaultKind, ...] = ("cut", "hold", "stop", "slow")
    kind = kinds[int(dice.random.integers(len(kinds)))]
    event = EVENTS[int(dice.random.integers(len(EVENTS)))]
    nth, after_s, duration_s = (
        int(dice.random.integers(1, 3)), dice.number(0.0, 5.0), dice.number(0.5, 8.0)
    )  # fmt: skip
    delay = int(dice.random.integers(1, 21)) if kind == "slow" else 0
    return [
        FaultSection(kind, duration_s=duration_s, on=event, nth=nth, after_s=after_s, delay_ticks=delay)
    ]


def _swizzle(dice: Dice) -> Faults:
    """Robots are cut off one after the other, and come back in another order."""
    robots = dice.some(dice.robots)
    at = sorted(dice.number(0.0, dice.until_s) for _ in robots)
    faults = []
    for robot, begin in zip(dice.random.permutation(robots), at, strict=True):
        duration_s = dice.lasting(begin, dice.until_s)
        faults.append(FaultSection("cut", begin, (int(robot),), duration_s=duration_s))
    return faults


def _flapping(dice: Dice) -> Faults:
    """A link that comes and goes."""
    if len(dice.robots) < 2:
        return []
    a, b = (int(robot) for robot in dice.random.permutation(dice.robots)[:2])
    period, begin = dice.number(0.5, 5.0), dice.number(0.0, dice.until_s / 2.0)
    times = np.arange(begin, dice.until_s - period / 2.0, period).tolist()
    return [FaultSection("cut", round(at, 2), (a,), (b,), round(period / 2.0, 2)) for at in times[:12]]


TROUBLES: dict[str, Callable[[Dice], Faults]] = {
    "death": _death,
    "death and restart": _death_and_restart,
    "restart": _restart,
    "stop": _stop,
    "stop for good": _stop_for_good,
    "hold": _hold,
    "kidnap": _kidnap,
    "blind": _blind,
    "slow": _slow,
    "cut": _cut,
    "cut off": _cut_off,
    "corrupt": _corrupt,
    "jam": _jam,
    "heal": _heal,
    "decapitation": _decapitation,
    "at an event": _at_an_event,
    "swizzle": _swizzle,
    "flapping": _flapping,
}
"""Kinds of trouble; some are faults of one kind, others named schedules."""
