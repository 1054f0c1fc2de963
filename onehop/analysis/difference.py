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
from onehop.wire.log_reader import LoggedTick


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
    ticks_a, ticks_b = a.file.ticks(), b.file.ticks()
    while True:
        one, other = next(ticks_a, None), next(ticks_b, None)
        if one is None or other is None:
            _add(found, _end(one, other))
            return found
        found.ticks += 1
        for difference in _of_tick(one, other, found):
            _add(found, difference)
        if one.tick != other.tick:
            return found


def _of_tick(a: LoggedTick, b: LoggedTick, found: Comparison) -> Iterator[Difference]:
    if a.tick != b.tick:
        yield Difference(min(a.tick, b.tick), "", "tick", a.tick, b.tick)
        return
    in_a, in_b = dict(a.messages), dict(b.messages)
    for key in sorted({*in_a, *in_b}, key=canonical_rank):
        found.messages += 1
        one, other = in_a.get(key), in_b.get(key)
        if one == other:
            continue
        if one is None or other is None:
            yield Difference(a.tick, topics.wire(key), "message", _presence(one), _presence(other))
        elif found.first is None:
            yield Difference(a.tick, topics.wire(key), *_field(one, other))
        else:
            yield Difference(a.tick, topics.wire(key), "", None, None)


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


def _end(a: LoggedTick | None, b: LoggedTick | None) -> Difference | None:
    longer = a or b
    if longer is None:
        return None
    return Difference(longer.tick, "", "end of the log", *("goes on" if one else None for one in (a, b)))


def _scenario_differences(a: Any, b: Any, path: str) -> Iterator[tuple[str, Any, Any]]:
    if isinstance(a, dict) and isinstance(b, dict):
        for key in a:
            yield from _scenario_differences(a[key], b.get(key), f"{path}.{key}" if path else key)
    elif a != b:
        yield path, a, b
