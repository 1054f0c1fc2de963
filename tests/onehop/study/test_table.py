"""The table of a sweep: its cells, its paired differences, its Parquet."""

import json
from pathlib import Path
from typing import Any

import pytest

from onehop.study.table import COLUMNS, MEASURES, Missions

KEYS = {"gains.policy": "constant", "faults[0].duration_s": 5.0}


def row(policy: str, duration_s: float, seed: int, **measures: float | None) -> dict[str, Any]:
    """A mission; what is not given is zero."""
    blank = {name: "" if kind is str else kind(0) for name, kind in COLUMNS.items()}
    values = {"gains.policy": policy, "faults[0].duration_s": duration_s}
    return {**blank, "name": f"{values} {seed}", "values": values, "seed": seed, **measures}


ROWS = [
    row("constant", 5.0, 1, lost=2, delay_ms=20.0),
    row("constant", 5.0, 2, lost=4, delay_ms=30.0),
    row("constant", 5.0, 3, lost=6, delay_ms=None),
    row("constant", 9.0, 1, lost=3, delay_ms=25.0),
    row("constant", 9.0, 2, lost=3, delay_ms=25.0),
    row("throughput", 5.0, 2, lost=3, delay_ms=31.0),
    row("throughput", 5.0, 3, lost=5, delay_ms=32.0),
    row("throughput", 5.0, 4, lost=0, delay_ms=33.0),
]


def test_a_cell_has_its_keys_its_seeds_and_every_measure() -> None:
    cells = Missions(KEYS, ROWS).cells()
    assert [(cell["gains.policy"], cell["faults[0].duration_s"], cell["seeds"]) for cell in cells] == [
        ("constant", 5.0, 3), ("constant", 9.0, 2), ("throughput", 5.0, 3),
    ]  # fmt: skip
    assert set(cells[0]) == {
        *KEYS, "seeds", *(f"{name}_mean" for name in MEASURES), *(f"{name}_ci95" for name in MEASURES),
    }  # fmt: skip
    assert cells[0]["lost_mean"] == 4.0
    low, high = cells[0]["lost_ci95"]
    assert 2.0 <= low < 4.0 < high <= 6.0
    assert cells[0]["delay_ms_mean"] == 25.0
    assert cells[1]["lost_ci95"] == [3.0, 3.0]
    json.dumps(cells, allow_nan=False)


def test_differences_are_taken_seed_by_seed_against_the_first_value() -> None:
    """Constant and throughput share seeds 2 and 3, in which throughput loses one less: no spread, though
    the seeds differ by two. Delays are compared in seed 2 alone: in seed 3 there is none.
    """
    found = Missions(KEYS, ROWS).differences()
    policy, duration = found
    assert (policy["key"], policy["against"], policy["gains.policy"]) == (
        "gains.policy", "constant", "throughput",
    )  # fmt: skip
    assert (policy["seeds"], policy["lost_mean"], policy["lost_ci95"]) == (2, -1.0, [-1.0, -1.0])
    assert (policy["delay_ms_mean"], policy["delay_ms_ci95"]) == (1.0, [None, None])
    assert (duration["key"], duration["against"], duration["faults[0].duration_s"]) == (
        "faults[0].duration_s", 5.0, 9.0,
    )  # fmt: skip
    assert (duration["seeds"], duration["lost_mean"]) == (2, 0.0)


def test_a_cell_whose_first_value_has_no_missions_is_not_compared() -> None:
    assert Missions(KEYS, ROWS[5:]).differences() == []


def test_columns_are_arrays_with_nan_and_empty_text_for_what_is_not_there() -> None:
    missions = Missions(KEYS, ROWS)
    assert len(missions) == len(ROWS)
    assert list(missions) == [*KEYS, *COLUMNS]
    assert missions["lost"].tolist() == [2, 4, 6, 3, 3, 3, 5, 0]
    assert str(missions["delay_ms"].tolist()[2]) == "nan"
    assert missions.where(missions["lost"] > 4)["seed"].tolist() == [3, 3]


def test_the_parquet_file_has_the_rows_and_their_types(tmp_path: Path) -> None:
    polars = pytest.importorskip("polars")
    path = tmp_path / "missions.parquet"
    assert Missions(KEYS, ROWS).write_parquet(path)
    frame = polars.read_parquet(path)
    assert frame.columns == [*KEYS, *COLUMNS]
    assert frame["delay_ms"].to_list() == [row["delay_ms"] for row in ROWS]
    kinds = {int: polars.Int64, float: polars.Float64, str: polars.String}
    assert all(frame.schema[name] == kinds[kind] for name, kind in COLUMNS.items())
    assert [file.name for file in tmp_path.iterdir()] == ["missions.parquet"]


def test_a_sweep_of_nothing_yet_is_an_empty_table(tmp_path: Path) -> None:
    empty = Missions(KEYS, [])
    assert (len(empty), empty.cells(), empty.differences()) == (0, [], [])
    pytest.importorskip("polars")
    assert empty.write_parquet(tmp_path / "missions.parquet")


def test_every_column_is_explained() -> None:
    text = (Path(__file__).parents[3] / "docs" / "sweeps.md").read_text()
    assert [name for name in COLUMNS if f"`{name}`" not in text] == []
