"""`onehop diff`: the first difference of two logs."""

from pathlib import Path
from typing import Any

from onehop.analysis.difference import Comparison, compare
from onehop.commands.logs import open_with_warning, warn_of_flaws
from onehop.commands.output import emit_json
from onehop.contracts.printable import json_value, printable


def diff(a: Path, b: Path, as_json: bool) -> int:
    """Print what differs first; exit status 1 if anything does."""
    left, right = open_with_warning(a), open_with_warning(b)
    found = compare(left, right)
    if as_json:
        emit_json(_as_json(found))
    else:
        _print(found, left.period_ns / 1e9)
    warn_of_flaws(a, found.flaws_a)
    warn_of_flaws(b, found.flaws_b)
    return 0 if found.same else 1


def _as_json(found: Comparison) -> dict[str, Any]:
    first = found.first
    return {
        "same": found.same,
        "ticks": found.ticks,
        "messages": found.messages,
        "differing": found.differing,
        "first": None
        if first is None
        else {
            "tick": first.tick, "topic": first.channel, "field": first.field,
            "a": json_value(first.a), "b": json_value(first.b),
        },
        "scenario": [{"key": key, "a": one, "b": other} for key, one, other in found.scenario],
        "flaws": {"a": found.flaws_a, "b": found.flaws_b},
    }  # fmt: skip


def _brief(value: Any) -> str:
    """A value of a scenario on one line; of a fault only the keys that are set."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {inner!r}" for key, inner in value.items() if inner)
    if isinstance(value, list | tuple) and any(isinstance(inner, dict) for inner in value):
        return "; ".join(_brief(inner) for inner in value)
    return repr(value) if value or not isinstance(value, list | tuple) else "none"


def _print(found: Comparison, period: float) -> None:
    for key, one, other in found.scenario:
        print(f"scenario {key}:\n  a: {_brief(one):.120}\n  b: {_brief(other):.120}")
    first = found.first
    if first is None and not found.messages:
        print("nothing was compared: no log has a message")
        return
    if first is None:
        print(f"no difference in {found.messages} messages of {found.ticks} ticks")
        return
    print(f"{found.differing} differences in {found.messages} messages of {found.ticks} common ticks")
    where = f"{first.channel}, field {printable(first.field)}" if first.channel else first.field
    print(f"first: tick {first.tick} ({first.tick * period:.2f} s), {where}")
    print(f"  a: {first.a!r:.200}\n  b: {first.b!r:.200}")
