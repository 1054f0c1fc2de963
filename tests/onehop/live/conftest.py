"""The small mission of the analysis, whole and as it grows."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from onehop.wire.log_reader import LogFile, LoggedTick
from onehop.wire.log_writer import LogWriter
from tests.onehop.analysis.conftest import scenario, write_log


@pytest.fixture(scope="session")
def log_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four robots, the leader killed, another one held; nobody may write to it."""
    path = tmp_path_factory.mktemp("log") / "mission.mcap"
    write_log(path, scenario())
    return path


@pytest.fixture(scope="session")
def ticks(log_path: Path) -> list[LoggedTick]:
    return list(LogFile(log_path).ticks())


class Growing:
    """A log that is written as the recorder writes it: a few ticks at a time."""

    def __init__(self, path: Path, like: Path, ticks: list[LoggedTick]) -> None:
        self.path = path
        self._ticks = ticks
        self._next = 0
        self._like = like
        self._is_open = True
        self._writer = LogWriter(path, LogFile(like).bundle, "test")

    def write(self, number: int) -> None:
        """So many more ticks, then a flush."""
        for one in self._ticks[self._next : self._next + number]:
            self._writer.write(one.tick, one.messages)
        self._next += number
        self._writer.flush()

    def close(self) -> None:
        """With the outcome of the whole log."""
        if self._is_open:
            self._writer.close(LogFile(self._like).summary)
        self._is_open = False


@pytest.fixture
def growing(tmp_path: Path, log_path: Path, ticks: list[LoggedTick]) -> Iterator[Growing]:
    log = Growing(tmp_path / "mission.mcap", log_path, ticks)
    yield log
    log.close()
