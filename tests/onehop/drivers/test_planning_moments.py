"""What a leader planned, from the log alone: as in the mission, in whatever order it is asked for."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from onehop.contracts import topics
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Observation
from onehop.contracts.scenario import Scenario
from onehop.drivers.planning_moments import PlanningMoments
from onehop.live.road_maps import RoadMaps
from onehop.live.source import Source
from onehop.scenario.bundle import Bundle
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LogWriter
from robot_agent.core.planning import frontier_planner
from robot_agent.core.planning.snapshot import PlanningSnapshot
from tests.onehop.analysis.conftest import HELD, KILLED_S, LEADER, SUCCESSOR, scenario, write_log
from tests.onehop.scenes import field, log_of

KILLED = round(KILLED_S / 0.05)


@pytest.fixture(scope="module")
def planned() -> list[PlanningSnapshot]:
    """Every planning moment of the mission, as it was run."""
    return []


@pytest.fixture(scope="module")
def path(planned: list[PlanningSnapshot], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small mission, in which the leader is killed and another one leads."""
    path = tmp_path_factory.mktemp("log") / "mission.mcap"

    def kept(*values: object, **more: object) -> PlanningSnapshot:
        planned.append(PlanningSnapshot(*values, **more))  # type: ignore[arg-type]
        return planned[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(frontier_planner, "PlanningSnapshot", kept)
        write_log(path, scenario())
    return path


def pose_at(log: LogFile, robot: int, tick: int) -> Pose:
    key = topics.obs(robot)
    return next(decode(Observation, one.data).pose for one in log.wire.select(key.__eq__, tick, tick))


def all_of(log: LogFile, robot: int) -> list[tuple[int, PlanningSnapshot]]:
    moments = PlanningMoments(log.bundle.scenario, robot)
    last = log.summary["ticks"] - 1 if log.summary else 0
    found = {one[0]: one[1] for tick in range(last + 1) if (one := moments.last(log, tick)) is not None}
    return sorted(found.items())


def test_they_are_those_of_the_mission(path: Path, planned: list[PlanningSnapshot]) -> None:
    log = LogFile(path)
    found = [(*one, robot) for robot in (LEADER, SUCCESSOR) for one in all_of(log, robot)]
    assert [(one.pose, one.way.tolist(), one.roadmap.edges.tolist()) for _, one, _ in found] == [
        (one.pose, one.way.tolist(), one.roadmap.edges.tolist()) for one in planned
    ]
    for tick, one, robot in found:
        assert one.pose == pose_at(log, robot, tick)
    assert {robot for tick, _, robot in found if tick < KILLED} == {LEADER}
    assert {robot for tick, _, robot in found if tick >= KILLED} == {SUCCESSOR}
    assert all_of(log, HELD) == []


def test_they_are_the_same_in_whichever_order_somebody_looks(path: Path) -> None:
    log = LogFile(path)
    in_order = dict(all_of(log, SUCCESSOR))
    again = PlanningMoments(log.bundle.scenario, SUCCESSOR)
    for tick in (max(in_order) + 5, min(in_order) - 1, *in_order, 1, max(in_order)):
        found = again.last(log, tick)
        by_then = [one for one in in_order if one <= tick]
        assert (found and found[0]) == (by_then[-1] if by_then else None)
        if found:
            assert found[1].way.tolist() == in_order[found[0]].way.tolist()


def test_the_page_gets_them_in_centimetres_and_nothing_where_there_is_nothing(path: Path) -> None:
    source = Source(path)
    source.open()
    assert source.road_map(LEADER, KILLED) == {}, "nothing has been read yet"
    while source._read_on():
        pass
    shown = source.road_map(LEADER, KILLED)
    at, planned = all_of(LogFile(path), LEADER)[-1]
    assert shown["at"] == at
    assert len(shown["edges"]) == len(planned.roadmap.edges)
    assert shown["way"][-1] == [round(100 * one) for one in planned.way[-1].tolist()]
    assert source.road_map(HELD, KILLED) == {}
    assert source.road_map(99, KILLED) == {}


def test_what_drives_itself_has_no_road_map_of_ours(tmp_path: Path) -> None:
    seeker = "tests.onehop.programs.samples:Seeker"
    log_of(field(tmp_path, f"robots=[{{id=2, program='{seeker}'}}]", "clock.limit_s=1"), tmp_path / "a")
    source = Source(tmp_path / "a")
    source.open()
    assert source.log is not None
    assert RoadMaps().of(1, source.log, 2, 10) == {}
    assert RoadMaps().of(1, source.log, 1, 10) == {}


def copied(path: Path, mission: Scenario, out: Path, leave_out: int = -1) -> LogFile:
    """The ticks of a log but for one, as if they were those of this mission."""
    log = LogFile(path)
    writer = LogWriter(out, Bundle(mission, {}), "test")
    for tick in log.ticks():
        if tick.tick != leave_out:
            writer.write(tick.tick, tick.messages)
    writer.close(log.summary)
    return LogFile(out)


def test_from_a_missing_tick_on_nobody_knows_what_was_planned(path: Path, tmp_path: Path) -> None:
    tick, planned = all_of(LogFile(path), SUCCESSOR)[-1]
    log = copied(path, scenario(), tmp_path / "mission.mcap", leave_out=tick)
    moments = PlanningMoments(scenario(), SUCCESSOR)
    assert moments.last(log, tick + 1) is None
    before = moments.last(log, tick - 1)
    assert before is not None
    assert before[0] < tick
    assert before[1].way.tolist() != planned.way.tolist()
    assert moments.last(log, tick + 5) is None


@pytest.mark.parametrize("setting", ["planner.kind", "gains.policy"])
def test_nothing_that_a_log_names_is_imported_to_show_it(
    setting: str, path: Path, tmp_path: Path
) -> None:
    section, key = setting.split(".")
    mission = scenario()
    other = replace(mission, **{section: replace(getattr(mission, section), **{key: "antigravity:fly"})})
    copied(path, other, tmp_path / "mission.mcap")
    source = Source(tmp_path / "mission.mcap")
    source.open()
    while source._read_on():
        pass
    assert source.road_map(LEADER, KILLED) == {}
    assert "antigravity" not in sys.modules
