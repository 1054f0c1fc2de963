"""The worked examples do what their pages promise, and not without what they show."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from onehop.analysis import open_log
from onehop.analysis.log import Log
from onehop.checking import judge
from onehop.scenario import scenario_file
from tests.onehop.scenes import log_of

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module", autouse=True)
def measure() -> Iterator[Any]:
    """examples/measure.py."""
    sys.path.insert(0, str(EXAMPLES))
    import measure

    yield measure
    sys.path.remove(str(EXAMPLES))


def run(name: str, folder: Path, *settings: str) -> Log:
    """The log of an example, in which nobody touched anything and every promise held."""
    path = folder / "mission.mcap"
    log_of(scenario_file.load(EXAMPLES / f"{name}.toml", settings), path)
    log = open_log(path)
    assert log.summary is not None
    assert log.summary["collisions"] == 0
    assert judge(log.file).violations == ()
    return log


def arrived(log: Log) -> list[int]:
    assert log.summary is not None
    robots: list[int] = log.summary["arrived"]
    return robots


def test_a_flock_follows_the_two_who_know_the_way(measure: Any, tmp_path: Path) -> None:
    log = run("flocking", tmp_path)
    assert arrived(log) == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    assert measure.polarisation(log).mean() > 0.95
    assert measure.spread(log).max() < 5.0


def test_without_a_word_there_is_no_flock(measure: Any, tmp_path: Path) -> None:
    log = run("flocking", tmp_path, "radio.receive_threshold_db=100")
    assert arrived(log) == [1, 2]
    assert measure.spread(log)[-1] > 10.0


def test_a_relay_chain_keeps_a_rover_connected(measure: Any, tmp_path: Path) -> None:
    log = run("relay", tmp_path)
    assert 8 in arrived(log)
    assert measure.connected(log) > 0.99


def test_without_the_chain_the_rover_is_alone(measure: Any, tmp_path: Path) -> None:
    log = run("relay", tmp_path, "team.parameters.chain=false")
    assert 8 in arrived(log)
    assert measure.connected(log) < 0.7


def test_six_who_tell_where_they_were_cover_the_ground(measure: Any, tmp_path: Path) -> None:
    share = measure.covered(run("mapless", tmp_path))
    assert share[-1] > 0.98
    assert share[135 * 20] > 0.95


def test_each_for_itself_covers_less(measure: Any, tmp_path: Path) -> None:
    share = measure.covered(run("mapless", tmp_path, "team.parameters.talks=false"))
    assert share[-1] < 0.96
    assert share[135 * 20] < 0.91
