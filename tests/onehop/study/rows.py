"""Made-up missions: a row with every measure, all zero but for what is given."""

from typing import Any

from onehop.study.table import COLUMNS


def row(values: dict[str, Any], seed: int, **measures: Any) -> dict[str, Any]:
    """A mission; what is not given is zero."""
    blank = {name: "" if kind is str else kind(0) for name, kind in COLUMNS.items()}
    return {**blank, "name": f"{values} {seed}", "values": values, "seed": seed, **measures}
