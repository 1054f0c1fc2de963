"""Reading a log: every message, any stretch of time, sound or torn, as typed values and as columns."""

from pathlib import Path

import numpy as np
import pytest

from onehop.analysis import Log, open_log
from onehop.analysis.columns import TABLES
from onehop.analysis.derived import DERIVED
from onehop.contracts.errors import InputError, LogError
from onehop.wire.log_reader import LogFile

from .conftest import HELD, HELD_S, HOLD_S, KILLED_S, LEADER

EVERYTHING = ("truth", "radio", "rx/", "obs/", "out/")


def test_every_message_of_the_log_is_found(log: Log, log_path: Path) -> None:
    expected = [(t.tick, key, data) for t in LogFile(log_path).ticks() for key, data in t.messages]
    assert list(map(tuple, log.messages(*EVERYTHING))) == expected


def test_a_stretch_of_time_is_what_filtering_everything_would_give(log: Log) -> None:
    first, last = log.tick_at(2.0), log.tick_at(3.5)
    expected = [m for m in log.messages("truth", "out/3") if first <= m.tick <= last]
    assert list(log.messages("truth", "out/3", start_s=2.0, end_s=3.5)) == expected
    assert len(expected) == 2 * (last - first + 1)


def test_only_the_wanted_robot_is_read(log: Log) -> None:
    assert {message.key for message in log.messages("out/3", "rx/1")} == {"out/3", "rx/1"}


def test_a_torn_log_gives_what_lies_before_the_tear(log: Log, log_path: Path, tmp_path: Path) -> None:
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(log_path.read_bytes()[: log_path.stat().st_size // 2])
    opened = open_log(torn)
    assert opened.torn
    assert opened.summary is None
    whole, part = list(log.messages(*EVERYTHING)), list(opened.messages(*EVERYTHING))
    assert 0 < len(part) < len(whole)
    assert part == whole[: len(part)]


def test_a_sound_log_is_not_torn_and_knows_its_outcome(log: Log) -> None:
    assert not log.torn
    assert log.summary is not None
    assert log.summary["ticks"] == len(list(log.truths()))


def test_a_damaged_chunk_is_named_and_never_passed_off_as_data(log_path: Path, tmp_path: Path) -> None:
    damaged = bytearray(log_path.read_bytes())
    damaged[len(damaged) * 3 // 4] ^= 0xFF
    path = tmp_path / "damaged.mcap"
    path.write_bytes(damaged)
    with pytest.raises(LogError, match="damaged in the record at byte"):
        list(open_log(path).messages(*EVERYTHING))


def test_a_file_that_is_no_log_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "notes.mcap"
    path.write_text("no log at all")
    with pytest.raises(LogError, match="not an MCAP file"):
        open_log(path)


def test_status_columns_are_the_actions_of_the_robot(log: Log) -> None:
    table = log.table("status", robots=[3])
    actions = [(tick, action) for tick, action in log.actions(3)]
    assert table["tick"].tolist() == [tick for tick, _ in actions]
    assert table["error"].tolist() == [action.status.error for _, action in actions]
    assert table["mode"].tolist() == [action.status.mode.value for _, action in actions]
    assert table["members"].tolist() == [action.status.members for _, action in actions]
    assert table["v"].tolist() == [action.twist.v for _, action in actions]


def test_pose_columns_are_the_ground_truth(log: Log) -> None:
    table = log.table("poses")
    expected = [
        (tick, one.robot, one.pose.x, one.pose.heading, one.held)
        for tick, truth in log.truths()
        for one in truth.present
    ]
    columns = (table[name].tolist() for name in ("tick", "robot", "x", "heading", "held"))
    assert list(zip(*columns, strict=True)) == expected


def test_scans_are_one_matrix_with_a_row_for_each_observation(log: Log) -> None:
    table = log.table("scans", robots=[4], start_s=1.0, end_s=2.0)
    seen = [observation.scan for _, observation in log.observations(4, 1.0, 2.0)]
    assert table["ranges"].shape == (len(seen), log.scenario.robot.laser_beams)
    assert np.array_equal(table["ranges"], np.array(seen))


def test_the_hold_is_in_the_poses_for_as_long_as_it_lasted(log: Log) -> None:
    own = log.table("poses").of(HELD)
    held_s = np.count_nonzero(own["held"]) * log.period_ns / 1e9
    assert held_s == pytest.approx(HOLD_S, abs=0.11)
    assert own["time_s"][own["held"]][0] == pytest.approx(HELD_S, abs=0.11)


def test_the_killed_leader_departs_once(log: Log) -> None:
    table = log.table("departures")
    assert table["robot"].tolist() == [LEADER]
    assert table["time_s"][0] == pytest.approx(KILLED_S, abs=0.11)


@pytest.mark.parametrize(
    ("name", "column", "dtype"),
    [
        ("status", "leader", np.int64), ("status", "k_rho", np.float64), ("poses", "held", np.bool_),
        ("verdicts", "attempts", np.int64), ("scans", "ranges", np.float32), ("notes", "data", object),
    ],
)  # fmt: skip
def test_a_column_has_its_type_even_when_it_is_empty(
    log: Log, name: str, column: str, dtype: type
) -> None:
    assert log.table(name)[column].dtype == dtype
    assert log.table(name, end_s=-1.0)[column].dtype == dtype


@pytest.mark.parametrize("name", sorted(TABLES))
def test_every_table_has_its_columns_in_equal_length_even_when_empty(log: Log, name: str) -> None:
    for table in (log.table(name), log.table(name, end_s=-1.0)):
        declared = [column.name for column in TABLES[name].columns]
        assert list(table) == ["tick", "time_s", *declared]
        assert {len(column) for column in table.values()} == {len(table)}


@pytest.mark.parametrize("name", sorted(DERIVED))
def test_a_computed_table_has_its_columns_whether_or_not_it_is_empty(log: Log, name: str) -> None:
    whole = log.table(name)
    for table in (whole, log.table(name, end_s=-1.0)):
        assert list(table) == ["tick", "time_s", *(column for column, _ in DERIVED[name].columns)]
        assert {len(column) for column in table.values()} == {len(table)}
    assert len(whole) > 100
    part = log.table(name, start_s=2.0, end_s=3.0)
    assert set(part["time_s"]) == set(whole["time_s"][(whole["time_s"] >= 2) & (whole["time_s"] <= 3)])


def test_a_table_that_there_is_not_is_refused_with_the_names_that_there_are(log: Log) -> None:
    with pytest.raises(InputError, match="one of poses"):
        log.table("pose")


def test_tables_go_to_polars_with_lists_for_members(log: Log) -> None:
    polars = pytest.importorskip("polars", reason="the extra `tables` is not installed")
    frame = log.table("status", robots=[3], end_s=1.0).to_polars()
    assert isinstance(frame, polars.DataFrame)
    assert frame["members"][0].to_list() == [1, 2, 3, 4]
