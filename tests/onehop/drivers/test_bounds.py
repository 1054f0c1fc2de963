"""Missions on a perfect link and without one: they run, re-execute, and keep every promise."""

from pathlib import Path

import pytest

from onehop.checking import judge
from onehop.drivers import inline
from onehop.drivers.replay import replay
from onehop.wire.log_reader import LogFile
from tests.onehop.scenes import field, log_of

PARTED = "faults=[{kind='cut', at_s=9, robots=[1], duration_s=3}, {kind='kill', at_s=12, robots=[2]}]"


@pytest.mark.parametrize("link", ["perfect", "none"])
@pytest.mark.parametrize("profile", ["team", "thesis"])
def test_a_mission_on_a_bound_re_executes_and_keeps_every_promise(
    tmp_path: Path, link: str, profile: str
) -> None:
    bundle = field(tmp_path, f"radio.link={link}", f"profile={profile}", "clock.limit_s=30", PARTED)
    path = tmp_path / "mission.mcap"
    log_of(bundle, path)
    assert replay(LogFile(path)).divergences == 0
    assert judge(LogFile(path)).violations == ()


def test_on_a_perfect_link_nothing_is_lost(tmp_path: Path) -> None:
    outcome = inline.run(field(tmp_path, "radio.link=perfect"), None)
    assert (outcome.outcome, outcome.arrived) == ("arrived", (1, 2, 3, 4))


@pytest.mark.parametrize("profile", ["team", "thesis"])
def test_without_a_link_each_robot_leads_itself_to_the_goal(tmp_path: Path, profile: str) -> None:
    outcome = inline.run(field(tmp_path, "radio.link=none", f"profile={profile}"), None)
    assert outcome.outcome == "arrived"
    assert {term.members for term in outcome.leaders} == {(1,), (2,), (3,), (4,)}
    assert outcome.arrived == (1, 2, 3, 4)
