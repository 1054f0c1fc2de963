"""Small missions that several tests run."""

from pathlib import Path

from onehop.drivers import inline
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.wire.journal import Journal, WireMessage
from onehop.wire.log_writer import LogWriter
from onehop.wire.summary import summarize

FIELD = """
name = "field"
seed = 3
[map]
width = 40
height = 40
obstacles = [[[18, 24], [24, 24], [24, 30], [18, 30]]]
[start]
x = 8
y = 8
[goal]
x = 30
y = 14
[team]
size = 4
"""


def field(folder: Path, *settings: str) -> Bundle:
    """Four robots, one block, 23 m to go."""
    path = folder / "field.toml"
    path.write_text(FIELD)
    return scenario_file.load(path, settings)


def log_of(bundle: Bundle, path: Path) -> str:
    """Run a mission in one process, write its log, return its digest."""
    log = LogWriter(path, bundle, "inline")

    def write(tick: int, messages: list[WireMessage]) -> None:
        log.write(tick, messages)

    journal = Journal(write)
    outcome = inline.run(bundle, journal)
    log.close(summarize(outcome, 1.0, journal.digest(), str(path)))
    return journal.digest()
