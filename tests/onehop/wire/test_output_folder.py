"""A mission's folder is tried before the work, and belongs to one mission at a time."""

import subprocess
import sys
from pathlib import Path

import pytest

from onehop.contracts.errors import InputError
from onehop.wire.output_folder import FIGURE, LOG, SUMMARY, claimed, require_writable
from onehop.wire.summary import read_summary, write_summary


def test_a_folder_is_made_and_nothing_is_left_in_it(tmp_path: Path) -> None:
    with claimed(tmp_path / "a" / "b"):
        pass
    assert list((tmp_path / "a" / "b").iterdir()) == []


def test_a_folder_belongs_to_one_mission_at_a_time(tmp_path: Path) -> None:
    with (
        claimed(tmp_path),
        pytest.raises(InputError, match="another mission or campaign is writing there"),
    ):
        claimed(tmp_path).__enter__()
    with claimed(tmp_path):
        pass


def test_a_child_that_has_inherited_the_claim_holds_it(tmp_path: Path) -> None:
    with claimed(tmp_path) as claim:
        child = subprocess.Popen(
            [sys.executable, "-c", "input()"], stdin=subprocess.PIPE, pass_fds=(claim,)
        )
    with pytest.raises(InputError, match="another mission"):
        claimed(tmp_path).__enter__()
    child.communicate(b"\n")
    with claimed(tmp_path):
        pass


def test_of_an_earlier_mission_only_the_log_stays(tmp_path: Path) -> None:
    for name in (LOG, SUMMARY, FIGURE):
        (tmp_path / name).write_text("earlier")
    with claimed(tmp_path):
        assert [path.name for path in tmp_path.iterdir()] == [LOG]


@pytest.mark.parametrize("name", [LOG, SUMMARY])
def test_a_folder_in_the_place_of_a_result_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).mkdir()
    with pytest.raises(InputError, match=name if name == LOG else str(tmp_path)):
        claimed(tmp_path).__enter__()


def test_trying_a_file_leaves_it_as_it_is(tmp_path: Path) -> None:
    require_writable(tmp_path / "new.png")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "old.png").write_text("picture")
    require_writable(tmp_path / "old.png")
    assert (tmp_path / "old.png").read_text() == "picture"


def test_a_summary_comes_back_as_it_was_written(tmp_path: Path) -> None:
    assert read_summary(tmp_path) is None
    write_summary(tmp_path, {"outcome": "arrived"})
    assert read_summary(tmp_path) == {"outcome": "arrived"}
    assert [path.name for path in tmp_path.iterdir()] == [SUMMARY]


def test_a_summary_that_cannot_be_written_names_its_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone/summary.json: No such file or directory"):
        write_summary(tmp_path / "gone", {})
