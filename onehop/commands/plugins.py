"""`onehop plugins`: what can be named in a scenario, and where each comes from."""

from importlib.metadata import EntryPoint
from typing import Any

from onehop.commands.output import emit_json, stdout, table
from onehop.contracts.errors import InputError
from onehop.contracts.printable import printable
from onehop.contracts.scenario import BUILT_IN
from onehop.plugins import KINDS, PROGRAMS, installed, load
from onehop.programs.find import find

OURS = "onehop"
"""The package that the built-in ones come from."""


def plugins(as_json: bool) -> int:
    """List programs and plugins of all groups; exit status 1 if one cannot be loaded."""
    groups = {group: [_row(group, one) for one in installed(group)] for group in (PROGRAMS, *KINDS)}
    if as_json:
        emit_json(groups)
    else:
        for group, rows in groups.items():
            key = KINDS[group].key if group in KINDS else "team.program"
            shown = table(f"{group} ({key})", "name", "what", "package", "problem")
            for row in rows:
                shown.add_row(*(printable(value or "") for value in row.values()))
            stdout().print(shown)
    return 1 if any(row["problem"] for rows in groups.values() for row in rows) else 0


def _row(group: str, one: EntryPoint) -> dict[str, Any]:
    package = f"{one.dist.name} {one.dist.version}" if one.dist is not None else ""
    what = "program" if group == PROGRAMS else "value"
    return {"name": one.name, what: one.value, "package": package, "problem": _problem(group, one)}


def _problem(group: str, one: EntryPoint) -> str | None:
    """Why a scenario cannot name it; None if it can."""
    is_ours = one.dist is not None and one.dist.name == OURS
    if group in KINDS and one.name in BUILT_IN[group] and not is_ours:
        return "the name of a built-in one, which is taken; give it another name"
    if not is_ours and sum(other.name == one.name for other in installed(group)) > 1:
        return "several packages offer this name; name it as it stands here"
    try:
        find(one.value, one.name) if group == PROGRAMS else load(group, one.value, one.name)
    except InputError as error:
        return f"{error.problem}; {error.remedy}"
    return None
