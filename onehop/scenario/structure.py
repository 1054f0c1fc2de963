"""From nested tables, as TOML or JSON gives them, to a checked Scenario: every mistake by its key."""

import difflib
from dataclasses import fields
from typing import Any, Literal, TypeVar, get_args, get_origin

import cattrs
from cattrs import AttributeValidationNote, IterableValidationNote

from onehop.contracts.errors import ScenarioError
from onehop.contracts.scenario import Scenario
from onehop.scenario.profile import with_profile

T = TypeVar("T")


class _MismatchError(ValueError):
    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(what)
        self.what = what
        self.remedy = remedy


_KIND_NAMES = {bool: "true or false", int: "a whole number", float: "a number", str: "a text in quotes"}


def _scalar(value: Any, kind: Any) -> Any:
    if kind is float and type(value) is int:
        try:
            return float(value)
        except OverflowError:
            raise _MismatchError("an integer beyond all numbers", "give a finite number") from None
    if type(value) is not kind:
        raise _MismatchError(f"{value!r:.60} is not {_KIND_NAMES[kind]}", f"give {_KIND_NAMES[kind]}")
    return value


def _is_literal(kind: Any) -> bool:
    return bool(get_origin(kind) == Literal)


def _choice(value: Any, kind: Any) -> Any:
    choices = get_args(kind)
    if value not in choices:
        raise _MismatchError(f"{value!r:.60} is unknown", f"one of {', '.join(map(repr, choices))}")
    return value


def _is_name(kind: Any) -> bool:
    """Whether a kind is one of some words, or a text that names something else."""
    return str in get_args(kind) and any(map(_is_literal, get_args(kind)))


def _name(value: Any, _: Any) -> Any:
    return _scalar(value, str)


def _make_converter() -> cattrs.Converter:
    converter = cattrs.Converter(forbid_extra_keys=True)
    for kind in (bool, int, float, str):
        converter.register_structure_hook(kind, _scalar)
    converter.register_structure_hook_func(_is_literal, _choice)
    converter.register_structure_hook_func(_is_name, _name)
    return converter


_CONVERTER = _make_converter()


def structured(table: dict[str, Any], kind: type[T], origin: str, key: str = "") -> T:
    """The dataclass that a table is. origin, key: what to call the table. Raises ScenarioError."""
    try:
        return _CONVERTER.structure(table, kind)
    except cattrs.BaseValidationError as error:
        raise _first_mistake(error, origin, table, key) from None


def structure(table: dict[str, Any], origin: str) -> Scenario:
    """The scenario of a table. origin: what to call the table. Raises ScenarioError, naming the key."""
    scenario = structured(with_profile(table), Scenario, origin)
    problem = next(scenario.problems(), None)
    if problem is not None:
        raise ScenarioError(f"{origin}: {problem.key}", problem.what, problem.remedy)
    return scenario


def _first_mistake(error: BaseException, origin: str, table: Any, key: str) -> ScenarioError:
    """The first leaf of cattrs' tree of errors, with its key path."""
    path = [f".{key}"] if key else []
    value = table
    while isinstance(error, cattrs.BaseValidationError):
        kind = error.cl
        error = error.exceptions[0]
        for note in getattr(error, "__notes__", ()):
            if isinstance(note, AttributeValidationNote):
                path.append(f".{note.name}")
                value = value.get(note.name) if isinstance(value, dict) else None
            elif isinstance(note, IterableValidationNote):
                path.append(f"[{note.index}]")
                value = value[int(note.index)] if isinstance(value, list) else None
        if isinstance(error, cattrs.ForbiddenExtraKeysError):
            unknown = sorted(error.extra_fields)[0]
            known = [f.name for f in fields(kind)]
            near = difflib.get_close_matches(unknown, known, 1)
            remedy = f"did you mean {near[0]}?" if near else f"known keys: {', '.join(known)}"
            return ScenarioError(_where(origin, [*path, f".{unknown}"]), "unknown key", remedy)
    where = _where(origin, path)
    if isinstance(error, _MismatchError):
        return ScenarioError(where, error.what, error.remedy)
    if isinstance(error, KeyError):
        return ScenarioError(where, "is missing", "every scenario has to give it")
    return ScenarioError(where, f"{value!r:.60} has the wrong form", "see scenarios/map1.toml")


def _where(origin: str, path: list[str]) -> str:
    key = "".join(path).lstrip(".")
    return f"{origin}: {key}" if key else origin
