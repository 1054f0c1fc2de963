"""One small mission for all tests of the analysis: four robots, the leader killed, another one held."""

from pathlib import Path

import pytest

from onehop.analysis import Log, open_log
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    ClockSection,
    GoalSection,
    MapSection,
    StartSection,
    TeamSection,
)
from onehop.drivers.inline import run
from onehop.scenario.bundle import Bundle
from onehop.wire.journal import Journal
from onehop.wire.log_writer import LogWriter
from onehop.wire.summary import summarize

LEADER, SUCCESSOR, HELD = 2, 3, 1
"""Of robots 1..4 the thesis makes 2 the leader; without it, of 1, 3, 4, it is 3 (Algorithm 1)."""

KILLED_S, HELD_S, HOLD_S = 4.0, 2.0, 1.5


def scenario() -> Scenario:
    return Scenario(
        name="small",
        goal=GoalSection(19.0, 10.0),
        map=MapSection(width=30.0, height=20.0, obstacles=(((14.0, 16.0), (17.0, 16.0), (17.0, 19.0)),)),
        start=StartSection(
            poses=((4.0, 7.0, 0.0), (7.0, 10.0, 0.0), (4.0, 13.0, 0.0), (1.5, 10.0, 0.0))
        ),
        team=TeamSection(size=4, next_period=0.5, leader_timeout=1.2),
        clock=ClockSection(limit_s=30.0),
        faults=(
            FaultSection("hold", HELD_S, robots=(HELD,), duration_s=HOLD_S),
            FaultSection("kill", KILLED_S, robots=(LEADER,)),
        ),
    )


@pytest.fixture(scope="session")
def log_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of the small mission; nobody may write to it."""
    path = tmp_path_factory.mktemp("log") / "mission.mcap"
    write_log(path, scenario())
    return path


def write_log(path: Path, mission: Scenario) -> None:
    """Run a mission in one process, and flush its log once a second."""
    bundle = Bundle(mission, {})
    writer = LogWriter(path, bundle, "inline")

    def write(tick: int, messages: list[tuple[str, bytes]]) -> None:
        writer.write(tick, messages)
        if tick % 20 == 0:
            writer.flush()

    journal = Journal(write)
    outcome = run(bundle, journal)
    writer.close(summarize(outcome, 1.0, journal.digest(), str(path)))


@pytest.fixture(scope="session")
def log(log_path: Path) -> Log:
    return open_log(log_path)
