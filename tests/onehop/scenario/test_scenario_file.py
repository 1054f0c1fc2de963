"""Scenario files: the whole of a right one, and one clear line for every wrong one."""

from pathlib import Path

import pytest

from onehop.contracts.briefings import Briefing, robot_briefing
from onehop.contracts.errors import ScenarioError
from onehop.scenario import scenario_file
from onehop.scenario.bundle import bundle_from_json
from onehop.wire.codec import decode, encode
from tests.onehop.scenes import FIELD, field

SCENARIOS = sorted((Path(__file__).parents[3] / "scenarios").glob("*.toml"))


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_every_scenario_of_ours_loads(path: Path) -> None:
    assert scenario_file.load(path).scenario.name == path.stem


def test_what_is_not_given_has_its_default(tmp_path: Path) -> None:
    scenario = field(tmp_path).scenario
    assert scenario.team.robots == (1, 2, 3, 4)
    assert (scenario.gains.k_alpha, scenario.gains.k_beta, scenario.gains.k_rho_max) == (8.0, -1.5, 3.0)
    assert scenario.team.next_period == 2.0
    assert scenario.team.next_msdu_bytes == 800


def test_a_bundle_survives_its_own_json(tmp_path: Path) -> None:
    bundle = field(tmp_path, "seed=9")
    assert bundle_from_json(bundle.scenario_json(), bundle.files, "log") == bundle


def test_a_robot_is_briefed_without_the_map(tmp_path: Path) -> None:
    briefing = robot_briefing(field(tmp_path).scenario, 2, 1)
    data = encode(briefing)
    assert decode(Briefing, data) == briefing
    assert b"obstacles" not in data
    assert b"poses" not in data


def test_settings_change_keys_with_toml_values(tmp_path: Path) -> None:
    scenario = field(
        tmp_path, "team.size=3", "gains.policy=constant", "goal.x=31.5", "team.ids=[2, 4, 9]"
    ).scenario
    assert scenario.team.robots == (2, 4, 9)
    assert scenario.gains.policy == "constant"
    assert scenario.goal.x == 31.5


@pytest.mark.parametrize(
    ("change", "where", "what", "remedy"),
    [
        ("team.sise=3", "team.sise", "unknown key", "did you mean size?"),
        ("teem=3", "teem", "unknown key", "did you mean team?"),
        ("team.size='six'", "team.size", "'six' is not a whole number", "give a whole number"),
        ("team.size=2.5", "team.size", "2.5 is not a whole number", "give a whole number"),
        ("seed=true", "seed", "True is not a whole number", "give a whole number"),
        ("goal.x='a'", "goal.x", "'a' is not a number", "give a number"),
        ("team.size=0", "team.size", "0 is out of range", "from 1 to 300"),
        ("team.ids=[1, 2, 2]", "team.ids", "robot 2 stands twice", "every id once"),
        ("gains.k_beta=1.5", "gains.k_beta", "1.5 is not negative", "eq. 3.14"),
        ("gains.k_alpha=2", "gains.k_alpha", "2.0 - k_rho_max 3.0 is not positive", "eq. 3.14"),
        ("gains.policy=fast", "gains.policy", "'fast' is unknown", "'constant'"),
        ("radio.rate_mbps=3", "radio.rate_mbps", "3.0 Mb/s", "1, 2, 5.5 or 11"),
        ("planner.inflation=0.1", "planner.inflation", "less than robot.radius", "at least the radius"),
        ("map.obstacles=[[[1, 2], [3, 4]]]", "map.obstacles[0]", "2 corners", "at least 3"),
        ("map.obstacles=[[[1, 2], [3, 4], [50, 1]]]", "map.obstacles[0]", "outside the map", "<= 40"),
        ("map.obstacles=[[[1, 2], [3, 'x'], [5, 1]]]", "map.obstacles[0][1][1]", "'x' is not", "number"),
        ("map.obstacles=[[[1, 2], [3], [5, 1]]]", "map.obstacles[0][1]", "wrong form", "map1.toml"),
        ("start.poses=[[1, 1, 0]]", "start.poses", "1 poses for 4 robots", "order of id"),
        ("faults=[{kind='melt', at_s=1}]", "faults[0].kind", "'melt' is unknown", "'kill'"),
        (
            "faults=[{kind='kill', at_s=1, robots=[9]}]",
            "faults[0].robots",
            "robot 9 is not",
            "1, 2, 3, 4",
        ),
        (
            "faults=[{kind='kill', at_s=-1, robots=[1]}]",
            "faults[0].at_s",
            "out of range",
            "from 0 to 1e+06",
        ),
        ("clock.period_ms=0", "clock.period_ms", "0 is out of range", "from 1 to 1000"),
        ("map.file='nowhere.yaml'", "map.file", "a map file and a polygon map", "keep one"),
    ],
)
def test_a_mistake_is_one_line_with_file_key_and_remedy(
    tmp_path: Path, change: str, where: str, what: str, remedy: str
) -> None:
    with pytest.raises(ScenarioError) as refusal:
        field(tmp_path, change)
    error = refusal.value
    assert error.where == f"{tmp_path / 'field.toml'}: {where}"
    assert what in error.problem
    assert remedy in error.remedy
    assert "\n" not in str(error)


def test_a_missing_key_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("[map]\nwidth = 10\nheight = 10\n[goal]\nx = 3\n")
    with pytest.raises(ScenarioError, match=r"goal\.y: is missing"):
        scenario_file.load(path)


def test_a_file_that_is_no_toml_or_not_there(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    with pytest.raises(ScenarioError, match="No such file"):
        scenario_file.load(path)
    path.write_text("name = [")
    with pytest.raises(ScenarioError, match="not TOML"):
        scenario_file.load(path)


def test_a_map_file_that_is_not_there(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("[map]\nfile = 'gone.map'\n[goal]\nx = 1\ny = 1\n")
    with pytest.raises(ScenarioError, match=r"map\.file: .*gone\.map: No such file"):
        scenario_file.load(path)


@pytest.mark.parametrize(
    "setting",
    ["team.size", "=3", "team..size=3", "team.size.x=3", "faults.7.at_s=1", "faults[7].at_s=1", "[0]=1"],
)
def test_a_setting_of_the_wrong_form_is_refused(tmp_path: Path, setting: str) -> None:
    with pytest.raises(ScenarioError, match="--set"):
        field(tmp_path, setting)


@pytest.mark.parametrize("key", ["faults[1].duration_s", "faults.1.duration_s"])
def test_an_element_of_a_list_is_named_by_its_number(tmp_path: Path, key: str) -> None:
    hold = '{kind="hold", at_s=1, robots=[1], duration_s=5}'
    faults = field(tmp_path, f"faults=[{hold}, {hold}]", f"{key}=7").scenario.faults
    assert [fault.duration_s for fault in faults] == [5.0, 7.0]


def test_another_map_takes_the_scenarios_start_with_it(tmp_path: Path) -> None:
    grid = tmp_path / "room.map"
    grid.write_text("type octile\nheight 3\nwidth 4\nmap\n@@@@\n@..@\n@@@@\n")
    path = tmp_path / "field.toml"
    path.write_text(FIELD)
    bundle = scenario_file.load(path, map_file=grid, start=(1.5, 1.5), goal=(2.5, 1.5))
    assert bundle.scenario.map.file == "room.map"
    assert bundle.files == {"room.map": grid.read_bytes()}
    assert (bundle.scenario.start.x, bundle.scenario.goal.x) == (1.5, 2.5)


@pytest.mark.parametrize("text", ["1", "1,2,3", "a,b", ""])
def test_a_point_of_the_wrong_form_is_refused(text: str) -> None:
    with pytest.raises(ScenarioError, match=r"x,y in metres"):
        scenario_file.point(text, "--goal")


def test_what_a_robot_is_told_crosses_the_wire(tmp_path: Path) -> None:
    briefing = robot_briefing(field(tmp_path).scenario, 2, 1)
    assert decode(Briefing, encode(briefing)) == briefing


def test_a_bundle_reads_back_from_its_json(tmp_path: Path) -> None:
    bundle = field(tmp_path)
    assert bundle_from_json(bundle.scenario_json(), bundle.files, "test") == bundle
