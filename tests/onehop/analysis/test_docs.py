"""The examples of docs/reading-logs.md run, and its table of columns is true."""

import re
from pathlib import Path

import pytest

from onehop.analysis.tables import TABLES

ROW = re.compile(r"^\| (`.*?) \| .*? \| (`.*?)(?: \(.*)? \|$", re.MULTILINE)
WORDS = re.compile(r"`([\w ]+)`")
PAGE = Path(__file__).parents[3] / "docs" / "reading-logs.md"


def test_the_worked_example_runs(log_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(), flags=re.DOTALL)
    exec(compile(example, str(PAGE), "exec"), {"path": log_path})
    printed = capsys.readouterr().out
    assert "small (1, 2, 3, 4) arrived" in printed
    assert "poses between 2 and 3 s" in printed


def test_every_table_stands_in_the_page_with_its_columns() -> None:
    described = {
        name: columns.split()
        for names, contents in ROW.findall(PAGE.read_text())
        for name, columns in zip(WORDS.findall(names), WORDS.findall(contents), strict=True)
    }
    assert described == {name: list(columns) for name, (_, _, columns) in TABLES.items()}
