"""A log as the page shows it: the same while it grows as when it is done, and what is wrong with it."""

import json
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from onehop.analysis.growing_log import GrowingLog
from onehop.analysis.log import open_log
from onehop.analysis.report.narrative import narrative
from onehop.analysis.report.report_data import gather
from onehop.contracts.errors import LogError
from onehop.contracts.fault_section import FaultSection
from onehop.live.frame import LOST_TICKS
from onehop.live.source import Source
from tests.onehop.analysis.conftest import (
    HELD,
    HELD_S,
    KILLED_S,
    LEADER,
    SUCCESSOR,
    scenario,
    write_log,
)
from tests.onehop.live.conftest import Growing

PATIENCE_S = 30.0


class Watched:
    """A source that is read by its own thread; `wait` until it has read to a tick."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self._stirred = threading.Condition()
        source.start(self._changed)

    def _changed(self) -> None:
        with self._stirred:
            self._stirred.notify_all()

    def wait(self, tick: int) -> None:
        self.wait_until(lambda: self.source.last_tick >= tick)

    def wait_until(self, done: Callable[[], bool]) -> None:
        with self._stirred:
            assert self._stirred.wait_for(done, PATIENCE_S)


@pytest.fixture
def read(log_path: Path) -> Iterator[Source]:
    yield from whole(log_path)


def whole(path: Path) -> Iterator[Source]:
    """A source that has read all of its log."""
    source = Source(path)
    source.open()
    Watched(source).wait(round(gather(open_log(path)).end_s / 0.05))
    yield source
    source.close()


def test_events_are_the_words_of_the_report(read: Source, log_path: Path) -> None:
    story = read.story
    assert story is not None
    assert read.state()["outcome"] == "arrived"
    assert story.events() == narrative(gather(open_log(log_path)))
    told = [(event.text, event.robot) for event in story.events()]
    assert any("without a vote" in text and robot == SUCCESSOR for text, robot in told)


def test_a_log_that_grows_shows_every_moment_as_the_whole_log_does(
    growing: Growing, read: Source, request: pytest.FixtureRequest
) -> None:
    source = Source(growing.path, is_ours=True)
    request.addfinalizer(source.close)
    watched = Watched(source)
    growing.write(30)
    watched.wait(29)
    assert source.state()["state"] == "running"
    for _ in range(3):
        growing.write(50)
    watched.wait(179)
    wanted = [(1, 0, 0), (50, 49, HELD), (100, 20, SUCCESSOR), (179, 178, 0), (60, 100, 1)]
    early = [source.frame(*one) for one in wanted]
    assert all(early)
    growing.write(10_000)
    growing.close()
    watched.wait(read.last_tick)
    watched.wait_until(lambda: source.state()["state"] == "ended")
    assert [source.frame(*one) for one in wanted] == early == [read.frame(*one) for one in wanted]
    assert source.story is not None
    assert read.story is not None
    assert source.story.samples == read.story.samples
    assert source.state() == read.state()


def test_a_frame_says_who_is_where_who_leads_and_who_is_gone(read: Source) -> None:
    held = read.frame(int((HELD_S + 0.5) / 0.05), 0, 0)
    assert held is not None
    assert {one["id"]: one["state"] for one in held["robots"]} == {1: ["held"], 2: [], 3: [], 4: []}
    assert {tuple(route) for route in held["routes"]} == {(2, 1), (2, 3), (2, 4)}
    assert [slot[:2] for slot in held["slots"]] == [[1, 2], [3, 2], [4, 2]]
    assert any("is held" in sentence for sentence in held["now"])
    later = read.frame(int((KILLED_S + 3.0) / 0.05), 0, SUCCESSOR)
    assert later is not None
    assert [(one["id"], one["why"]) for one in later["gone"]] == [(LEADER, "killed by a fault")]
    assert later["now"][0].startswith("Robot 3 leads robots 1 4 in a wedge")
    assert len(later["scan"]["ranges"]) == 181
    json.dumps(later, allow_nan=False)


@pytest.fixture
def parted(tmp_path: Path) -> Iterator[Source]:
    """Robot 4 is cut off from the others for three seconds."""
    cut = FaultSection("cut", 2.0, robots=(4,), duration_s=3.0)
    write_log(tmp_path / "parted.mcap", replace(scenario(), faults=(cut,)))
    yield from whole(tmp_path / "parted.mcap")


def test_lost_messages_are_those_since_the_frame_before_but_none_of_long_ago(parted: Source) -> None:
    lost = [
        record.tick
        for _, record in open_log(parted.path).radio_records()
        for verdict in record.verdicts
        if verdict.status != "delivered"
    ]
    assert len([one for one in lost if 40 <= one <= 110]) > 5
    tick = 95
    for since in (tick - 1, tick - 10, 0):
        shown = parted.frame(tick, since, 0)
        assert shown is not None
        first = max(since, tick - LOST_TICKS - 1)
        assert len(shown["lost"]) == len([one for one in lost if first < one <= tick])
        assert shown["cuts"] == [[[4], [1, 2, 3], False]]
    assert all(4 in one[:2] for one in shown["lost"])
    for tick in {one for one in lost if 40 <= one <= 90}:
        after = parted.frame(tick + 1, tick, 0)
        assert after is not None
        assert len(after["lost"]) == lost.count(tick + 1)


def test_a_torn_log_says_so_and_shows_what_there_is(
    tmp_path: Path, log_path: Path, request: pytest.FixtureRequest
) -> None:
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(log_path.read_bytes()[: log_path.stat().st_size // 2])
    source = Source(torn)
    source.open()
    request.addfinalizer(source.close)
    Watched(source).wait(60)
    assert source.state()["state"] == "torn"
    assert "its recorder was killed" in source.state()["words"]
    assert source.frame(50, 0, 0) is not None
    assert source.frame(source.last_tick + 1, 0, 0) is None


def test_what_is_no_log_is_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "mission.mcap"
    path.write_text("nothing")
    with pytest.raises(LogError, match="not an MCAP file"):
        Source(path).open()


def test_a_file_of_an_earlier_mission_is_not_taken_for_this_one(growing: Growing) -> None:
    growing.write(3)
    older_ns = growing.path.stat().st_mtime_ns
    log = GrowingLog(growing.path, older_ns)
    assert not log.grow()
    assert log.last_tick == -1
    growing.write(3)
    assert log.grow()
    assert log.last_tick == 5


def test_a_log_that_is_replaced_meanwhile_is_read_on(growing: Growing, log_path: Path) -> None:
    """As the viewer layer is put into it after the mission."""
    growing.write(30)
    log = GrowingLog(growing.path)
    assert log.grow()
    assert log.log is not None
    copy = growing.path.with_name("copy.mcap")
    copy.write_bytes(log_path.read_bytes())
    copy.replace(growing.path)
    assert log.grow()
    assert not log.log.torn


def test_an_explanation_is_that_of_the_command_and_a_refusal_is_its_line(read: Source) -> None:
    lines = read.explain(SUCCESSOR, KILLED_S + 3.0)
    assert lines[0].startswith(f"Robot {SUCCESSOR} at 7.00 s")
    assert read.explain(9, 1.0) == ["--robot 9: is not in the team; one of 1, 2, 3, 4"]
