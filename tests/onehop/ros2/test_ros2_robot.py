"""What a scenario may say of robots that are driven by ROS 2, and what it may not."""

from pathlib import Path

import pytest

from onehop.contracts.errors import ScenarioError
from onehop.programs.find import check, outsiders, require_programs
from onehop.scenario import scenario_file
from tests.onehop.scenes import FIELD

DRIVEN = 'robots=[{id=4, program="onehop.ros2.robot:Ros2Robot"%s}]'


def scenario_of(folder: Path, more: str = ""):
    (folder / "field.toml").write_text(FIELD)
    return scenario_file.load(folder / "field.toml", [DRIVEN % more]).scenario


def test_a_robot_that_is_driven_from_outside_is_not_one_of_those_that_re_execute(tmp_path: Path) -> None:
    scenario = scenario_of(tmp_path)
    check(scenario, "field.toml")
    assert outsiders(scenario) == (4,)


def test_it_has_no_place_in_a_mission_of_one_process(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"field.toml: robots\[0\].program: robot 4 is driven from"):
        require_programs(scenario_of(tmp_path), "field.toml")


@pytest.mark.parametrize(
    ("given", "says"),
    [("domain=300", "domain"), ('distro="foxy"', "distro"), ("hold_s=0", "hold_s"), ("port=1", "port")],
)
def test_its_parameters_are_checked(tmp_path: Path, given: str, says: str) -> None:
    with pytest.raises(ScenarioError, match=says):
        check(scenario_of(tmp_path, f", parameters={{{given}}}"), "field.toml")
