"""What a sweep varies: some keys of a scenario, and a cell for each combination of their values."""

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from onehop.contracts.errors import InputError, ScenarioError
from onehop.maps.map_file import load_map
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.scenario.changes import Change, parse_value, steps
from world_server.core.world import World

KeyValue = bool | int | float | str
"""Value of a key in a table: a list or a section is its JSON text."""

_OPEN, _CLOSE, _QUOTES = "[{", "]}", "\"'"


class Axis(NamedTuple):
    """A key of a scenario and the values that it is given, one after the other."""

    key: str
    values: Sequence[Any]


@dataclass(frozen=True, slots=True)
class Cell:
    """One combination. values: by key, as the scenario has them. bundle: a mission of it."""

    values: dict[str, KeyValue]
    bundle: Bundle

    @property
    def name(self) -> str:
        """The combination in a line: the same for the same values."""
        return " ".join(f"{key}={json.dumps(value)}" for key, value in self.values.items())

    def with_seed(self, seed: int) -> Bundle:
        """The mission of one seed."""
        return replace(self.bundle, scenario=replace(self.bundle.scenario, seed=seed))


def axis(text: str) -> Axis:
    """An axis from key.path=a,b,c, each value as TOML. Raises InputError."""
    key, equals, values = text.partition("=")
    pieces = list(_pieces(values)) if equals else []
    if not key.strip() or not all(pieces) or not pieces:
        problem = "not of the form key.path=value,value,..."
        raise InputError(f"--over {text}", problem, "e.g. gains.k_rho_min=0.1,0.3")
    return Axis(key.strip(), [parse_value(piece, f"{key}={piece}") for piece in pieces])


def _pieces(text: str) -> Iterator[str]:
    """What stands between commas that are in no list, table or text in quotes."""
    depth, quote, begin = 0, "", 0
    for at, letter in enumerate(text):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in _QUOTES:
            quote = letter
        elif letter == "," and not depth:
            yield text[begin:at].strip()
            begin = at + 1
        else:
            depth += (letter in _OPEN) - (letter in _CLOSE)
    yield text[begin:].strip()


def cells(path: Path, settings: Iterable[str], axes: Sequence[Axis], seed: int) -> list[Cell]:
    """Every combination, the last key fastest. seed: with which each is tried on its map.

    Raises InputError for what is no scenario, or cannot be started.
    """
    _require_apart(axes)
    fixed, made = list(settings), dict[str, Cell]()
    for combination in product(*(one.values for one in axes)):
        changes = [Change(one.key, value) for one, value in zip(axes, combination, strict=True)]
        cell = _cell(path, fixed, changes)
        if cell.name in made:
            raise InputError(f"--over {cell.name}", "stands twice", "every value of a key once")
        _require_start(path, cell, seed)
        made[cell.name] = cell
    return list(made.values())


def _require_apart(axes: Sequence[Axis]) -> None:
    taken: list[tuple[list[str], str]] = []
    for one in axes:
        if one.key == "seed":
            raise InputError("--over seed", "every cell has the same seeds", "give --seeds, --seed")
        if not one.values:
            raise InputError(f"--over {one.key}", "has no value", "at least one")
        path = steps(Change(one.key, one.values[0]))
        for other, key in taken:
            if path[: len(other)] == other or other[: len(path)] == path:
                remedy = "every key once, and none within another"
                raise InputError(f"--over {one.key}", f"is set by --over {key} as well", remedy)
        taken.append((path, one.key))


def _cell(path: Path, settings: list[str], changes: list[Change]) -> Cell:
    try:
        bundle = scenario_file.load(path, [*settings, *changes])
    except ScenarioError as error:
        if not changes:
            raise
        where = f"--over {' '.join(map(str, changes))}: {error.where.removeprefix('--set ')}"
        raise ScenarioError(where, error.problem, error.remedy) from None
    table = json.loads(bundle.scenario_json())
    return Cell({change.key: _value(table, change) for change in changes}, bundle)


def _value(table: Any, change: Change) -> KeyValue:
    """What a change has made of its key."""
    for step in steps(change):
        table = table[int(step)] if isinstance(table, list) else table[step]
    value: KeyValue = table if isinstance(table, KeyValue) else json.dumps(table)
    return value


def _require_start(path: Path, cell: Cell, seed: int) -> None:
    """Raise InputError if the team cannot start, as the world finds when it is built."""
    bundle = cell.with_seed(seed)
    where = f"{path} with {cell.name}" if cell.values else str(path)
    with scenario_file.in_file(Path(where)):
        World(bundle.scenario, load_map(bundle.scenario.map, bundle.files))
