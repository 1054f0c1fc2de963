"""Every fault is shown to people by what it was: in tables, text, figures and viewers."""

from pathlib import Path

import pytest
from mcap.reader import make_reader

from onehop.analysis.explanation import explain
from onehop.analysis.log import Log, open_log
from onehop.analysis.report.narrative import narrative
from onehop.analysis.report.report_data import gather
from onehop.analysis.timeline import begun_faults
from onehop.analysis.trajectory import draw_trajectory
from onehop.analysis.view.layer import write_view
from onehop.wire.log_reader import LogFile
from tests.onehop.scenes import field, log_of

FAULTS = (
    "{kind='stop', at_s=1, robots=[1], duration_s=1}, {kind='blind', at_s=1, robots=[2], duration_s=1},"
    " {kind='slow', at_s=1, robots=[3], delay_ticks=2, duration_s=1},"
    " {kind='corrupt', at_s=1, robots=[4], probability=0.5, duration_s=1},"
    " {kind='cut', at_s=1, robots=[4], others=[2], direction='from', duration_s=1},"
    " {kind='jam', at_s=1, x=8, y=8, radius=3, duration_s=1},"
    " {kind='kidnap', at_s=3, robots=[3], x=30, y=30}"
)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("faults")
    log_of(field(folder, f"faults=[{FAULTS}]", "clock.limit_s=4"), folder / "mission.mcap")
    return folder / "mission.mcap"


@pytest.fixture(scope="module")
def log(path: Path) -> Log:
    return open_log(path)


def test_the_table_has_the_faults_as_the_scenario_has_them(log: Log) -> None:
    assert begun_faults(log.table("faults")) == list(log.scenario.faults)


def test_what_lasted_has_its_span(log: Log) -> None:
    found = {span.what: (round(span.start_s, 9), round(span.end_s, 9)) for span in gather(log).faults}
    assert set(found) == {
        "stop 1", "blind 2", "slow 3", "corrupt 4", "cut 4 one way to 2", "jam at (8, 8) m, 3 m wide",
    }  # fmt: skip
    assert set(found.values()) == {(1.0, 1.95)}


@pytest.mark.parametrize(
    ("robot", "said"),
    [
        (1, ("its process is stopped: it computes nothing, and what it is sent waits",)),
        (2, ("it is blind: its laser sees nothing", "cut off from 4: it hears nothing of them")),
        (3, ("it is slow: what it does takes effect 2 ticks late",)),
        (4, ("50 % of the messages to it are corrupted", "cut off from 2: they hear nothing of it")),
    ],
)
def test_a_robot_is_explained_by_what_it_suffers(log: Log, robot: int, said: tuple[str, ...]) -> None:
    suffered = [words for words in explain(log, robot, 1.5).faults if not words.startswith("jammed")]
    assert suffered == list(said)


def test_the_narrative_tells_each_fault_with_the_line_that_repeats_it(log: Log) -> None:
    told = [event.text for event in narrative(gather(log)) if event.text.startswith("Fault: ")]
    assert len(told) == len(log.scenario.faults)
    assert (
        'Fault: kidnap 3 to (30, 30). In a scenario: faults = [{kind = "kidnap", at_s = 3.0, '
        "robots = [3], x = 30.0, y = 30.0}]"
    ) in told


def test_figure_and_viewers_take_every_fault(path: Path, tmp_path: Path) -> None:
    draw_trajectory(LogFile(path), tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 10_000
    write_view(open_log(path), tmp_path / "view.mcap")
    with (tmp_path / "view.mcap").open("rb") as stream:
        events = [
            message.data for _, _, message in make_reader(stream).iter_messages(topics=["/events"])
        ]
    assert sum(b"world: fault: " in data for data in events) == len(FAULTS.split("kind=")) - 1
