"""`onehop plugins`: what installed packages offer by name."""

from onehop.commands.output import emit_json, stdout, table
from onehop.contracts.errors import InputError
from onehop.contracts.printable import printable
from onehop.programs.find import GROUP, find, installed


def plugins(as_json: bool) -> int:
    """List the programs; exit status 1 if one cannot be loaded."""
    rows = []
    for one in installed():
        problem = None
        try:
            find(one.value, one.name)
        except InputError as error:
            problem = f"{error.problem}; {error.remedy}"
        package = f"{one.dist.name} {one.dist.version}" if one.dist is not None else ""
        rows.append({"name": one.name, "program": one.value, "package": package, "problem": problem})
    if as_json:
        emit_json({GROUP: rows})
    else:
        shown = table("Programs", "name", "program", "package", "problem")
        for row in rows:
            shown.add_row(*(printable(value or "") for value in row.values()))
        stdout().print(shown)
    return 0 if not any(row["problem"] for row in rows) else 1
