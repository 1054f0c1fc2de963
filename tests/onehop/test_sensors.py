"""Noise on pose and scan, and whom a card hears: told to programs, drawn by world and radio alone."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from onehop.analysis import open_log
from onehop.checking import judge
from onehop.contracts.sections import NOISE_SIGMAS
from onehop.drivers.replay import replay
from onehop.maps.map_file import load_map
from onehop.robot import Action, Briefing, Percept, Program, Twist, broadcast
from onehop.wire.log_reader import LogFile
from tests.onehop.forgery import Forgery
from tests.onehop.scenes import field, log_of
from world_server.core.world import World

NOISY = ("robot.pose_noise=0.05", "robot.heading_noise_deg=1.0", "robot.laser_noise=0.03")
LISTENER = "tests.onehop.test_sensors:Listener"


class Listener(Program):
    """Turns, calls out once a second, and shows how well it hears the others."""

    def __init__(self, briefing: Briefing) -> None:
        self.me = briefing.robot
        self.snr: dict[int, float] = {}

    def step(self, percept: Percept) -> Action:
        for one in percept.neighbours:
            self.snr[one.robot] = one.snr_db
        calls = percept.tick % 20 == self.me
        shown = {f"snr_{robot}": snr for robot, snr in self.snr.items()}
        return Action(Twist(0.0, 0.3), outbox=[broadcast(b"here")] if calls else [], values=shown)


def world(folder: Path, *settings: str) -> World:
    bundle = field(folder, *settings)
    return World(bundle.scenario, load_map(bundle.scenario.map, {}))


def test_without_noise_a_robot_is_told_the_truth(tmp_path: Path) -> None:
    ground = world(tmp_path)
    seen = ground.observe()
    assert all(seen[one.robot].pose is one.pose for one in ground.truth().present)


@pytest.mark.slow
def test_noise_has_the_spread_that_was_asked_for_and_bounds(tmp_path: Path) -> None:
    true, told = world(tmp_path, "clock.limit_s=900"), world(tmp_path, *NOISY, "clock.limit_s=900")
    off, ranges = [], []
    for _ in range(400):
        here, seen = true.observe(), told.observe()
        for robot in here:
            exact, noisy = here[robot], seen[robot]
            turned = math.remainder(noisy.pose.heading - exact.pose.heading, math.tau)
            off.append((noisy.pose.x - exact.pose.x, noisy.pose.y - exact.pose.y, turned))
            hit = np.isfinite(exact.scan)
            assert np.array_equal(hit, np.isfinite(noisy.scan))
            inside = hit & (exact.scan < 9.8)
            ranges.append(noisy.scan[inside] - exact.scan[inside])
            assert noisy.scan[hit].max() <= 10.0
        true.advance({})
        told.advance({})
    assert np.std(off, axis=0) == pytest.approx([0.05, 0.05, math.radians(1.0)], rel=0.06)
    assert np.abs(np.mean(off, axis=0)).max() < 0.005
    assert np.abs(off).max() <= NOISE_SIGMAS * 0.05
    all_ranges = np.concatenate(ranges)
    assert np.std(all_ranges) == pytest.approx(0.03, rel=0.05)
    assert np.abs(all_ranges).max() <= NOISE_SIGMAS * 0.03 + 1e-5


def test_asking_twice_draws_once_and_nobody_draws_for_another(tmp_path: Path) -> None:
    one, other = world(tmp_path, *NOISY), world(tmp_path, *NOISY)
    assert one.observe() is one.observe()
    other.fence(2, "gone")
    other.observe()
    for _ in range(3):
        one.advance({})
        other.advance({})
        one.observe()
        assert other.observe()[4].pose == one.observe()[4].pose
        assert np.array_equal(other.observe()[4].scan, one.observe()[4].scan)


def test_one_robot_may_be_the_only_one_with_noise(tmp_path: Path) -> None:
    ground = world(tmp_path, "robots=[{id=3, body={pose_noise=0.5}}]")
    seen = ground.observe()
    wrong = [one.robot for one in ground.truth().present if seen[one.robot].pose != one.pose]
    assert wrong == [3]


@pytest.fixture(scope="module")
def noisy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("noisy")
    log_of(field(folder, *NOISY, "clock.limit_s=8"), folder / "mission.mcap")
    return folder / "mission.mcap"


def test_a_noisy_mission_is_executed_again_and_judged_by_its_truth(noisy: Path) -> None:
    log = LogFile(noisy)
    assert replay(log).same
    assert judge(log).holds


def test_a_pose_beyond_its_noise_is_found(noisy: Path, tmp_path: Path) -> None:
    forgery = Forgery(noisy)

    def elsewhere(observation: dict[str, Any]) -> None:
        observation["pose"]["x"] += 1.0

    forgery.change(50, "obs/3", elsewhere)
    assert set(judge(forgery.write(tmp_path / "forged.mcap")).broken) == {"own-voice"}
    forgery = Forgery(noisy)
    forgery.settings = ["robot.pose_noise=0.01"]
    assert set(judge(forgery.write(tmp_path / "less.mcap")).broken) == {"own-voice"}


def test_programs_know_whom_they_hear_and_a_log_has_it_as_a_table(tmp_path: Path) -> None:
    settings = (f"team.program='{LISTENER}'", "radio.neighbours=true", "clock.limit_s=4")
    log_of(field(tmp_path, *settings), tmp_path / "mission.mcap")
    log = open_log(tmp_path / "mission.mcap")
    assert replay(LogFile(log.path)).same
    assert judge(LogFile(log.path)).holds
    heard = log.table("neighbours")
    pairs = {(int(a), int(b)) for a, b in heard.rows("robot", "neighbour")}
    assert pairs == {(a, b) for a in range(1, 5) for b in range(1, 5) if a != b}
    assert (heard["heard_s"] <= heard["time_s"] + 1e-9).all()
    shown = log.table("values").of(1)
    assert set(shown["name"].tolist()) == {"snr_2", "snr_3", "snr_4"}


def test_neighbours_who_are_not_in_the_team_are_a_forgery(tmp_path: Path) -> None:
    settings = (f"team.program='{LISTENER}'", "radio.neighbours=true", "clock.limit_s=2")
    log_of(field(tmp_path, *settings), tmp_path / "mission.mcap")
    forgery = Forgery(tmp_path / "mission.mcap")
    tick = next(
        tick for tick in range(40) if forgery.get(tick, "rx/1").get("neighbours")
    )  # fmt: skip
    forgery.change(tick, "rx/1", lambda inbox: inbox["neighbours"][0].update(robot=99))
    assert "complete" in judge(forgery.write(tmp_path / "forged.mcap")).broken
