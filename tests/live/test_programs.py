"""Programs of other people as processes: the same bytes as in one, and fenced when they fail."""

from pathlib import Path
from typing import Any

import pytest

from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile
from tests.live.mission import Mission, proven
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
    mission = Mission(tmp_path, *with_robot_3("hangs", "clock.silence_s=2"))
    summary, said = mission.finish_and_say()
    log = LogFile(tmp_path / "out" / "mission.mcap")
    why = lost(summary)[3]
    place = "in tests.onehop.programs.samples:"
    assert why.startswith(f"its program failed: no answer for 1.6 s, {place}")
    assert why.endswith(" fail")
    assert "time.sleep(0.01)" in said
    assert summary["ticks"] == 60
    assert replay(log, robots=(1, 2, 4)).same
    gone = next(one for one in summary["lost"] if one["robot"] == 3)
    assert gone["at_s"] == pytest.approx(0.05 * (FAILS_AT + 1))
