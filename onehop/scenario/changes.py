"""Changes of single keys, as the command line gives them: key.path=value, the value as TOML.

An element of a list is named by its number from 0: `faults[0].duration_s`, or `faults.0.duration_s`.
"""

import re
import tomllib
from typing import Any, NamedTuple

from onehop.contracts.errors import ScenarioError

_INDEX = re.compile(r"\[(\d+)\]")


class Change(NamedTuple):
    """A key of a scenario and the value that it is given."""

    key: str
    value: Any

    def __str__(self) -> str:
        return f"{self.key}={self.value}"


def parse_change(setting: str) -> Change:
    """A change from key.path=value. Raises ScenarioError."""
    key, equals, text = setting.partition("=")
    if not equals:
        raise _malformed(setting)
    return Change(key.strip(), parse_value(text, setting))


def parse_value(text: str, setting: str) -> Any:
    """A value as TOML, or as text where it is none. setting: of which it is. Raises ScenarioError."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text.strip()
    except (ValueError, RecursionError) as error:
        problem = f"not a value that can be read ({error})"
        raise ScenarioError(f"--set {setting:.80}", problem, "e.g. team.size=4") from None


def apply_change(table: dict[str, Any], setting: str | Change) -> None:
    """Change one key of a scenario's table in place. Raises ScenarioError."""
    change = parse_change(setting) if isinstance(setting, str) else setting
    *stem, last = steps(change)
    target: Any = table
    for step in stem:
        target = _child(target, step, change)
    _child(target, last, change)
    target[int(last) if isinstance(target, list) else last] = change.value


def steps(change: Change) -> list[str]:
    """The key's path, element by element. Raises ScenarioError."""
    path = _INDEX.sub(r".\1", change.key).split(".")
    if not all(path):
        raise _malformed(str(change))
    return path


def _child(target: Any, step: str, change: Change) -> Any:
    if isinstance(target, dict) and not step.isdigit():
        return target.setdefault(step, {})
    if isinstance(target, list) and step.isdigit() and int(step) < len(target):
        return target[int(step)]
    raise ScenarioError(f"--set {change}", f"there is no key {step} to set", "see the scenario file")


def _malformed(setting: str) -> ScenarioError:
    return ScenarioError(f"--set {setting}", "not of the form key.path=value", "e.g. team.size=4")
