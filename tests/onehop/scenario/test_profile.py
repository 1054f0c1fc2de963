"""`profile = "thesis"`: defaults of the sections, over which the file's own keys stand."""

import tomllib
from pathlib import Path

import pytest

from onehop.contracts.errors import ScenarioError
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle, bundle_from_json, changed
from tests.onehop.scenes import field

SCENARIOS = Path(__file__).parents[3] / "scenarios"
THESIS = sorted((SCENARIOS / "thesis").glob("*.toml"))


@pytest.fixture
def thesis(tmp_path: Path) -> Bundle:
    return field(tmp_path, "profile=thesis")


def test_the_profile_switches_the_thesis_on(thesis: Bundle) -> None:
    team, gains, planner = thesis.scenario.team, thesis.scenario.gains, thesis.scenario.planner
    assert (team.profile, team.lost_after, team.target_timeout) == ("thesis", 1, 2.0)
    assert (gains.policy, gains.threshold, gains.reverse) == ("throughput", "slot", True)
    assert (planner.kind, planner.classify) == ("modified", "driving")


def test_what_it_does_not_name_keeps_its_default(thesis: Bundle, tmp_path: Path) -> None:
    usual = field(tmp_path).scenario
    assert usual.profile == "team"
    assert thesis.scenario.team.size == usual.team.size == 4
    assert thesis.scenario.radio == usual.radio


def test_a_key_that_is_given_wins(tmp_path: Path) -> None:
    scenario = field(
        tmp_path, "profile=thesis", "team.lost_after=3", "gains.reverse=false", "planner.kind=escape"
    ).scenario
    assert (scenario.team.lost_after, scenario.gains.reverse) == (3, False)
    assert scenario.planner.kind == "escape"
    assert scenario.gains.threshold == "slot"


def test_the_timeout_at_the_target_is_the_next_period_of_the_scenario(tmp_path: Path) -> None:
    assert field(tmp_path, "profile=thesis", "team.next_period=3").scenario.team.target_timeout == 3.0


def test_a_path_that_is_given_is_driven_along(tmp_path: Path) -> None:
    path = "planner.path=[[8, 8], [30, 14]]"
    assert field(tmp_path, "profile=thesis", path).scenario.planner.kind == "path"
    assert field(tmp_path, path).scenario.planner.kind == "escape"


def test_a_log_carries_all_of_it_and_reads_it_back_as_it_was(thesis: Bundle, tmp_path: Path) -> None:
    assert bundle_from_json(thesis.scenario_json(), thesis.files, "log") == thesis
    other = field(tmp_path, "profile=thesis", "team.lost_after=2")
    assert bundle_from_json(other.scenario_json(), other.files, "log") == other


def test_a_log_does_not_change_its_profile(thesis: Bundle) -> None:
    assert changed(thesis.scenario, ["team.lost_after=2"]).team.lost_after == 2
    with pytest.raises(ScenarioError, match="set the keys themselves"):
        changed(thesis.scenario, ["profile=team"])


@pytest.mark.parametrize(
    ("change", "where", "what", "remedy"),
    [
        ("profile=phd", "profile", "'phd' is unknown", "'thesis'"),
        ("profile=3", "profile", "3 is unknown", "'thesis'"),
        ("gains=3", "gains", "wrong form", "map1.toml"),
        ("team.target_timeout=1", "team.target_timeout", "less than next_period", "or 0"),
        ("team.lost_afer=2", "team.lost_afer", "unknown key", "lost_after"),
        ("planner.path=[[8, 8]]", "planner.path", "1 points", "at least two"),
        ("planner.path=[[8, 8], [30]]", "planner.path[1]", "wrong form", "map1.toml"),
        ("planner.path=[[30, 30], [30, 14]]", "planner.path", "31.1 m from the start", "laser_range"),
        ("planner.path=[[8, 8], [30, 13]]", "planner.path", "1.00 m from the goal", "0.25 m"),
        (f"planner.path={[[8, 8]] * 1001}", "planner.path", "1001 points", "at most 1000"),
    ],
)
def test_nonsense_is_one_line_with_key_and_remedy(
    tmp_path: Path, change: str, where: str, what: str, remedy: str
) -> None:
    with pytest.raises(ScenarioError) as refusal:
        field(tmp_path, "profile=thesis", change)
    assert refusal.value.where.endswith(f": {where}")
    assert what in f"{refusal.value.problem}"
    assert remedy in refusal.value.remedy
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("path", THESIS, ids=lambda path: path.stem)
def test_every_scenario_of_the_thesis_loads(path: Path) -> None:
    scenario = scenario_file.load(path).scenario
    assert scenario.profile == "thesis"
    assert scenario.name.endswith(path.stem)


@pytest.mark.parametrize("name", ["map1", "map2", "map3"])
def test_the_thesis_drives_over_the_ground_of_the_study_maps(name: str) -> None:
    thesis, usual = (
        tomllib.loads(path.read_text())
        for path in (SCENARIOS / "thesis" / f"{name}.toml", SCENARIOS / f"{name}.toml")
    )
    assert thesis["map"] == usual["map"]
    assert thesis["goal"] == usual["goal"]
