"""The missions of a sweep as a table, and what they say: means of each cell, paired differences."""

import importlib.util
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from onehop.analysis.columns import Column
from onehop.analysis.tables import Table
from onehop.campaign.lines import Row
from onehop.study.grid import KeyValue
from onehop.study.statistics import Estimate, estimate
from onehop.wire.output_folder import explained

COLUMNS: dict[str, type] = {
    "seed": int, "outcome": str, "reason": str, "arrived": int, "lost": int, "lost_robots": str,
    "shape": str, "ticks": int, "sim_s": float, "throughput_bps": float, "below_threshold_s": float,
    "error_m": float, "delay_ms": float, "delivery_ratio": float, "routing_bytes": int, "ber": float,
    "drive_j": float, "radio_j": float, "connected_share": float, "driven_m": float, "led_m": float,
    "collisions": int, "digest": str, "as_processes": str, "log": str,
}  # fmt: skip
"""Columns of the table, after one for each key that was varied."""

MEASURES = (
    "lost", "sim_s", "throughput_bps", "below_threshold_s", "error_m", "delay_ms", "routing_bytes",
    "ber", "drive_j", "radio_j", "connected_share", "collisions",
)  # fmt: skip
"""Measures of which a cell has a mean and an interval."""

Values = tuple[KeyValue, ...]
"""Of each key, in order."""


class Missions(Table):
    """One row a mission, by cell and seed. first: the keys that were varied, each with its first value.

    What was not measured is nan or "", in Parquet null.
    """

    def __init__(self, first: Mapping[str, KeyValue], rows: Sequence[Row]) -> None:
        self._first = dict(first)
        self._rows = rows
        varied = {key: np.array([row["values"][key] for row in rows]) for key in first}
        own = {name: _column(kind, [row[name] for row in rows]) for name, kind in COLUMNS.items()}
        super().__init__(varied | own)

    def to_polars(self) -> Any:
        """The same as a polars.DataFrame, with null for what was not measured; needs Polars."""
        import polars

        columns = {key: self[key].tolist() for key in self._first}
        own = {name: [row[name] for row in self._rows] for name in COLUMNS}
        return polars.DataFrame(columns | own, schema=dict.fromkeys(columns) | COLUMNS)

    def cells(self) -> list[dict[str, Any]]:
        """Of each cell its values, how many seeds it has, and means and intervals of the measures."""
        return [
            {
                **dict(zip(self._first, values, strict=True)),
                "seeds": len(rows),
                **_estimates((name, estimate([row[name] for row in rows])) for name in MEASURES),
            }
            for values, rows in self._by_cell().items()
        ]

    def differences(self) -> list[dict[str, Any]]:
        """Of each cell what changes from that with the first value of one key, seed by seed.

        `key` and `against` say which, the keys' values are those of the cell; `seeds` are those that
        both have.
        """
        by_cell = self._by_cell()
        found = []
        for place, (key, first) in enumerate(self._first.items()):
            for values, rows in by_cell.items():
                base = by_cell.get((*values[:place], first, *values[place + 1 :]))
                if values[place] == first or base is None:
                    continue
                pairs = _pairs(base, rows)
                found.append(
                    {
                        "key": key,
                        "against": first,
                        **dict(zip(self._first, values, strict=True)),
                        "seeds": len(pairs),
                        **_estimates((name, estimate(_differences(pairs, name))) for name in MEASURES),
                    }
                )
        return found

    def _by_cell(self) -> dict[Values, list[Row]]:
        found: dict[Values, list[Row]] = {}
        for row in self._rows:
            found.setdefault(tuple(row["values"][key] for key in self._first), []).append(row)
        return found

    def write_parquet(self, path: Path) -> bool:
        """Write the table, whole or not at all; False without Polars. Raises InputError."""
        if importlib.util.find_spec("polars") is None:
            return False
        draft = path.with_name(path.name + ".part")
        with explained(path, "a folder that can be written"):
            self.to_polars().write_parquet(draft)
            draft.replace(path)
        return True


def _column(kind: type, values: list[Any]) -> Column:
    if kind is str:
        return np.array(["" if value is None else value for value in values], dtype=np.str_)
    return np.array(values, dtype=np.float64 if kind is float else np.int64)


def _estimates(named: Iterable[tuple[str, Estimate]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, one in named:
        found[f"{name}_mean"], found[f"{name}_ci95"] = one.mean, [one.low, one.high]
    return found


def _pairs(base: list[Row], rows: list[Row]) -> list[tuple[Row, Row]]:
    """Missions of the same seed."""
    of_seed = {row["seed"]: row for row in base}
    return [(of_seed[row["seed"]], row) for row in rows if row["seed"] in of_seed]


def _differences(pairs: list[tuple[Row, Row]], name: str) -> list[float]:
    values = [(before[name], after[name]) for before, after in pairs]
    return [after - before for before, after in values if before is not None and after is not None]
