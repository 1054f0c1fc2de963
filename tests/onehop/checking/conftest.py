"""Two good logs of four robots, for forgers: a quiet one, and one in which much goes wrong."""

from collections.abc import Callable
from pathlib import Path

import pytest

from onehop.checking import Report, judge
from tests.onehop.forgery import Forgery
from tests.onehop.scenes import field, log_of

QUICK = ("team.next_period=0.5", "team.leader_timeout=1.2", "clock.limit_s=6")
"""Next every half second: B is 2 s, 40 ticks."""

LEADER, SUCCESSOR = 2, 3
"""Of 1, 2, 3, 4; and of 1, 3, 4 (thesis, Algorithm 1)."""

KILLED, RETURNED = 60, 140
"""Ticks at which the troubled mission's leader is killed, and comes back."""

TROUBLES = (
    "faults=[{kind='kill', at_s=3, robots=[2]}, {kind='restart', at_s=7, robots=[2]},"
    " {kind='hold', at_s=8.5, robots=[4], duration_s=0.5},"
    " {kind='cut', at_s=9, robots=[1], duration_s=3},"
    " {kind='jam', at_s=13, x=38, y=38, radius=1, duration_s=1}]"
)

Break = Callable[[Forgery], object]


@pytest.fixture(scope="session")
def quiet_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """120 ticks; nobody may write to it."""
    folder = tmp_path_factory.mktemp("quiet")
    log_of(field(folder, *QUICK), folder / "mission.mcap")
    return folder / "mission.mcap"


@pytest.fixture(scope="session")
def troubled_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """280 ticks; nobody may write to it."""
    folder = tmp_path_factory.mktemp("troubled")
    log_of(field(folder, *QUICK[:2], "clock.limit_s=14", "seed=5", TROUBLES), folder / "mission.mcap")
    return folder / "mission.mcap"


@pytest.fixture
def broken(quiet_log: Path, troubled_log: Path, tmp_path: Path) -> Callable[..., Report]:
    """What is found in a log that was altered."""

    def call(alter: Break, log: str = "quiet", *, hides_traces: bool = True) -> Report:
        forgery = Forgery(quiet_log if log == "quiet" else troubled_log)
        alter(forgery)
        forgery.hides_traces = hides_traces
        return judge(forgery.write(tmp_path / "forged.mcap"))

    return call
