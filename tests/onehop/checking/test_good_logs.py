"""What keeps its promises is found to keep them, whatever befell it."""

from pathlib import Path

import pytest

from onehop.checking import INVARIANTS, judge
from onehop.wire.log_reader import LogFile
from tests.onehop.fault_scripts import SCRIPTS
from tests.onehop.scenes import field, log_of


def test_a_quiet_mission_holds(quiet_log: Path) -> None:
    report = judge(LogFile(quiet_log))
    assert report.violations == ()
    assert set(report.unexercised) == {"silence", "re-election", "fault-bit"}


def test_a_troubled_mission_holds_and_exercises_everything(troubled_log: Path) -> None:
    report = judge(LogFile(troubled_log))
    assert report.violations == ()
    assert report.unexercised == {}
    assert report.checked["fault-bit"] == 5
    assert report.checked["re-election"] == 1


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS.values(), ids=SCRIPTS)
def test_a_mission_with_faults_of_any_kind_holds(tmp_path: Path, script: str) -> None:
    log_of(field(tmp_path, f"faults=[{script}]", "clock.limit_s=12"), tmp_path / "mission.mcap")
    report = judge(LogFile(tmp_path / "mission.mcap"))
    assert report.violations == ()
    assert report.checked["fault-bit"] > 0


def test_only_what_is_asked_for_is_judged(quiet_log: Path) -> None:
    report = judge(LogFile(quiet_log), ["median", "motion"])
    assert set(report.checked) == {"median", "motion"}
    assert report.checked["median"] > 0


def test_profile_thesis_promises_no_single_leader(tmp_path: Path) -> None:
    log_of(field(tmp_path, "team.profile='thesis'", "clock.limit_s=10"), tmp_path / "mission.mcap")
    report = judge(LogFile(tmp_path / "mission.mcap"))
    assert report.violations == ()
    assert "thesis" in report.unexercised["one-leader"]
    assert set(report.checked) == set(INVARIANTS)


def test_a_torn_log_is_judged_as_far_as_it_goes(troubled_log: Path, tmp_path: Path) -> None:
    whole = troubled_log.read_bytes()
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(whole[: len(whole) * 2 // 3])
    report = judge(LogFile(torn))
    assert report.violations == ()
    assert "digest" in report.unexercised
