"""What the numbers of a scenario may be: each field's type says its range, and one function checks all.

A field is declared as `Annotated[float, Range(least, most)]`, alone, optional, or inside tuples. Both
ends are values that the programs can carry; NaN and infinity are in no range.
"""

import dataclasses
import types
import typing
from collections.abc import Iterator
from functools import cache
from typing import Annotated, Any, NamedTuple

from onehop.contracts.problems import Problem


class Range(NamedTuple):
    """Least and greatest value of a number, both included."""

    least: float
    most: float

    def __str__(self) -> str:
        return f"{self.least:g} to {self.most:g}"


LONGEST_NUMBER = 40
"""Digits of a wrong number that are shown."""


def out_of_range(values: Any, key: str = "") -> Iterator[Problem]:
    """Every number of a dataclass, and of those within it, that is outside of its range.

    key: path of the values. TypeError for a number that was declared without a range: a mistake of
    ours, not of the file.
    """
    for name, kind in _declared(values.__class__):
        yield from _wrong(getattr(values, name), kind, f"{key}.{name}" if key else name)


@cache
def _declared(section: Any) -> tuple[tuple[str, Any], ...]:
    hints = typing.get_type_hints(section, include_extras=True)
    return tuple((field.name, hints[field.name]) for field in dataclasses.fields(section))


def _wrong(value: Any, kind: Any, key: str) -> Iterator[Problem]:
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    if origin is Annotated:
        limits = next(mark for mark in inner[1:] if isinstance(mark, Range))
        if not limits.least <= value <= limits.most:
            yield Problem(key, f"{shown(value)} is out of range", f"a number from {limits}")
    elif origin is tuple:
        each = inner[:1] * len(value) if inner[-1] is Ellipsis else inner
        for place, (one, one_kind) in enumerate(zip(value, each, strict=True)):
            yield from _wrong(one, one_kind, f"{key}[{place}]")
    elif origin in (types.UnionType, typing.Union):
        if value is not None:
            yield from _wrong(value, next(one for one in inner if one is not types.NoneType), key)
    elif dataclasses.is_dataclass(kind):
        yield from out_of_range(value, key)
    elif kind in (int, float):
        raise TypeError(f"{key} is declared without a range")


def shown(value: float) -> str:
    """A number for people; one of thousands of digits by its beginning and its length."""
    if isinstance(value, int) and value.bit_length() > 3 * LONGEST_NUMBER:
        return f"a number of {value.bit_length()} bits"
    return f"{value}"
