"""Messages of a log as columns: one NumPy array a column, one row a message or a part of one.

Every table has the columns tick and time_s (simulated); the others are in columns.TABLES. Ids are int64,
quantities float64 in SI units or with the unit in the name, words are text, and what varies in length
(members, path, payload, data) is an object column of tuples, bytes or maps.
"""

from collections.abc import Callable, Iterable, Iterator
from itertools import repeat
from typing import Any

import numpy as np

from onehop.analysis.columns import BUS_KEY, TABLES, Column, ColumnSpec, TableSpec
from onehop.wire.logged import TickMessage, decoded
from onehop.wire.selection import Selected

Row = tuple[Any, ...]


class Table(dict[str, Column]):
    """Columns of equal length by name."""

    def __len__(self) -> int:
        """Number of rows, not of columns."""
        return len(next(iter(self.values()))) if self.keys() else 0

    def where(self, mask: Column) -> "Table":
        """The rows that a boolean array or an array of indices picks."""
        return Table({name: column[mask] for name, column in self.items()})

    def of(self, robot: int) -> "Table":
        """The rows of one robot."""
        return self.where(self["robot"] == robot)

    def rows(self, *names: str) -> Iterator[tuple[Any, ...]]:
        """These columns row by row, as plain Python values."""
        return zip(*(self[name].tolist() for name in names), strict=True)

    def to_polars(self) -> Any:
        """The same as a polars.DataFrame; needs the extra `tables`."""
        import polars

        return polars.DataFrame({name: column.tolist() for name, column in self.items()})


def _row_maker(columns: Iterable[ColumnSpec]) -> Callable[[Any, int], Row]:
    """Takes the values of a row out of its part: `lambda part, robot: (robot, part.pose.x, ...)`.

    Compiled from the places of the columns, because a call for each value would take twice as long.
    """
    values, names = [], {}
    for number, column in enumerate(columns):
        value = "robot" if column.place == BUS_KEY else f"part.{column.place or column.name}"
        if column.kind.value is not None:
            names[f"value_{number}"] = column.kind.value
            value = f"value_{number}({value})"
        values.append(value)
    maker: Callable[[Any, int], Row] = eval(f"lambda part, robot: ({', '.join(values)},)", names)
    return maker


class _Builder:
    """One table in the making."""

    def __init__(self, spec: TableSpec) -> None:
        self._columns = spec.columns
        self._parts = spec.parts
        self._row = _row_maker(spec.columns)
        self._ticks: list[int] = []
        self._rows: list[Row] = []

    def add(self, tick: int, message: TickMessage, robot: int) -> None:
        for part in self._parts(message):
            self._ticks.append(tick)
            self._rows.append(self._row(part, robot))

    def finish(self, period_ns: int) -> Table:
        ticks = np.array(self._ticks, dtype=np.int64)
        table = Table({"tick": ticks, "time_s": ticks * (period_ns / 1e9)})
        columns = self._columns
        values = zip(*self._rows, strict=True) if self._rows else repeat((), len(columns))
        for column, content in zip(columns, values, strict=True):
            table[column.name] = column.kind.column(content)
        return table


def build(
    names: Iterable[str], messages: Iterable[Selected], period_ns: int, in_lock_step: bool = True
) -> dict[str, Table]:
    """Several tables in one pass over the messages; each message is decoded once.

    in_lock_step: nobody can be late. Raises DecodeError for a message that is none of its key and tick.
    """
    builders = {name: _Builder(TABLES[name]) for name in names}
    by_stem: dict[str, list[_Builder]] = {}
    for name, builder in builders.items():
        by_stem.setdefault(TABLES[name].key.rstrip("/"), []).append(builder)
    for selected in messages:
        stem, _, robot = selected.key.partition("/")
        wanting = by_stem.get(stem)
        if wanting:
            message, sender = decoded(selected, in_lock_step), int(robot or 0)
            for builder in wanting:
                builder.add(selected.tick, message, sender)
    return {name: builder.finish(period_ns) for name, builder in builders.items()}
