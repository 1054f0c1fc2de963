"""The examples of docs/reading-logs.md run, its tables are true, and a walk names what there is."""

import re
from pathlib import Path

import pytest

from onehop.analysis import derived
from onehop.analysis.columns import TABLES, markdown

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "reading-logs.md"


def test_the_worked_example_runs(log_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(), flags=re.DOTALL)
    exec(compile(example, str(PAGE), "exec"), {"path": log_path})
    printed = capsys.readouterr().out
    assert "small (1, 2, 3, 4) arrived" in printed
    assert "poses between 2 and 3 s" in printed


def test_the_tables_stand_in_the_page_as_they_are_declared() -> None:
    """After a change: print(onehop.analysis.columns.markdown()) is what belongs there."""
    page = PAGE.read_text()
    assert markdown() in page
    assert derived.markdown() in page


@pytest.mark.parametrize("page", ["follow-a-next.md", "follow-a-scan.md"])
def test_a_walk_through_the_house_names_functions_and_columns_that_exist(page: str) -> None:
    """Every name in backticks is a class, a function, a field, a table or one of its columns."""
    walk = (ROOT / "docs" / page).read_text()
    named = {name.split(".")[-1] for name in re.findall(r"`([A-Za-z_.]*[a-z_])`", walk)}
    sources = "\n".join(
        path.read_text()
        for folder in ("onehop", "robot_agent", "world_server", "radio_proxy")
        for path in sorted((ROOT / folder).rglob("*.py"))
    )
    known = set(re.findall(r"(?:class|def) (\w+)|^    (\w+):", sources, flags=re.MULTILINE))
    names = {name for pair in known for name in pair} | set(TABLES) | {"core", "Next", "lost_follower"}
    names |= {column.name for table in TABLES.values() for column in table.columns}
    assert named <= names
