"""Results as JSON lines: gone on with, never lost, never mixed."""

from pathlib import Path

import pytest

from onehop.campaign.lines import Lines
from onehop.contracts.errors import InputError


def test_results_are_there_when_a_file_is_opened_again(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    with Lines(path, {"about": 1}) as lines:
        lines.add({"name": "a"})
    with Lines(path, {"about": 1}) as lines:
        assert lines.rows == [{"name": "a"}]
        lines.add({"name": "b"})
    with Lines(path, {"about": 1}) as lines:
        assert [row["name"] for row in lines.rows] == ["a", "b"]


@pytest.mark.parametrize("cut", range(1, 14))
def test_a_line_that_was_half_written_is_dropped(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "rows.jsonl"
    with Lines(path, {"about": 1}) as lines:
        lines.add({"name": "a"})
        lines.add({"name": "b"})
    path.write_bytes(path.read_bytes()[:-cut])
    with Lines(path, {"about": 1}) as lines:
        assert lines.rows == [{"name": "a"}]
        lines.add({"name": "c"})
    with Lines(path, {"about": 1}) as lines:
        assert [row["name"] for row in lines.rows] == ["a", "c"]


def test_a_file_about_something_else_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"
    with Lines(path, {"about": 1, "kept": 2}) as lines:
        lines.add({"name": "a"})
    before = path.read_bytes()
    with pytest.raises(InputError, match=r"something else \(about differ\)"):
        Lines(path, {"about": 3, "kept": 2})
    assert path.read_bytes() == before


@pytest.mark.parametrize("text", ["{}\nnot JSON\n", "{}\n[1]\n", "\xff\n"])
def test_what_holds_no_results_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rows.jsonl"
    path.write_text(text, encoding="latin-1")
    with pytest.raises(InputError, match=r"line .* is no result"):
        Lines(path, {})
