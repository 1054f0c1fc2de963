"""Which program drives a robot, and with which parameters: what of a name and a table can be neither.

Parameters are a free table here. The program's own dataclass says what may stand in it, and is asked
when a mission is about to run (onehop/programs), so that a log can be read where its programs are not.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from onehop.contracts.plugin_names import NAME, NAME_LETTERS
from onehop.contracts.problems import Problem
from onehop.contracts.ranges import Range

RobotId = Annotated[int, Range(1, 2**31 - 1)]

BUILT_IN = "robot_agent.core.robot:Robot"
"""The team of this project."""

_DEEPEST = 8
"""Tables and lists within each other."""

_WHOLE = Range(-(2**63), 2**63 - 1)
"""Whole numbers that travel to a robot."""


def program_problems(program: str) -> Iterator[Problem]:
    """What is wrong with the name of a program."""
    if not NAME.fullmatch(program) or len(program) > NAME_LETTERS:
        yield Problem("program", f"{program!r:.60} names no program", '"package.module:Class"')


def parameter_problems(parameters: Mapping[str, Any]) -> Iterator[Problem]:
    """Every value of a table of parameters that cannot travel to a robot."""
    for key, value in parameters.items():
        yield from _unsound(f"parameters.{key}", value, 0)


def _unsound(key: str, value: Any, depth: int) -> Iterator[Problem]:
    if depth > _DEEPEST:
        yield Problem(key, "nested too deeply", f"at most {_DEEPEST} tables and lists within each other")
    elif isinstance(value, dict):
        for name, inner in value.items():
            yield from _unsound(f"{key}.{name}", inner, depth + 1)
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from _unsound(f"{key}[{place}]", inner, depth + 1)
    elif isinstance(value, float) and not math.isfinite(value):
        yield Problem(key, f"{value} is no finite number", "a finite number")
    elif type(value) is int and not _WHOLE.least <= value <= _WHOLE.most:
        yield Problem(key, "a whole number beyond 64 bits", "whole numbers below 2^63")
    elif not isinstance(value, bool | int | float | str):
        kinds = "numbers, texts, true and false, lists and tables"
        yield Problem(key, f"{value!r:.60} cannot be a parameter", kinds)
