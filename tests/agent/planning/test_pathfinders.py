"""The three pathfinders on whole missions of one leader, with the world's own laser and motion."""

import math
from dataclasses import replace

import numpy as np
import pytest

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import robot_briefing
from onehop.contracts.sections import RobotSection
from onehop.drive.solo import Solo, solo
from robot_agent.core.planning import Progress, make_pathfinder
from robot_agent.core.planning.escape import Escape, Phase
from tests.agent.planning.fields import CLOSED_ROOM, THREE_WALLS, alone, box, field, study_map
from world_server.core.laser import Laser

INFLATION = 0.5


def assert_arrived(outcome: Solo) -> None:
    assert outcome.progress is Progress.ARRIVED
    assert outcome.contacts == 0
    assert outcome.min_clearance >= INFLATION


def test_empty_field_is_crossed_straight_at_constant_speed() -> None:
    outcome = solo(*alone(field(size=60.0), (5.0, 5.0, 45.0), (45.0, 45.0)))
    assert_arrived(outcome)
    straight = math.dist((5.0, 5.0), (45.0, 45.0))
    assert outcome.length < 1.02 * straight
    assert outcome.length > 0.98 * (len(outcome.path) - 1) * 0.05


def test_leader_goes_around_a_block_without_stopping() -> None:
    ground = field(box(20, 10, 25, 30), size=40.0)
    outcome = solo(*alone(ground, (10.0, 20.0, 0.0), (35.0, 20.0)))
    assert_arrived(outcome)
    steps = np.hypot(*np.diff(outcome.path[:, :2], axis=0).T)
    assert np.mean(steps > 0.9 * 0.05) > 0.95


@pytest.mark.parametrize("heading", [0.0, 90.0, 180.0, -90.0])
def test_a_new_leader_turns_to_its_way_from_any_heading(heading: float) -> None:
    outcome = solo(*alone(field(box(20, 0, 22, 20), size=40.0), (10.0, 10.0, heading), (30.0, 10.0)))
    assert_arrived(outcome)


def test_a_leader_inside_the_inflation_moves_out_and_never_further_in() -> None:
    """0.35 m from a wall with an inflation of 0.5 m: allowed for a robot that takes over there."""
    scenario, walls = alone(field(size=30.0), (15.0, 15.0, 0.0), (25.0, 5.0))
    finder = make_pathfinder(robot_briefing(scenario, 1, 0), Pose(5.0, 0.35, 3.0), generator(1, "test"))
    laser, pose, room = Laser(walls, RobotSection()), np.array([[5.0, 0.35, 3.0]]), [0.35]
    for _ in range(200):
        scan = laser.scans(pose, np.zeros(1, dtype=np.int32))[0]
        guidance = finder.step(Pose(*map(float, pose[0])), scan)
        pose[0] = moved(pose[0], guidance.twist)
        room.append(float(walls.clearance(pose[:, :2])[0]))
    assert min(room) > 0.33
    assert room[-1] > INFLATION


def moved(pose: np.ndarray, twist: Twist) -> np.ndarray:
    """One period of 50 ms on the unicycle's arc (thesis eq. 3.3)."""
    turn = 0.5 * twist.w * 0.05
    chord = twist.v * 0.05 * np.sinc(turn / math.pi)
    heading = pose[2] + turn
    return pose + np.array((chord * math.cos(heading), chord * math.sin(heading), 2.0 * turn))


def test_same_seed_same_path_and_another_seed_another() -> None:
    ground = field(box(20, 10, 25, 30), size=40.0)
    first, again, other = (
        solo(*alone(ground, (10.0, 20.0, 0.0), (35.0, 20.0), seed=seed)).path.tobytes()
        for seed in (1, 1, 2)
    )
    assert first == again
    assert first != other


@pytest.mark.slow
def test_no_way_is_the_answer_for_a_closed_room_in_bounded_time() -> None:
    scenario, walls = alone(field(*CLOSED_ROOM), (60.0, 60.0, 45.0), (82.0, 82.0), limit_s=1500.0)
    scenario = replace(scenario, planner=replace(scenario.planner, patience=5.0))
    outcome = solo(scenario, walls)
    assert outcome.progress is Progress.NO_WAY
    assert outcome.contacts == 0
    search = scenario.planner.patience * scenario.robot.laser_range
    assert outcome.length < 2.5 * search + 2.0 * 104.0, outcome.length


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 6))
def test_escape_leaves_three_walls_nine_metres_apart(seed: int) -> None:
    """Thesis 4.1: three walls less than 10 m wide. How often Algorithm 2 fails there: bench/traps.py."""
    assert_arrived(solo(*alone(field(THREE_WALLS), (20.0, 50.0, 0.0), (90.0, 50.0), seed=seed)))


@pytest.mark.slow
def test_distbug_alone_leaves_the_trap() -> None:
    """The guarantee behind the search: with no patience at all, boundary following does it."""
    scenario, walls = alone(field(THREE_WALLS), (20.0, 50.0, 0.0), (90.0, 50.0))
    finder = make_pathfinder(robot_briefing(scenario, 1, 0), Pose(20.0, 50.0, 0.0), generator(1, "test"))
    assert isinstance(finder, Escape)
    finder.budget = -1.0
    laser, pose, phases = Laser(walls, RobotSection()), np.array([[20.0, 50.0, 0.0]]), set()
    for _ in range(6000):
        scan = laser.scans(pose, np.zeros(1, dtype=np.int32))[0]
        guidance = finder.step(Pose(*map(float, pose[0])), scan)
        phases.add(finder.phase)
        if guidance.progress is not Progress.DRIVING:
            break
        pose[0] = moved(pose[0], guidance.twist)
        assert float(walls.clearance(pose[:, :2])[0]) >= INFLATION
    assert guidance.progress is Progress.ARRIVED
    assert Phase.CIRCLE in phases


@pytest.mark.slow
@pytest.mark.parametrize("name", ["map1", "map2", "map3"])
def test_escape_crosses_the_study_maps(name: str) -> None:
    assert_arrived(solo(*alone(study_map(name), (10.0, 10.0, 45.0), (90.0, 90.0))))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_modified_leaves_the_corner_of_map1_and_original_does_not(seed: int) -> None:
    """Thesis fig. 4.1: within the same time."""
    for kind, progress in (("modified", Progress.ARRIVED), ("original", Progress.DRIVING)):
        outcome = solo(*alone(study_map("map1"), (10.0, 10.0, 45.0), (90.0, 90.0), kind, seed, 600.0))
        assert outcome.progress is progress
        assert outcome.contacts == 0


def test_memory_of_escape_is_fixed_when_it_is_made() -> None:
    scenario, walls = alone(field(box(20, 10, 25, 30), size=40.0), (10.0, 20.0, 0.0), (35.0, 20.0))
    finder = make_pathfinder(robot_briefing(scenario, 1, 0), Pose(10.0, 20.0, 0.0), generator(1, "test"))
    assert isinstance(finder, Escape)
    before = finder.openings.nbytes
    scan = Laser(walls, RobotSection()).scans(
        np.array([[10.0, 20.0, 0.0]]), np.zeros(1, dtype=np.int32)
    )[0]
    finder.step(Pose(10.0, 20.0, 0.0), scan)
    assert finder.openings.nbytes == before < 150_000
