"""How `onehop fault` finds the mission that it is meant for."""

import os
import stat
from pathlib import Path

import pytest

from onehop.contracts.errors import InputError
from onehop.mission.rendezvous import FILE, Rendezvous, published, running, the_one_that_runs, way_into


@pytest.fixture(autouse=True)
def _own_list(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "runtime"))


def way_in(mission: str = "onehop-1", pid: int | None = None) -> Rendezvous:
    return Rendezvous(mission, "tcp/127.0.0.1:7447", "secret", os.getpid() if pid is None else pid)


def folder(tmp_path: Path, name: str) -> Path:
    made = tmp_path / name
    made.mkdir()
    return made


def test_a_mission_is_found_while_it_runs_and_leaves_nothing(tmp_path: Path) -> None:
    out = folder(tmp_path, "out")
    with published(out, way_in()):
        assert running() == [out]
        assert the_one_that_runs() == out
        assert way_into(out) == way_in()
    assert running() == list(out.iterdir()) == []


def test_only_its_owner_can_read_the_way_in_whatever_lay_there(tmp_path: Path) -> None:
    out = folder(tmp_path, "out")
    (out / FILE).write_text("")
    (out / FILE).chmod(0o666)
    with published(out, way_in()):
        assert stat.S_IMODE((out / FILE).stat().st_mode) == 0o600
        listed = [file.read_text() for file in (tmp_path / "runtime").rglob("*") if file.is_file()]
    assert listed == [str(out)]


def test_without_a_mission_the_answer_says_so_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^fault: no mission runs; start one with onehop run") as none:
        the_one_that_runs()
    assert "\n" not in str(none.value)
    with pytest.raises(InputError, match=r"--mission .*: no mission runs there; "):
        way_into(tmp_path)


def test_with_several_missions_the_answer_asks_which_one(tmp_path: Path) -> None:
    a, b = folder(tmp_path, "a"), folder(tmp_path, "b")
    with published(a, way_in("onehop-1")), published(b, way_in("onehop-2")):
        with pytest.raises(InputError) as several:
            the_one_that_runs()
        assert str(several.value) == f"fault: 2 missions run; which one? --mission of {a}, {b}"


@pytest.mark.parametrize("left", ["dead launcher", "garbage", "no file", "another mission"])
def test_what_a_killed_launcher_has_left_is_no_mission(tmp_path: Path, left: str) -> None:
    out = folder(tmp_path, "out")
    with published(out, way_in(pid=2**22 + 1 if left == "dead launcher" else None)):
        if left == "garbage":
            (out / FILE).write_text("[1, 2]")
        elif left == "no file":
            (out / FILE).unlink()
        elif left == "another mission":
            entry = next((tmp_path / "runtime").rglob("onehop-1.*"))
            entry.rename(entry.with_name("onehop-2"))
        assert running() == []
        assert not [file for file in (tmp_path / "runtime").rglob("*") if file.is_file()]


def test_without_a_list_a_mission_is_found_by_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "file"))
    out = folder(tmp_path, "out")
    with published(out, way_in()):
        assert running() == []
        assert way_into(out) == way_in()
