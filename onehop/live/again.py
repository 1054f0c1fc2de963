"""How to run a mission again with all that was done to it by hand: a command, and lines for a file."""

import shlex
from collections.abc import Sequence

from onehop.contracts.fault_section import FaultSection, in_toml
from onehop.contracts.scenario import Scenario


def by_hand(scenario: Scenario, begun: Sequence[FaultSection]) -> list[FaultSection]:
    """Of the faults that have begun those that no line of the scenario has caused.

    A line with a time causes what begins at the first tick then, one that follows an event the first
    fault of its kind that fits: of two that are the same in everything it may be either.
    """
    period_s = scenario.clock.period_ns / 1e9
    left = list(begun)
    for line in sorted(scenario.faults, key=lambda one: one.at_s is None):
        cause = next((one for one in left if _causes(line, one, period_s)), None)
        if cause is not None:
            left.remove(cause)
    return left


def _causes(line: FaultSection, begun: FaultSection, period_s: float) -> bool:
    at_s = begun.at_s or 0.0
    if line.at_s is not None:
        return line.at_s <= at_s < line.at_s + period_s and line.begun(at_s) == begun
    follows = line.begun(at_s)
    same = follows.given() | {"robots": begun.robots} == begun.given() | {"robots": begun.robots}
    return same and line.kind == begun.kind and follows.robots in ((), begun.robots)


def all_faults(scenario: Scenario, begun: Sequence[FaultSection]) -> list[FaultSection]:
    """The faults of a scenario with which it comes out as it has so far."""
    return [*scenario.faults, *by_hand(scenario, begun)]


def command(words: Sequence[str], scenario: Scenario, begun: Sequence[FaultSection]) -> str:
    """What to type. words: the command that has started the mission, without what only shows it."""
    own = [] if not by_hand(scenario, begun) else ["--set", f"faults=[{_listed(scenario, begun)}]"]
    return shlex.join(["onehop", "run", *words, *own])


def lines(scenario: Scenario, begun: Sequence[FaultSection]) -> str:
    """What a scenario file says: `faults = [...]`; empty without any."""
    faults = all_faults(scenario, begun)
    return "\n".join(["faults = [", *(f"    {in_toml(one)}," for one in faults), "]"]) if faults else ""


def _listed(scenario: Scenario, begun: Sequence[FaultSection]) -> str:
    return ", ".join(in_toml(one) for one in all_faults(scenario, begun))
