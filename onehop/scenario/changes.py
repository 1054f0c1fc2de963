"""Changes of single keys, as the command line gives them: key.path=value, the value as TOML."""

import tomllib
from typing import Any

from onehop.contracts.errors import ScenarioError


def apply_change(table: dict[str, Any], setting: str) -> None:
    """Change one key of a scenario's table in place. Raises ScenarioError."""
    key, equals, text = setting.partition("=")
    path = key.strip().split(".")
    if not equals or not all(path):
        raise ScenarioError(f"--set {setting}", "not of the form key.path=value", "e.g. team.size=4")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text.strip()
    except (ValueError, RecursionError) as error:
        problem = f"not a value that can be read ({error})"
        raise ScenarioError(f"--set {setting:.80}", problem, "e.g. team.size=4") from None
    target: Any = table
    for step in path[:-1]:
        target = _child(target, step, setting)
    _child(target, path[-1], setting)
    target[int(path[-1]) if isinstance(target, list) else path[-1]] = value


def _child(target: Any, step: str, setting: str) -> Any:
    if isinstance(target, dict) and not step.isdigit():
        return target.setdefault(step, {})
    if isinstance(target, list) and step.isdigit() and int(step) < len(target):
        return target[int(step)]
    raise ScenarioError(f"--set {setting}", f"there is no key {step} to set", "see the scenario file")
