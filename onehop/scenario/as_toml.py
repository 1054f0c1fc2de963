"""A scenario as the text of a scenario file: what differs from the defaults, and nothing else."""

import json
from collections.abc import Iterator
from dataclasses import MISSING, Field, fields, is_dataclass
from typing import Any

from onehop.contracts.fault_section import in_toml
from onehop.contracts.scenario import Scenario


def as_toml(scenario: Scenario, comment: str = "") -> str:
    """The text; `scenario_file.load` reads the same scenario from it. comment: lines to begin with.

    With a profile its sections are written out, since what they leave out would be filled in. A map file
    is named as in the scenario: it has to lie where its name says, seen from the text's file.
    """
    lines = [f"# {line}".rstrip() for line in comment.splitlines()]
    lines += [""] if lines else []
    values = [one for one in fields(scenario) if not is_dataclass(getattr(scenario, one.name))]
    for one in values:
        value = getattr(scenario, one.name)
        if one.name == "faults" and value:
            lines += ["faults = [", *(f"    {in_toml(fault)}," for fault in value), "]"]
        elif value != _default(one):
            lines.append(f"{one.name} = {_value(value)}")
    for one in fields(scenario):
        section = getattr(scenario, one.name)
        if is_dataclass(section):
            changed = list(_changed(section, is_profiled=scenario.profile != "team"))
            if changed:
                lines += ["", f"[{one.name}]", *changed]
    return "\n".join(lines) + "\n"


def _changed(section: Any, is_profiled: bool) -> Iterator[str]:
    for one in fields(section):
        value = getattr(section, one.name)
        if value is not None and (is_profiled or value != _default(one)):
            yield f"{one.name} = {_value(value)}"


def _default(one: "Field[Any]") -> Any:
    """The default of a field; MISSING, which equals no value, where it has to be given."""
    return one.default_factory() if one.default_factory is not MISSING else one.default


def _value(value: Any) -> str:
    if is_dataclass(value):
        return f"{{{', '.join(_changed(value, is_profiled=False))}}}"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_value(str(key))} = {_value(one)}' for key, one in value.items())}}}"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(_value, value))}]"
    return repr(value)
