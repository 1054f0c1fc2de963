"""Who led when, from the tables: the same as the referee's, and the one line of who led most."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from onehop.analysis import Log, open_log
from onehop.analysis.tables import Table
from onehop.analysis.timeline import leadership
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import LeadershipTerm
from onehop.contracts.sections import GoalSection

from .conftest import KILLED_S, LEADER, SUCCESSOR, scenario, write_log

Rows = list[tuple[int, int, int, tuple[int, ...], str]]
"""Tick, robot, leader that it obeys, members, shape; epoch 0."""

PERIOD_NS = 50_000_000


def status(rows: Rows) -> Table:
    tick, robot, leader, members, shape = zip(*rows, strict=True)
    packed = np.empty(len(rows), dtype=object)
    packed[:] = members
    return Table(
        tick=np.array(tick),
        robot=np.array(robot),
        leader=np.array(leader),
        epoch=np.zeros(len(rows), dtype=np.int64),
        members=packed,
        shape=np.array(shape),
    )


def departures(*gone: tuple[int, int]) -> Table:
    return Table(
        tick=np.array([tick for tick, _ in gone], dtype=np.int64),
        robot=np.array([robot for _, robot in gone], dtype=np.int64),
    )


def terms(rows: Rows, *gone: tuple[int, int]) -> list[tuple[float, int, str]]:
    found = leadership(status(rows), departures(*gone), PERIOD_NS).terms
    return [(term.at_s, term.leader, term.shape) for term in found]


TEAM, PART = (1, 2, 3), (1, 3)


def test_a_change_of_shape_is_a_new_term_of_the_same_leader() -> None:
    rows: Rows = [(0, 2, 2, TEAM, "wedge"), (1, 2, 2, TEAM, "wedge"), (2, 2, 2, TEAM, "column")]
    assert terms(rows) == [(0.05, 2, "wedge"), (0.15, 2, "column")]


def test_a_leader_that_obeyed_another_begins_a_new_term() -> None:
    rows: Rows = [(0, 2, 2, TEAM, "wedge"), (1, 2, 3, TEAM, "wedge"), (2, 2, 2, TEAM, "wedge")]
    assert [at_s for at_s, _, _ in terms(rows)] == [0.05, 0.15]


def test_a_leader_that_was_restarted_begins_a_new_term() -> None:
    rows: Rows = [(tick, 2, 2, TEAM, "wedge") for tick in range(4)]
    assert [at_s for at_s, _, _ in terms(rows, (2, 2))] == [0.05, 0.15]


def test_the_last_status_of_a_robot_that_left_means_nothing() -> None:
    assert terms([(0, 2, 2, TEAM, "wedge")], (1, 2)) == []


def test_a_follower_has_no_term() -> None:
    assert terms([(0, 1, 2, TEAM, "wedge"), (1, 1, 2, TEAM, "wedge")]) == []


def test_of_two_leaders_the_one_of_the_larger_roster_counts() -> None:
    rows: Rows = [
        (0, 2, 2, TEAM, "wedge"),
        (1, 2, 2, (2,), "solo"),
        (1, 3, 3, PART, "column"),
        (2, 2, 2, TEAM, "wedge"),
    ]
    found = leadership(status(rows), departures(), PERIOD_NS).main
    assert [(term.at_s, term.leader) for term in found] == [(0.05, 2), (0.1, 3), (0.15, 2)]


def test_two_leaders_at_once_do_not_hide_that_the_first_leads_on() -> None:
    rows: Rows = [(0, 2, 2, TEAM, "wedge"), (1, 2, 2, TEAM, "wedge"), (1, 3, 3, (3,), "solo")]
    found = leadership(status(rows), departures(), PERIOD_NS).main
    assert [(term.at_s, term.leader) for term in found] == [(0.05, 2)]


def of_summary(log: Log) -> list[LeadershipTerm]:
    assert log.summary is not None
    return [
        LeadershipTerm(**{**one, "members": tuple(one["members"])}) for one in log.summary["leaders"]
    ]


def of_tables(log: Log) -> list[LeadershipTerm]:
    tables = log.tables("status", "departures")
    return leadership(tables["status"], tables["departures"], log.period_ns).terms


def test_the_log_gives_the_terms_that_the_referee_reported(log: Log) -> None:
    assert of_tables(log) == of_summary(log)
    assert {term.leader for term in of_tables(log)} == {LEADER, SUCCESSOR}


@pytest.fixture(scope="module")
def turbulent(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The leader dies and comes back, its successor is cut off, and one is restarted in one tick."""
    path = tmp_path_factory.mktemp("turbulent") / "mission.mcap"
    faults = (
        FaultSection("kill", KILLED_S, robots=(LEADER,)),
        FaultSection("restart", 8.0, robots=(LEADER,)),
        FaultSection("cut", 12.0, robots=(SUCCESSOR,), duration_s=3.0),
        FaultSection("restart", 14.0, robots=(SUCCESSOR,)),
        FaultSection("kill", 18.0, robots=(LEADER,)),
    )
    write_log(path, replace(scenario(), goal=GoalSection(27.0, 17.0), faults=faults))
    return path


def test_the_terms_are_the_referees_after_kills_restarts_cuts_and_elections(turbulent: Path) -> None:
    log = open_log(turbulent)
    found = of_tables(log)
    assert found == of_summary(log)
    assert len(found) > 6
    assert {term.leader for term in found} == {LEADER, SUCCESSOR}


def test_a_torn_log_gives_the_terms_up_to_the_tear(turbulent: Path, tmp_path: Path) -> None:
    path = tmp_path / "torn.mcap"
    path.write_bytes(turbulent.read_bytes()[: turbulent.stat().st_size // 2])
    torn, whole = open_log(path), of_tables(open_log(turbulent))
    found = of_tables(torn)
    assert torn.summary is None
    assert 1 < len(found) < len(whole)
    assert found == whole[: len(found)]
