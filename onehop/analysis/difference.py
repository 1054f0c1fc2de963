"""The first difference of two logs: tick, channel, field, both values."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from onehop.analysis.log import Log
from onehop.analysis.payloads import decoded_fields
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.wire.codec import as_map
from onehop.wire.difference import first_difference
from onehop.wire.journal import canonical_rank


@dataclass(frozen=True, slots=True)
class Difference:
    """One message that differs. channel "" is the end of a log; a value is None where it is absent."""

    tick: int
    channel: str
    field: str
    a: Any
    b: Any


@dataclass(slots=True)
class Comparison:
    """What a comparison found. scenario: keys of the two scenarios that differ, with both values."""

    ticks: int = 0
    messages: int = 0
    differing: int = 0
    first: Difference | None = None
    scenario: list[tuple[str, Any, Any]] = field(default_factory=list)

    @property
    def same(self) -> bool:
        return self.first is None and not self.scenario


def compare(a: Log, b: Log) -> Comparison:
    """Compare two logs message by message, in canonical order, until the shorter one ends."""
    found = Comparison(scenario=list(_scenario_differences(as_map(a.scenario), as_map(b.scenario), "")))
    left, right = _ticks(a), _ticks(b)
    while True:
        mine, other = next(left, None), next(right, None)
        if mine is None or other is None:
            _add(found, _end(mine, other))
            return found
        found.ticks += 1
        for difference in _of_tick(mine, other, found):
            _add(found, difference)
        if mine[0] != other[0]:
            return found


TickMessages = tuple[int, dict[str, bytes]]
"""A tick, and its wire messages by bus key, as they stand in the log."""


def _ticks(log: Log) -> Iterator[TickMessages]:
    tick, messages = -1, dict[str, bytes]()
    for number, key, data in log.messages("truth", "radio", "rx/", "obs/", "out/"):
        if number != tick:
            if messages:
                yield tick, messages
            tick, messages = number, {}
        messages[key] = data
    if messages:
        yield tick, messages


def _of_tick(a: TickMessages, b: TickMessages, found: Comparison) -> Iterator[Difference]:
    if a[0] != b[0]:
        yield Difference(min(a[0], b[0]), "", "tick", a[0], b[0])
        return
    for key in sorted({*a[1], *b[1]}, key=canonical_rank):
        found.messages += 1
        mine, other = a[1].get(key), b[1].get(key)
        if mine == other:
            continue
        if mine is None or other is None:
            yield Difference(a[0], topics.wire(key), "message", _presence(mine), _presence(other))
        elif found.first is None:
            yield Difference(a[0], topics.wire(key), *_field(mine, other))
        else:
            yield Difference(a[0], topics.wire(key), "", None, None)


def _add(found: Comparison, difference: Difference | None) -> None:
    if difference is not None:
        found.differing += 1
        found.first = found.first or difference


def _presence(data: bytes | None) -> str | None:
    return None if data is None else "present"


def _field(a: bytes, b: bytes) -> tuple[str, Any, Any]:
    try:
        different = first_difference(decoded_fields(a), decoded_fields(b))
    except DecodeError:
        different = None
    return different or ("bytes", a.hex(), b.hex())


def _end(a: TickMessages | None, b: TickMessages | None) -> Difference | None:
    longer = a or b
    if longer is None:
        return None
    return Difference(longer[0], "", "end of the log", *("goes on" if one else None for one in (a, b)))


def _scenario_differences(a: Any, b: Any, path: str) -> Iterator[tuple[str, Any, Any]]:
    if isinstance(a, dict) and isinstance(b, dict):
        for key in a:
            yield from _scenario_differences(a[key], b.get(key), f"{path}.{key}" if path else key)
    elif a != b:
        yield path, a, b
