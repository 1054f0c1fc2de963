"""The examples of docs/reading-logs.md run, and its table of columns is true."""

import re
from pathlib import Path

import pytest

from onehop.analysis.columns import markdown

PAGE = Path(__file__).parents[3] / "docs" / "reading-logs.md"


def test_the_worked_example_runs(log_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(), flags=re.DOTALL)
    exec(compile(example, str(PAGE), "exec"), {"path": log_path})
    printed = capsys.readouterr().out
    assert "small (1, 2, 3, 4) arrived" in printed
    assert "poses between 2 and 3 s" in printed


def test_the_tables_stand_in_the_page_as_they_are_declared() -> None:
    """After a change: print(onehop.analysis.columns.markdown()) is what belongs there."""
    assert markdown() in PAGE.read_text()
