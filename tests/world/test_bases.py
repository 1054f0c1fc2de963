"""Robots with a real base: what is measured counts, and what is real about them is left to reality."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onehop.contracts.fault_section import FaultSection
from onehop.contracts.geometry import STANDSTILL, Pose, Twist
from onehop.contracts.hardware import LARGEST, Measured
from onehop.contracts.messages import Action, Contact
from onehop.contracts.robot_entry import RobotEntry
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    ClockSection,
    GoalSection,
    MapSection,
    RobotSection,
    StartSection,
    TeamSection,
)
from onehop.maps.map_file import load_map
from world_server.core.world import World

ROOM = MapSection(width=20.0, height=10.0)
REAL, NEAR, FAR = 2, 1, 3
BEAMS = 181


def scenario(*faults: FaultSection, real: tuple[int, ...] = (REAL,), **robot: float) -> Scenario:
    return Scenario(
        name="room",
        goal=GoalSection(18.0, 5.0),
        map=ROOM,
        start=StartSection(poses=((6.0, 5.0, 0.0), (3.0, 5.0, 0.0), (15.0, 8.0, 0.0))),
        team=TeamSection(size=3),
        robot=replace(RobotSection(), **robot),  # type: ignore[arg-type]
        clock=ClockSection(mode="realtime"),
        robots=tuple(RobotEntry(id=one, base="hardware") for one in real),
        faults=faults,
    )


def measured(
    x: float, y: float = 5.0, heading: float = 0.0, v: float = 0.0, w: float = 0.0, room: float = 8.0
) -> Measured:
    """Of a base in the middle of a round room."""
    return Measured(1, Pose(x, y, heading), Twist(v, w), np.full(BEAMS, room, dtype=np.float32))


def world(*faults: FaultSection, at: Measured | None = None, **robot: float) -> World:
    ground = World(scenario(*faults, **robot), load_map(ROOM, {}))
    ground.place({REAL: at or measured(3.0)})
    return ground


def action(v: float, w: float) -> Action:
    return Action(0, 0, Twist(v, w), (), abs(v), 5.0, None, ())


def pose_of(ground: World, robot: int) -> Pose:
    return next(one.pose for one in ground.truth().present if one.robot == robot)


def step(ground: World, *given: tuple[int, float, float], at: Measured | None = None) -> None:
    ground.observe()
    actions = {robot: action(v, w) for robot, v, w in given}
    ground.advance(actions, (), {} if at is None else {REAL: at})


def test_it_is_where_it_measured_itself_to_be_whatever_it_commands() -> None:
    ground = world(at=measured(3.5, 4.5, 0.25, 0.1, -0.2))
    assert pose_of(ground, REAL) == Pose(3.5, 4.5, 0.25)
    step(ground, (REAL, 1.0, 0.0))
    assert pose_of(ground, REAL) == Pose(3.5, 4.5, 0.25)  # nothing new has been measured
    step(ground, (REAL, 1.0, 0.0), at=measured(3.6, 4.4, -3.0, 0.3, 0.4))
    seen = ground.observe()[REAL]
    assert (seen.pose, seen.twist) == (Pose(3.6, 4.4, -3.0), Twist(0.3, 0.4))


def test_it_is_driven_by_what_would_have_moved_a_simulated_robot() -> None:
    ground = world(max_speed=0.5, max_turn_rate=1.0)
    assert ground.drives() == {REAL: STANDSTILL}
    step(ground, (REAL, 2.0, -3.0))
    assert ground.drives() == {REAL: Twist(0.5, -1.0)}
    step(ground)
    assert ground.drives() == {REAL: STANDSTILL}


def test_who_is_held_stopped_or_gone_rests_at_once() -> None:
    for kind in ("hold", "stop", "kill"):
        ground = world(FaultSection(kind=kind, at_s=0.1, robots=(REAL,)))  # type: ignore[arg-type]
        step(ground, (REAL, 1.0, 0.0))
        assert ground.drives() == {REAL: Twist(1.0, 0.0)}
        step(ground, (REAL, 1.0, 0.0))
        assert ground.drives() == {REAL: STANDSTILL}, kind


def test_a_restarted_program_begins_at_rest_and_where_its_base_is() -> None:
    ground = world(FaultSection(kind="restart", at_s=0.05, robots=(REAL,)))
    step(ground, (REAL, 1.0, 0.0), at=measured(3.1, v=0.9))
    assert ground.drives() == {REAL: STANDSTILL}
    seen = ground.observe()[REAL]
    assert (seen.incarnation, seen.pose, seen.twist) == (1, Pose(3.1, 5.0, 0.0), Twist(0.9, 0.0))


def test_its_laser_sees_the_real_room_and_simulated_robots_before_it() -> None:
    ground = world(at=measured(3.0, room=6.0), radius=0.2)
    scan = ground.observe()[REAL].scan
    assert scan[BEAMS // 2] == pytest.approx(6.0 - 3.0 - 0.2, abs=1e-5)
    assert scan[0] == scan[-1] == np.float32(6.0)
    step(ground, at=measured(3.0, room=1.0))
    assert (ground.observe()[REAL].scan == np.float32(1.0)).all()  # behind what is real


def test_beyond_the_range_of_its_laser_it_sees_nothing() -> None:
    ground = world(at=measured(3.0, heading=math.pi, room=40.0), laser_range=10.0)
    assert np.isposinf(ground.observe()[REAL].scan).all()


def test_a_blind_one_sees_nothing() -> None:
    ground = world(FaultSection(kind="blind", at_s=0.0, robots=(REAL,)))
    assert np.isposinf(ground.observe()[REAL].scan).all()


def test_the_others_see_it_where_it_is() -> None:
    ground = world(at=measured(9.0), radius=0.2)
    assert ground.observe()[NEAR].scan[BEAMS // 2] == pytest.approx(9.0 - 6.0 - 0.2, abs=1e-5)


def test_its_sensors_have_their_own_noise_and_no_other() -> None:
    ground = world(at=measured(3.0, heading=math.pi), pose_noise=0.1, laser_noise=0.1)
    seen = ground.observe()
    assert seen[REAL].pose == Pose(3.0, 5.0, math.pi)
    assert (seen[REAL].scan == np.float32(8.0)).all()
    assert seen[NEAR].pose != Pose(6.0, 5.0, 0.0)


def test_a_simulated_robot_stops_at_it() -> None:
    ground = world(at=measured(6.5), radius=0.2)
    step(ground, (NEAR, 3.0, 0.0))
    assert pose_of(ground, NEAR).x == pytest.approx(6.1, abs=1e-6)
    assert [(one.robot, one.other) for one in ground.truth().contacts] == [(NEAR, REAL)]


def test_one_that_comes_over_a_simulated_robot_has_one_contact_and_lets_it_go() -> None:
    ground = world(at=measured(5.5), radius=0.2)
    step(ground, at=measured(5.7))
    assert ground.truth().contacts == (Contact(REAL, NEAR, 5.85, 5.0),)
    step(ground, (NEAR, -1.0, 0.0))
    assert pose_of(ground, NEAR).x == pytest.approx(6.0, abs=1e-6)  # no deeper into it
    assert ground.truth().contacts == ()
    step(ground, (NEAR, 1.0, 0.0))
    assert pose_of(ground, NEAR).x == pytest.approx(6.05, abs=1e-6)


def test_walls_and_other_real_ones_are_no_contacts_of_its() -> None:
    ground = World(scenario(real=(NEAR, REAL)), load_map(ROOM, {}))
    ground.place({REAL: measured(3.0), NEAR: measured(6.0)})
    ground.observe()
    ground.advance({}, (), {REAL: measured(0.05), NEAR: measured(0.1)})
    assert ground.truth().contacts == ()


def test_its_body_stays_real_after_its_robot_has_left() -> None:
    ground = world(at=measured(3.0), radius=0.2)
    ground.fence(REAL, "its base is gone")
    step(ground, at=measured(9.0))
    assert [one.robot for one in ground.truth().present] == [NEAR, FAR]
    assert ground.observe()[NEAR].scan[BEAMS // 2] == pytest.approx(9.0 - 6.0 - 0.2, abs=1e-5)


@pytest.mark.parametrize(
    ("at", "why"),
    [
        (
            measured(0.1),
            r"robot 2 cannot start: \(0.1, 5.0\) is not 0.\d+ m clear of obstacles; the nea",
        ),
        (
            measured(20.5),
            r"robot 2 cannot start: \(20.5, 5.0\) is outside of the map; x from 0.00 to 20",
        ),
        (measured(6.1), r"robot 2 cannot start: its base at \(6.1, 5.0\) stands on robot 1; put either"),
    ],
)
def test_it_cannot_start_in_a_wall_or_on_another_robot(at: Measured, why: str) -> None:
    assert world().no_start() is None
    refusal = world(at=at).no_start()
    assert refusal is not None
    assert re.match(why, refusal)


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        (measured(25.0), "(25.00, 5.00) is outside of the map, x from 0.00 to 20.00 and y from 0.00 to"),
        (measured(math.nan), "pose.x is nan, not a number from -1"),
        (Measured(1, Pose(3.0, 5.0, 0.0), STANDSTILL, np.ones(90, dtype=np.float32)),
         "its scan has 90 ranges, the robot's laser 181"),
    ],
)  # fmt: skip
def test_what_no_base_can_have_measured_is_refused(wrong: Measured, why: str) -> None:
    bases = world().bases
    assert bases.refusal(REAL, measured(20.9)) is None  # localisation may be off by a little
    refusal = bases.refusal(REAL, wrong)
    assert refusal is not None
    assert refusal.startswith(why)


def test_nobody_can_put_it_elsewhere() -> None:
    order = FaultSection(kind="kidnap", at_s=None, robots=(REAL,), x=10.0, y=5.0)
    why = "robots: robot 2 has a real base, which nobody can put elsewhere; one of 1, 3"
    assert world().refusal(order) == why


@given(
    st.builds(
        Measured,
        st.integers(1, 2**53),
        st.builds(Pose, st.floats(-1.0, 21.0), st.floats(-1.0, 11.0), st.floats(-math.pi, math.pi)),
        st.builds(Twist, st.floats(-LARGEST, LARGEST), st.floats(-LARGEST, LARGEST)),
        st.sampled_from((0.0, 1e-30, 3.0, 1e30, math.inf)).map(
            lambda room: np.full(BEAMS, room, dtype=np.float32)
        ),
    )
)
@settings(max_examples=60, deadline=None)
def test_whatever_a_base_can_measure_the_world_goes_on(at: Measured) -> None:
    ground = world()
    assert ground.bases.refusal(REAL, at) is None
    for _ in range(3):
        step(ground, (NEAR, 1.0, 0.5), (REAL, 1.0, 0.0), at=at)
        seen = ground.observe()
        assert seen[REAL].pose == at.pose
        assert not np.isnan(seen[REAL].scan).any()
        others = [one.pose for one in ground.truth().present if one.robot != REAL]
        assert all(0.0 <= one.x <= 20.0 and 0.0 <= one.y <= 10.0 for one in others)
