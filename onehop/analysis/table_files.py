"""The tables of a log as files, one each: CSV for everyone, Parquet for data frames.

CSV has a column for each beam of a scan, numbers separated by spaces in place of a list, hexadecimal
digits in place of bytes, JSON in place of a map, and nothing for what is not there.
"""

import csv
import importlib.util
import json
import math
import os
import tempfile
from collections.abc import Callable, Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

from onehop.analysis.columns import TABLES
from onehop.analysis.log import Log
from onehop.analysis.tables import Table
from onehop.contracts.errors import InputError
from onehop.wire.output_folder import explained

REMEDY = "a new folder, where one can be made"


def write_csv(log: Log, out: Path) -> dict[str, int]:
    """Write every table of a log that has rows into a new folder; how many rows each has."""
    return _write(log, out, ".csv", _to_csv)


def write_parquet(log: Log, out: Path) -> dict[str, int]:
    """The same; it needs Polars."""
    if importlib.util.find_spec("polars") is None:
        raise InputError("--to parquet", "Polars is not installed", "pip install 'onehop[tables]'")
    return _write(log, out, ".parquet", _to_parquet)


def _write(log: Log, out: Path, suffix: str, write: Callable[[Table, Path], None]) -> dict[str, int]:
    if out.exists():
        raise InputError(str(out), "exists already", REMEDY)
    rows: dict[str, int] = {}
    with explained(out, REMEDY):
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out.parent, prefix=".onehop-") as draft:
            folder = Path(draft) / out.name
            folder.mkdir()
            for name, table in _tables(log):
                if len(table):
                    write(table, folder / f"{name}{suffix}")
                    rows[name] = len(table)
            os.rename(folder, out)
    return rows


def _tables(log: Log) -> Iterator[tuple[str, Table]]:
    """Every table, those of the same messages in one pass."""
    for _, names in groupby(sorted(TABLES, key=lambda name: TABLES[name].key), lambda n: TABLES[n].key):
        yield from log.tables(*names).items()


def _to_csv(table: Table, path: Path) -> None:
    header: list[str] = []
    for name, column in table.items():
        header += [name] if column.ndim == 1 else [f"{name}_{n}" for n in range(column.shape[1])]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        columns = [column.tolist() for column in table.values()]
        for row in zip(*columns, strict=True):
            writer.writerow(
                [cell for value in row for cell in (value if type(value) is list else [_cell(value)])]
            )


def _cell(value: Any) -> Any:
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, dict):
        return _json(value)
    if isinstance(value, tuple):
        return " ".join(map(str, value))
    return "" if isinstance(value, float) and math.isnan(value) else value


def _json(values: dict[str, Any]) -> str:
    """JSON has no infinity (the width of no passage): it becomes a word."""
    plain = {
        name: str(value) if isinstance(value, float) and math.isinf(value) else value
        for name, value in values.items()
    }
    return json.dumps(plain, sort_keys=True)


def _to_parquet(table: Table, path: Path) -> None:
    import polars

    columns = {
        name: [
            _json(value) if isinstance(value, dict)
            else list(value) if isinstance(value, tuple)
            else value
            for value in column.tolist()
        ]
        for name, column in table.items()
    }  # fmt: skip
    polars.DataFrame(columns, strict=False).write_parquet(path)
