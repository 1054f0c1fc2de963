"""Tables as CSV and Parquet: every row and column, whatever is in it."""

import csv
import json
from pathlib import Path

import numpy as np
import polars
import pytest

from onehop.analysis import Log
from onehop.analysis.columns import TABLES
from onehop.analysis.table_files import write_csv, write_parquet
from onehop.contracts.errors import InputError
from tests.onehop.command_line import onehop
from tests.onehop.log_forms import Form, ticks_of, write_form


def test_csv_has_every_row_of_every_table(log: Log, tmp_path: Path) -> None:
    rows = write_csv(log, tmp_path / "csv")
    for name in TABLES:
        table = log.table(name)
        assert rows.get(name, 0) == len(table)
        path = tmp_path / "csv" / f"{name}.csv"
        if not len(table):
            assert not path.exists()
            continue
        with path.open(newline="") as file:
            read = list(csv.DictReader(file))
        assert len(read) == len(table)
        assert [int(row["tick"]) for row in read] == table["tick"].tolist()
        if name == "poses":
            assert [float(row["x"]) for row in read] == table["x"].tolist()
        if name == "scans":
            last = [float(read[-1][f"ranges_{n}"]) for n in range(table["ranges"].shape[1])]
            assert np.array_equal(np.array(last, dtype=np.float32), table["ranges"][-1])
        if name == "notes":
            assert [json.loads(row["data"]).keys() for row in read] == [d.keys() for d in table["data"]]
        if name == "receptions":
            assert [bytes.fromhex(row["payload"]) for row in read] == table["payload"].tolist()


def test_parquet_has_the_same(log: Log, tmp_path: Path) -> None:
    rows = write_parquet(log, tmp_path / "parquet")
    for name, count in rows.items():
        table, read = log.table(name), polars.read_parquet(tmp_path / "parquet" / f"{name}.parquet")
        assert (len(read), read.columns) == (count, list(table))
    status = polars.read_parquet(tmp_path / "parquet" / "status.parquet")
    assert status["members"].to_list() == [list(one) for one in log.table("status")["members"]]
    scans = polars.read_parquet(tmp_path / "parquet" / "scans.parquet")
    assert scans["ranges"].to_list() == log.table("scans")["ranges"].tolist()


def test_a_folder_that_is_there_is_left_alone(log: Log, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="exists already"):
        write_csv(log, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_log_with_a_hole_is_told_of(log_path: Path, tmp_path: Path) -> None:
    ticks = ticks_of(log_path)
    write_form(log_path, tmp_path / "holed.mcap", Form(), [*ticks[:30], *ticks[60:]])
    done = onehop("export", tmp_path / "holed.mcap", "--to", "csv", "-o", tmp_path / "csv")
    assert done.returncode == 1
    assert "missing" in done.stderr
    assert (tmp_path / "csv" / "poses.csv").exists()
