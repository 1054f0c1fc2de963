"""The first difference of two logs: tick, channel, field, both values."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from onehop.analysis.log import Log
from onehop.analysis.payloads import decoded_fields
from onehop.contracts import topics
from onehop.contracts.errors import DecodeError
from onehop.wire.audit import Audit
from onehop.wire.codec import as_map
from onehop.wire.difference import first_difference
from onehop.wire.journal import canonical_rank
from onehop.wire.log_reader import LoggedTick


@dataclass(frozen=True, slots=True)
class Difference:
    """One message that differs; a value is None where it is absent.

    channel "": ticks from this one on that only one of the logs has.
    """

    tick: int
    channel: str
    field: str
    a: Any
    b: Any


@dataclass(slots=True)
class Comparison:
    """What a comparison found. scenario: keys of the two scenarios that differ, with both values.

    ticks: how many both have. flaws_a, flaws_b: why a log is not all that was said (audit.py).
    """

    ticks: int = 0
    messages: int = 0
    differing: int = 0
    first: Difference | None = None
    scenario: list[tuple[str, Any, Any]] = field(default_factory=list)
    flaws_a: list[str] = field(default_factory=list)
    flaws_b: list[str] = field(default_factory=list)

    @property
    def same(self) -> bool:
        """Whether everything was compared, and nothing differs."""
        flawed = self.flaws_a or self.flaws_b
        return self.messages > 0 and self.first is None and not self.scenario and not flawed


def compare(a: Log, b: Log) -> Comparison:
    """Compare two logs message by message, in canonical order. Raises LogError."""
    found = Comparison(scenario=list(_scenario_differences(as_map(a.scenario), as_map(b.scenario), "")))
    audit_a, audit_b = Audit(a.file), Audit(b.file)
    last: tuple[bool, bool] = (True, True)
    for tick, one, other in _side_by_side(audit_a.ticks(), audit_b.ticks()):
        if one is not None and other is not None:
            found.ticks += 1
            for difference in _of_tick(one, other, found):
                _add(found, difference)
        elif (one is not None, other is not None) != last:
            _add(found, Difference(tick, "", "tick", *map(_presence, (one, other))))
        last = one is not None, other is not None
    found.flaws_a, found.flaws_b = audit_a.flaws, audit_b.flaws
    return found


def _side_by_side(
    a: Iterator[LoggedTick], b: Iterator[LoggedTick]
) -> Iterator[tuple[int, LoggedTick | None, LoggedTick | None]]:
    """Each tick that one of two logs has, with None for the log that has it not."""
    one, other = next(a, None), next(b, None)
    while one is not None or other is not None:
        tick = min(side.tick for side in (one, other) if side is not None)
        here = one if one is not None and one.tick == tick else None
        there = other if other is not None and other.tick == tick else None
        yield tick, here, there
        one = one if here is None else next(a, None)
        other = other if there is None else next(b, None)


def _of_tick(a: LoggedTick, b: LoggedTick, found: Comparison) -> Iterator[Difference]:
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


def _add(found: Comparison, difference: Difference) -> None:
    found.differing += 1
    found.first = found.first or difference


def _presence(what: object) -> str | None:
    return None if what is None else "present"


def _field(a: bytes, b: bytes) -> tuple[str, Any, Any]:
    try:
        different = first_difference(decoded_fields(a), decoded_fields(b))
    except DecodeError:
        different = None
    return different or ("bytes", a.hex(), b.hex())


def _scenario_differences(a: Any, b: Any, path: str) -> Iterator[tuple[str, Any, Any]]:
    if isinstance(a, dict) and isinstance(b, dict):
        for key in a:
            yield from _scenario_differences(a[key], b.get(key), f"{path}.{key}" if path else key)
    elif a != b:
        yield path, a, b
