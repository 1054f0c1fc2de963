"""Programs of other people as processes: the same bytes as in one, and fenced when they fail."""

import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile
from tests.live.mission import DEADLINE_S, Mission, proven
from tests.onehop.programs.samples import FAILS_AT
from tests.onehop.scenes import field, log_of

pytestmark = pytest.mark.live

PROGRAM = "team.program='tests.onehop.programs.samples:Seeker'"


def with_robot_3(how: str, *settings: str) -> list[str]:
    entry = f"robots=[{{id=3, parameters={{how='{how}'}}}}]"
    return [PROGRAM, entry, "clock.limit_s=3", *settings]


def lost(summary: dict[str, Any]) -> dict[int, str]:
    return {one["robot"]: one["why"] for one in summary["lost"]}


@pytest.mark.parametrize("how", ["raises", "returns nothing", "says text", "exits", "recurses"])
def test_a_program_that_fails_is_fenced_as_in_one_process(how: str, tmp_path: Path) -> None:
    settings = with_robot_3(how)
    summary, said = Mission(tmp_path, *settings).finish_and_say()
    log = proven(tmp_path / "out" / "mission.mcap")
    assert summary["digest"] == log_of(field(tmp_path, *settings), tmp_path / "inline.mcap")
    inline = LogFile(tmp_path / "inline.mcap").summary
    assert inline is not None
    assert lost(summary) == lost(inline)
    assert summary["ticks"] == 60
    assert log.bundle.folder == str(tmp_path)
    if how == "raises":
        block = said[said.index("the program of robot-3 failed:") :].splitlines()
        assert block[1] == "Traceback (most recent call last):"
        assert "samples.py" in block[2]
        assert "LookupError: no map" in block
        assert "host.py" not in said


def test_a_program_that_hangs_is_fenced_and_says_where(tmp_path: Path) -> None:
    mission = Mission(tmp_path, *with_robot_3("hangs", "clock.silence_s=5"))
    summary, said = mission.finish_and_say()
    log = LogFile(tmp_path / "out" / "mission.mcap")
    why = lost(summary)[3]
    place = "in tests.onehop.programs.samples:"
    assert why.startswith(f"its program failed: no answer for 4 s, {place}")
    assert why.endswith(" fail")
    assert "time.sleep(0.01)" in said
    assert summary["ticks"] == 60
    assert replay(log, robots=(1, 2, 4)).same
    gone = next(one for one in summary["lost"] if one["robot"] == 3)
    assert gone["at_s"] == pytest.approx(0.05 * (FAILS_AT + 1))


def test_a_new_project_passes_its_own_test_and_can_be_disturbed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "runtime"))
    project, out = tmp_path / "my_robots", tmp_path / "out"
    assert onehop("new", str(project)).returncode == 0
    tested = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=project, capture_output=True, text=True, check=False, timeout=DEADLINE_S,
    )  # fmt: skip
    assert tested.returncode == 0, tested.stdout
    creeping = ("--set", "team.parameters.speed=0.01", "--set", "clock.limit_s=600")
    quick = ("--no-view", "--no-figure")
    words = ("run", str(project / "mission.toml"), *creeping, *quick, "--out", str(out))
    running = subprocess.Popen(
        [sys.executable, "-m", "onehop", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        deadline = time.monotonic() + DEADLINE_S
        while not (out / "running.json").exists():
            assert time.monotonic() < deadline
            time.sleep(0.05)
        answer = onehop("fault", "kill", "3", "--mission", str(out))
        assert answer.returncode == 0, answer.stderr
    finally:
        running.send_signal(signal.SIGINT)
        running.wait(DEADLINE_S)
    log = proven(out / "mission.mcap")
    assert log.summary is not None
    assert lost(log.summary)[3] == "killed by a fault"


def onehop(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "onehop", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)
