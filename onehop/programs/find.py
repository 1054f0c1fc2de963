"""A program by the name that a scenario gives it, and its parameters checked by its own dataclass."""

import os
import sys
from collections.abc import Iterable
from dataclasses import is_dataclass
from typing import Any

from onehop.contracts.errors import InputError, ScenarioError
from onehop.contracts.problems import Problem
from onehop.contracts.program_section import BUILT_IN
from onehop.contracts.ranges import out_of_range
from onehop.contracts.scenario import Scenario
from onehop.plugins import PROGRAMS, imported, value_of
from onehop.plugins import check as check_plugins
from onehop.robot import NoParameters, Program


def search_in(folder: str) -> None:
    """Look for programs in a folder too, and in the current one, before what is installed."""
    for place in (os.getcwd(), folder):
        if place and place not in sys.path:
            sys.path.insert(0, place)


def find(name: str, where: str = "program") -> type[Program]:
    """The class of a program. Raises InputError. where: what to call its key.

    name: "package.module:Class", or the name under which an installed package offers it.
    """
    remedy = '"package.module:Class", installed or in the folder of the scenario'
    found = imported(name, value_of(PROGRAMS, name, where, remedy), where, remedy)
    if not (isinstance(found, type) and issubclass(found, Program)):
        raise InputError(where, f"{name!r} is no onehop.robot.Program", remedy)
    return found


def parameters_of(program: type[Program], table: dict[str, Any], origin: str, key: str) -> Any:
    """What a program's `Parameters` make of a table. Raises InputError. origin, key: what to call it."""
    kind = program.Parameters
    if not is_dataclass(kind):
        name = f"{program.__module__}:{program.__qualname__}"
        raise InputError(
            f"{origin}: {key}", f"Parameters of {name} is no dataclass", "a frozen dataclass"
        )
    if kind is NoParameters and not table:
        return NoParameters()
    from onehop.scenario.structure import (
        structured,
    )  # a library of 20 ms that our own program does not need

    values = structured(table, kind, origin, key)
    problems: Iterable[Problem] = out_of_range(values)
    if hasattr(values, "problems"):
        problems = (*problems, *values.problems())
    for problem in problems:
        raise ScenarioError(f"{origin}: {key}.{problem.key}", problem.what, problem.remedy)
    return values


def check(scenario: Scenario, origin: str, robots: Iterable[int] | None = None) -> None:
    """See that all that a mission names is there.

    The programs of robots, by default all, with parameters that they take, and what is plugged in. Those
    of robots with a command are its own business. origin: what to call the scenario. Raises InputError.
    """
    check_plugins(scenario, origin)
    seen: list[tuple[str, dict[str, Any]]] = [(BUILT_IN, {})]  # its robots load it, and nobody else
    for robot in scenario.team.robots if robots is None else robots:
        if robot in scenario.commands:
            continue
        wanted = name, table = scenario.program_of(robot)
        if wanted in seen:
            continue
        seen.append(wanted)
        number = next((n for n, one in enumerate(scenario.robots) if one.id == robot), None)
        own = number is not None and scenario.robots[number].program == name
        where = f"{origin}: robots[{number}]" if own else f"{origin}: team"
        program = find(name, f"{where}.program")
        key = "team.parameters" if number is None else f"robots[{number}].parameters"
        parameters_of(program, table, origin, key)


def outsiders(scenario: Scenario) -> tuple[int, ...]:
    """Robots of which nobody else can tell what they do next, ids ascending.

    Those that are processes of somebody else's making, and those whose program goes by more than its
    percepts. Raises InputError for a program that is not there.
    """
    closed = {BUILT_IN: True}
    outside = []
    for robot in scenario.team.robots:
        name, _ = scenario.program_of(robot)
        if robot not in scenario.commands and name not in closed:
            closed[name] = find(name).reproducible
        if robot in scenario.commands or not closed[name]:
            outside.append(robot)
    return tuple(outside)


def require_programs(scenario: Scenario, origin: str) -> None:
    """See that a mission can be run in one process. origin: see `check`. Raises ScenarioError."""
    if scenario.clock.is_realtime:
        what = "one process has no real time: in it everyone waits for everyone"
        remedy = "onehop run with --driver processes, or --set clock.mode='\"lockstep\"'"
        raise ScenarioError(f"{origin}: clock.mode", what, remedy)
    for robot in outsiders(scenario):
        number = next((n for n, one in enumerate(scenario.robots) if one.id == robot), None)
        if robot in scenario.commands:
            key = f"robots[{number}].command"
            what = f"robot {robot} is a process of its own, and has no program to run in this one"
        else:
            own = number is not None and scenario.robots[number].program
            key = f"robots[{number}].program" if own else "team.program"
            what = f"robot {robot} is driven from outside, and nobody there keeps up with one process"
        remedy = "onehop run with --driver processes, or --set robots=[] for the team's program"
        raise ScenarioError(f"{origin}: {key}", what, remedy)
