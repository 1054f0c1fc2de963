"""kill -9 of the recorder at random instants: at most five ticks are lost, and none in the middle."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest

from onehop.analysis import open_log
from onehop.analysis.salvage import salvage
from onehop.wire.log_reader import LogFile
from tests.live.mission import CREEPING, Mission, proven

pytestmark = [pytest.mark.live, pytest.mark.slow]

KILLS = int(os.environ.get("ONEHOP_RECORDER_KILLS", "2"))
"""How many instants are tried; 40 take some minutes."""

ALLOWED_LOSS = 5


@pytest.mark.parametrize("number", range(KILLS))
def test_a_killed_recorder_loses_five_ticks_at_most(number: int, tmp_path: Path) -> None:
    draw = np.random.default_rng(number)
    mission = Mission(tmp_path, *CREEPING)
    mission.await_ticks(int(draw.integers(20_000, 400_000)))
    os.kill(mission.children()["onehop.recorder"], signal.SIGKILL)
    summary = mission.finish()
    torn, saved = mission.out / "mission.mcap", tmp_path / "saved.mcap"
    saved_ticks = salvage(torn, saved)
    log = open_log(saved)
    assert not log.torn
    ticks = [tick.tick for tick in LogFile(saved).ticks()]
    assert ticks == list(range(saved_ticks.last_tick + 1))
    assert summary["ticks"] - len(ticks) <= ALLOWED_LOSS
    proven(saved)
    print(f"killed after {summary['ticks']} ticks: {summary['ticks'] - len(ticks)} lost")
