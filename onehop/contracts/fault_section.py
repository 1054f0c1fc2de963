"""One fault of a mission: its kinds, which keys each kind takes, and when it happens.

The same value is a scenario's `[[faults]]`, an order given by hand to a running mission, and what the
truth says of a fault that begins. docs/faults.md has the kinds as a table.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Annotated, Any, Literal, get_args

from onehop.contracts.problems import Problem
from onehop.contracts.program_section import RobotId
from onehop.contracts.ranges import Range
from onehop.contracts.sections import Coordinate, Seconds

FaultKind = Literal[
    "kill", "stop", "continue", "restart", "hold", "kidnap", "blind", "slow", "cut", "corrupt", "jam",
    "heal",
]  # fmt: skip

FaultEvent = Literal["", "leader elected", "formed", "narrow", "arrived"]

KINDS: tuple[FaultKind, ...] = get_args(FaultKind)

Direction = Literal["both", "from", "to"]

DIRECTIONS: tuple[Direction, ...] = get_args(Direction)

OWN_KEYS: dict[FaultKind, tuple[str, ...]] = {
    "kill": ("robots",),
    "stop": ("robots", "duration_s"),
    "continue": ("robots",),
    "restart": ("robots",),
    "hold": ("robots", "duration_s"),
    "kidnap": ("robots", "x", "y", "heading_deg"),
    "blind": ("robots", "duration_s"),
    "slow": ("robots", "duration_s", "delay_ticks"),
    "cut": ("robots", "others", "direction", "duration_s"),
    "corrupt": ("robots", "probability", "duration_s"),
    "jam": ("x", "y", "radius", "noise_dbm", "duration_s"),
    "heal": ("robots",),
}
"""What each kind can be given, besides when."""

TIMING = ("at_s", "on", "nth", "after_s")
"""Keys that say when."""

NEEDS_ROBOTS = frozenset(KINDS) - {"corrupt", "jam", "heal"}


@dataclass(frozen=True, slots=True)
class FaultSection:
    """One fault. It begins at the first tick at or after its time, and lasts from there.

    Either at_s [s], or `on`: after_s seconds after that has happened for the nth time. "leader elected":
    a robot begins to act as leader (the first time is the team's first leader). "formed": a leader says
    that its formation stands. "narrow": a leader orders a column. "arrived": a leader reaches the goal.
    With `on`, empty robots are the one robot that did it.

    kill robots. stop robots: their processes compute and say nothing; `continue` lets them go on.
    restart robots, each as a new process. hold robots: they stand still. kidnap one robot to x, y [m]
    and heading_deg. blind robots: their lasers see nothing. slow robots: each action takes effect
    delay_ticks late. cut robots from `others` (empty: from all the rest), in both directions, only what
    goes "from" robots, or only what goes "to" them. corrupt what robots (empty: all) receive: each
    payload's bytes change with this probability. jam a disc x, y, radius [m] with noise_dbm [dBm]. heal
    robots (empty: everything). A duration_s of 0 lasts to the end, or to the next `heal`.
    """

    kind: FaultKind
    at_s: Seconds | None = None
    robots: tuple[RobotId, ...] = ()
    others: tuple[RobotId, ...] = ()
    duration_s: Seconds = 0.0
    x: Coordinate = 0.0
    y: Coordinate = 0.0
    radius: Annotated[float, Range(0.0, 1e6)] = 0.0
    noise_dbm: Annotated[float, Range(-200.0, 100.0)] = -60.0
    on: FaultEvent = ""
    nth: Annotated[int, Range(1, 1_000_000)] = 1
    after_s: Seconds = 0.0
    heading_deg: Annotated[float, Range(-360.0, 360.0)] = 0.0
    direction: Direction = "both"
    probability: Annotated[float, Range(0.0, 1.0)] = 1.0
    delay_ticks: Annotated[int, Range(0, 1000)] = 0

    def problems(self) -> Iterator[Problem]:
        kind, keys = self.kind, OWN_KEYS[self.kind]
        if (self.at_s is None) == (not self.on):
            what = "neither at_s nor on is given" if self.at_s is None else "at_s and on at once"
            yield Problem("at_s", what, "a time in seconds, or the event that the fault follows")
        if not self.on and (self.nth != 1 or self.after_s):
            yield Problem("on", "nth or after_s without it", "the event that they count from")
        for key in self.given():
            if key not in keys and key not in TIMING:
                yield Problem(key, f"{kind} takes no {key}", f"{kind} takes {', '.join(keys)}")
        if kind in NEEDS_ROBOTS and not self.robots and not self.on:
            yield Problem("robots", f"{kind} of nobody", "name at least one robot")
        if kind == "kidnap" and len(self.robots) > 1:
            yield Problem("robots", f"{len(self.robots)} robots to one place", "one robot a kidnap")
        if kind == "cut" and set(self.robots) & set(self.others):
            yield Problem("others", "a robot is cut from itself", "robots that are not in robots")
        if kind == "slow" and not self.delay_ticks:
            yield Problem("delay_ticks", "slow by no tick", "how many ticks late actions are, from 1")
        if kind == "corrupt" and not self.probability > 0:
            yield Problem("probability", "nothing is corrupted", "above 0, up to 1 for every message")
        if kind == "jam" and not self.radius > 0:
            yield Problem("radius", "a jam without extent", "radius of the jammed disc [m]")

    def given(self) -> dict[str, Any]:
        """The keys with a value other than the default, in order, kind left out."""
        values = ((one.name, getattr(self, one.name), one.default) for one in fields(self)[1:])
        return {name: value for name, value, default in values if value != default}

    def begun(self, at_s: float) -> "FaultSection":
        """The fault as the truth tells it: when it began, and whom it concerns, whatever led to it."""
        robots, others = (tuple(sorted(set(ids))) for ids in (self.robots, self.others))
        return replace(self, at_s=at_s, robots=robots, others=others, on="", nth=1, after_s=0.0)


def fault_in_words(fault: FaultSection) -> str:
    """A fault for people, e.g. "kill 3", "jam within 8 m of (40, 40), 20 s"."""
    who = ", ".join(map(str, fault.robots))
    rest = ", ".join(map(str, fault.others)) or "the rest"
    what = {
        "kidnap": f"kidnap {who} to ({fault.x:g}, {fault.y:g})",
        "slow": f"slow {who} by {fault.delay_ticks} ticks",
        "cut": f"cut {who} {_DIRECTIONS[fault.direction]} {rest}",
        "corrupt": f"corrupt {100.0 * fault.probability:g} % of what {who or 'everyone'} receives",
        "jam": f"jam within {fault.radius:g} m of ({fault.x:g}, {fault.y:g})",
        "heal": f"heal {who or 'everything'}",
    }.get(fault.kind, f"{fault.kind} {who}")
    return what + (f", {fault.duration_s:g} s" if fault.duration_s else "")


_DIRECTIONS = {"both": "from", "from": "one way to", "to": "one way from"}


def in_toml(fault: FaultSection) -> str:
    """A fault as an inline table, e.g. {kind = "kill", at_s = 4.5, robots = [3]}."""
    words = [f"{key} = {_value(value)}" for key, value in fault.given().items()]
    return "{" + ", ".join([f'kind = "{fault.kind}"', *words]) + "}"


def _value(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    return f"[{', '.join(map(str, value))}]" if isinstance(value, tuple) else repr(value)
