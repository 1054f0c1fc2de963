"""The compose file of a mission: a service for each process, with what is its own and nothing else."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from onehop.commands.compose import compose
from onehop.contracts.errors import InputError
from onehop.scenario import scenario_file

ROOT = Path(__file__).parents[3]

TRIAL = """
[map]
width = 40
height = 40
[start]
x = 8
y = 8
[goal]
x = 30
y = 14
"""


def written(folder: Path, more: str) -> dict[str, Any]:
    scenario = folder / "trial.toml"
    scenario.write_text(TRIAL + more)
    assert compose(scenario, folder / "compose.yaml") == 0
    loaded: dict[str, Any] = yaml.safe_load((folder / "compose.yaml").read_text())
    return loaded


def test_the_file_of_this_repository_is_what_the_command_writes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    before = Path("compose.yaml").read_text()
    try:
        assert compose(Path("scenarios/map1.toml"), Path("compose.yaml")) == 0
        assert Path("compose.yaml").read_text() == before
    finally:
        Path("compose.yaml").write_text(before)
    assert capsys.readouterr().out == "compose.yaml: world, radio, recorder and 6 robots\n"


def test_every_process_has_its_own_certificate_and_network_and_no_privileges() -> None:
    file = yaml.safe_load((ROOT / "compose.yaml").read_text())
    robots = [f"robot-{i}" for i in range(1, 7)]
    clients = ["radio", "recorder", *robots]
    services = file["services"]
    assert list(services) == ["keys", "world", *clients, "report", "ros2"]
    assert services.pop("ros2")["networks"] == ["ros2"]
    for name, service in services.items():
        assert (service["read_only"], service["cap_drop"]) == (True, ["ALL"])
        assert service["user"] == "${ONEHOP_UID:-1000}:${ONEHOP_UID:-1000}"
        assert service["restart"] == "no"
        assert "environment" not in service
        keys = [one for one in service["volumes"] if "keys" in one]
        if name in ("world", *clients):
            assert keys == [f"keys-{name}:/keys/{name}:ro"]
            assert service["healthcheck"]["test"][-1] == "7447"
            assert service["networks"] == (clients if name == "world" else [name])
        else:
            assert service["network_mode"] == "none"
    assert file["networks"].pop("ros2") == {}
    assert all(network == {"internal": True} for network in file["networks"].values())
    assert [
        one for one in services["robot-3"]["volumes"] if "mission" in one or "scenarios" in one
    ] == []


@pytest.mark.parametrize("mode", ["lockstep", "realtime"])
def test_the_clock_is_the_scenario_s_unless_it_is_said_otherwise(mode: str, tmp_path: Path) -> None:
    file = written(tmp_path, f"[clock]\nmode = '{mode}'\n")
    world = file["services"]["world"]
    assert world["command"][-2:] == ["--set", f"clock.mode='${{ONEHOP_CLOCK:-{mode}}}'"]
    assert world["ulimits"] == {"rtprio": "${ONEHOP_RTPRIO:-0}"}


def test_the_report_is_made_of_a_log_that_is_whole_and_only_where_it_is_asked_for() -> None:
    services = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"]
    report = services.pop("report")
    assert report["profiles"] == ["report"]
    assert report["depends_on"] == {"recorder": {"condition": "service_completed_successfully"}}
    assert [name for name, service in services.items() if "profiles" in service] == ["ros2"]


def test_nodes_of_ros_2_see_a_log_as_it_grows_and_nothing_else_of_the_mission() -> None:
    bridge = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"]["ros2"]
    assert (bridge["profiles"], bridge["depends_on"]) == (["ros2"], {})
    assert bridge["volumes"] == ["./runs/compose:/log:ro"]
    assert bridge["ports"] == ["127.0.0.1:${ONEHOP_ROS_PORT:-7447}:7447"]


@pytest.mark.parametrize("size", [1, 50])
def test_a_team_of_any_size_is_one_command(size: int, tmp_path: Path) -> None:
    file = written(tmp_path, f"[team]\nsize = {size}\n")
    assert len([name for name in file["services"] if name.startswith("robot-")]) == size
    subnets = {
        str(one["ipam"]["config"][0]["subnet"]) for one in file["networks"].values() if "ipam" in one
    }
    assert len(subnets) == (size + 2 if size > 24 else 0)
    assert "build" not in file["x-process"]


def test_only_who_has_a_program_of_its_own_sees_a_folder_of_the_host(tmp_path: Path) -> None:
    program = "[team]\nprogram = 'tests.onehop.programs.samples:Seeker'\n"
    file = written(tmp_path, program)
    assert ".:/programs:ro" in file["services"]["robot-1"]["volumes"]
    command = file["services"]["robot-1"]["command"]
    assert command[command.index("--programs") + 1] == "/programs"


def test_a_robot_that_is_a_command_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match="robot 2 is a command of your own, which the image does not have"
    ):
        written(tmp_path, "[[robots]]\nid = 2\ncommand = ['true']\n")


def test_the_scenario_is_found_from_where_the_file_is_written(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    scenario = tmp_path / "trial.toml"
    scenario.write_text(TRIAL)
    assert scenario_file.load(scenario).scenario.team.size == 6
    assert compose(scenario, tmp_path / "deep" / "compose.yaml") == 0
    file = yaml.safe_load((tmp_path / "deep" / "compose.yaml").read_text())
    assert "..:/mission:ro" in file["services"]["world"]["volumes"]


def test_a_mission_with_a_real_base_is_refused_in_one_line(tmp_path: Path) -> None:
    real = '[clock]\nmode = "realtime"\n[[robots]]\nid = 3\nbase = "hardware"\n'
    with pytest.raises(
        InputError, match="robot 3 has a real base, whose driver is no container of ours"
    ):
        written(tmp_path, real)
