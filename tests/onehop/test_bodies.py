"""Robots with bodies of their own: moved, seen, briefed, judged and drawn each by its own numbers."""

import math
from pathlib import Path

import numpy as np
import pytest

from onehop.analysis import open_log
from onehop.analysis.report.page import write_report
from onehop.analysis.view.layer import write_view
from onehop.chaos.shrink import _of_robots
from onehop.chaos.swarm import draw_mission
from onehop.checking import judge
from onehop.contracts.briefings import robot_briefing
from onehop.contracts.errors import InputError
from onehop.contracts.geometry import Twist
from onehop.contracts.messages import Action
from onehop.contracts.sections import RobotSection
from onehop.drivers.replay import replay
from onehop.maps.map_file import load_map
from onehop.scenario import scenario_file
from onehop.scenario.as_toml import as_toml
from onehop.scenario.bundle import Bundle, bundle_from_json
from onehop.wire.log_reader import LogFile
from tests.onehop.forgery import Forgery
from tests.onehop.scenes import field, log_of
from world_server.core.world import World

BIG, SMALL = 3, 4
BODIES = (
    "robots=[{id=3, body={radius=0.45, max_speed=1.2, max_turn_rate=1.5, leader_speed=0.7,"
    " laser_beams=91, laser_fov_deg=240}}, {id=4, body={radius=0.1, laser_range=4}}]"
)
ROW = "start.poses=[[10, 10, 0], [11, 10, 0], [10, 12, 0], [12, 14, 0]]"


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bodies")
    log_of(field(folder, BODIES, "clock.limit_s=25"), folder / "mission.mcap")
    return folder / "mission.mcap"


def world(folder: Path, *settings: str) -> World:
    bundle = field(folder, BODIES, ROW, *settings)
    return World(bundle.scenario, load_map(bundle.scenario.map, {}))


def driving(v: float, w: float) -> Action:
    return Action(0, 0, Twist(v, w), (), abs(v), 0.0, None, ())


def test_what_an_entry_leaves_out_is_as_section_robot_says(tmp_path: Path) -> None:
    scenario = field(tmp_path, BODIES, "robot.max_speed=2.5", "robot.laser_range=8").scenario
    assert scenario.bodies[:2] == (scenario.robot, scenario.robot)
    assert scenario.body_of(SMALL) == RobotSection(radius=0.1, max_speed=2.5, laser_range=4.0)
    assert scenario.body_of(BIG).laser_range == 8.0


def test_a_robot_is_told_its_own_body(tmp_path: Path) -> None:
    scenario = field(tmp_path, BODIES).scenario
    told = {robot: robot_briefing(scenario, robot, 0).body for robot in scenario.team.robots}
    assert told[1] == RobotSection()
    assert (told[BIG].radius, told[BIG].laser_beams) == (0.45, 91)
    assert (told[SMALL].radius, told[SMALL].laser_range) == (0.1, 4.0)


def test_motors_give_what_they_can_each(tmp_path: Path) -> None:
    ground = world(tmp_path)
    ground.advance({robot: driving(9.0, 9.0) for robot in (1, BIG)})
    present = {one.robot: one for one in ground.truth().present}
    assert present[1].twist == Twist(3.0, 3.0)
    assert present[BIG].twist == Twist(1.2, 1.5)


def test_bodies_touch_at_the_sum_of_their_radii_and_see_each_other_as_large_as_they_are(
    tmp_path: Path,
) -> None:
    row = "start.poses=[[10, 10, 0], [12, 10, 180], [20, 10, 0], [22, 10, 180]]"
    bundle = field(tmp_path, BODIES, row)
    ground = World(bundle.scenario, load_map(bundle.scenario.map, {}))
    seen = ground.observe()
    middle = {robot: len(seen[robot].scan) // 2 for robot in seen}
    assert seen[2].scan[middle[2]] == pytest.approx(1.8)
    assert seen[BIG].scan[middle[BIG]] == pytest.approx(1.9)
    assert seen[SMALL].scan[middle[SMALL]] == pytest.approx(1.55)
    for _ in range(40):
        ground.advance({2: driving(1.0, 0.0), SMALL: driving(1.0, 0.0)})
    poses = {one.robot: one.pose.x for one in ground.truth().present}
    assert poses[2] - poses[1] == pytest.approx(0.4, abs=1e-6)
    assert poses[SMALL] - poses[BIG] == pytest.approx(0.55, abs=1e-6)


def test_each_has_its_own_laser(tmp_path: Path) -> None:
    seen = {robot: one.scan for robot, one in world(tmp_path).observe().items()}
    assert {robot: len(scan) for robot, scan in seen.items()} == {1: 181, 2: 181, BIG: 91, SMALL: 181}
    assert np.isfinite(seen[1]).any()
    assert seen[SMALL][np.isfinite(seen[SMALL])].max(initial=0.0) <= 4.0
    assert all(not scan.flags.writeable for scan in seen.values())


def test_a_large_robot_is_put_down_where_it_touches_nobody(tmp_path: Path) -> None:
    fault = "faults=[{kind='kidnap', at_s=0.0, robots=[3], x=10, y=10}]"
    ground = world(tmp_path, fault)
    poses = {one.robot: one.pose for one in ground.truth().present}
    for robot in (1, 2):
        apart = math.hypot(poses[BIG].x - poses[robot].x, poses[BIG].y - poses[robot].y)
        assert apart >= 0.65 + 0.05


def test_a_mixed_mission_is_executed_again_and_keeps_every_promise(mission: Path) -> None:
    log = LogFile(mission)
    assert replay(log).same
    report = judge(log)
    assert report.holds
    assert report.checked["motion"] > 0


@pytest.mark.parametrize(
    ("setting", "invariant"),
    [("robots[0].body.max_speed=0.3", "motion"), ("robots[0].body.max_turn_rate=0.05", "motion"),
     ("robots[0].body.radius=3", "no-collision")],
)  # fmt: skip
def test_the_checker_holds_each_robot_to_its_own_body(
    mission: Path, tmp_path: Path, setting: str, invariant: str
) -> None:
    forgery = Forgery(mission)
    forgery.settings = [setting, "planner.inflation=3"]
    report = judge(forgery.write(tmp_path / "forged.mcap"))
    assert set(report.broken) == {invariant}
    assert any(BIG in one.robots for one in report.violations)


def test_scans_of_several_lasers_are_one_matrix_that_ends_in_nan(mission: Path) -> None:
    table = open_log(mission).table("scans", end_s=0.5)
    assert table["ranges"].shape[1] == 181
    assert np.isnan(table.of(BIG)["ranges"][:, 91:]).all()
    assert not np.isnan(table.of(BIG)["ranges"][:, :91]).any()


def test_it_is_drawn_and_shown(mission: Path, tmp_path: Path) -> None:
    log = open_log(mission)
    assert "trajectory.png" in {path.name for path in write_report(log, tmp_path).figures}
    copy = tmp_path / "viewed.mcap"
    copy.write_bytes(mission.read_bytes())
    write_view(open_log(copy), copy)
    assert "/robot-3/scan" in {one.topic for one in LogFile(copy).contents.channels}


def test_bodies_survive_json_and_toml(tmp_path: Path) -> None:
    bundle = field(tmp_path, BODIES)
    assert bundle_from_json(bundle.scenario_json(), {}, "log") == bundle
    (tmp_path / "again.toml").write_text(as_toml(bundle.scenario))
    assert scenario_file.load(tmp_path / "again.toml").scenario == bundle.scenario


WRONG = {
    "robots=[{id=3, body={radius=0}}]": "robots[0].body.radius: 0.0 is out of range; a number from 0.01",
    "robots=[{id=3, body={raduis=0.3}}]": "robots[0].body.raduis: unknown key; did you mean radius?",
    "robots=[{id=3, body={laser_beams=2.5}}]": "robots[0].body.laser_beams: 2.5 is",
    "robots=[{id=3}, {id=1, body={radius=0.8}}]": (
        "planner.inflation: 0.5 m is less than robots[1].body.radius 0.8 m; at least the radius"
    ),
}


@pytest.mark.parametrize("setting", WRONG)
def test_a_body_that_cannot_be_is_one_line(setting: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        field(tmp_path, setting)
    assert WRONG[setting] in str(refused.value)
    assert "\n" not in str(refused.value)


def test_start_poses_are_apart_by_the_radii_of_both(tmp_path: Path) -> None:
    close = "start.poses=[[10, 10, 0], [20, 10, 0], [10.6, 10, 0], [20.35, 10, 0]]"
    bundle = field(tmp_path, BODIES, close)
    with pytest.raises(InputError, match=r"start.poses\[2\].*start.poses\[0\]; at least 0.65 m"):
        World(bundle.scenario, load_map(bundle.scenario.map, {}))


def test_chaos_draws_teams_and_takes_robots_away_with_their_entries(tmp_path: Path) -> None:
    bundle = field(tmp_path, BODIES)
    fewer = _of_robots(bundle.scenario, (1, 3))
    assert [one.id for one in fewer.robots] == [BIG]
    assert list(fewer.problems()) == []
    for seed in range(1, 9):
        drawn = draw_mission(Bundle(bundle.scenario, {}), seed, budget=True).scenario
        assert list(drawn.problems()) == []
