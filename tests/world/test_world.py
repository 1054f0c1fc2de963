"""The world tick by tick: who is present, what robots want sent, what faults do, what stays the same."""

import math

import numpy as np
import pytest

from onehop.contracts.fault_section import FaultSection
from onehop.contracts.geometry import Twist
from onehop.contracts.messages import Action, Contact, Departure, Note, Transmission
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (  # fmt: skip
    ClockSection,
    GoalSection,
    MapSection,
    StartSection,
    TeamSection,
)
from onehop.contracts.team import Mode, Shape, Status
from onehop.maps.map_file import load_map
from world_server.core.world import World

BLOCK = ((14.0, 4.0), (16.0, 4.0), (16.0, 16.0), (14.0, 16.0))
YARD = MapSection(width=40.0, height=20.0, obstacles=(BLOCK,))
THREE = ((4.0, 10.0, 0.0), (4.0, 6.0, 0.0), (4.0, 14.0, 0.0))


def scenario(
    *faults: FaultSection, poses: tuple[tuple[float, float, float], ...] = THREE, limit_s: float = 60.0
) -> Scenario:
    return Scenario(
        name="yard",
        goal=GoalSection(35.0, 10.0),
        map=YARD,
        start=StartSection(poses=poses),
        team=TeamSection(size=len(poses)),
        clock=ClockSection(limit_s=limit_s),
        faults=faults,
    )


def world(*faults: FaultSection, poses: tuple[tuple[float, float, float], ...] = THREE) -> World:
    return World(scenario(*faults, poses=poses), load_map(YARD, {}))


def action(
    v: float = 0.0, w: float = 0.0, incarnation: int = 0, outbox: tuple[Transmission, ...] = (),
    notes: tuple[Note, ...] = (),
) -> Action:  # fmt: skip
    status = Status(Mode.FOLLOWING, 1, 2, (1, 2, 3), Shape.WEDGE, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    return Action(0, incarnation, Twist(v, w), outbox, abs(v), 5.0, status, notes)


def run(ground: World, ticks: int, v: float = 0.0) -> None:
    for _ in range(ticks):
        ground.truth()
        ground.advance(dict.fromkeys(ground.observe(), action(v)))


def present(ground: World) -> list[int]:
    return [one.robot for one in ground.truth().present]


def test_the_first_truth_shows_the_start() -> None:
    truth = world().truth()
    assert (truth.tick, truth.time_ns) == (0, 0)
    assert [(one.robot, one.pose.x, one.pose.y, one.incarnation) for one in truth.present] == [
        (1, 4.0, 10.0, 0),
        (2, 4.0, 6.0, 0),
        (3, 4.0, 14.0, 0),
    ]
    assert (
        truth.transmit_requests == truth.contacts == truth.departures == truth.cuts == truth.jams == ()
    )


def test_a_tick_moves_robots_by_their_commands() -> None:
    ground = world()
    ground.advance({1: action(2.0), 2: action(-1.0), 3: action(0.0, 1.0)})
    truth = ground.truth()
    assert (truth.tick, truth.time_ns) == (1, 50_000_000)
    x = [one.pose.x for one in truth.present]
    assert x == pytest.approx([4.1, 3.95, 4.0])
    assert [one.twist for one in truth.present] == [Twist(2.0, 0.0), Twist(-1.0, 0.0), Twist(0.0, 1.0)]
    assert truth.present[2].pose.heading == pytest.approx(0.05)


def test_motors_give_no_more_than_they_can() -> None:
    ground = world()
    ground.advance({1: action(100.0, -100.0)})
    assert ground.truth().present[0].twist == Twist(3.0, -3.0)


def test_a_twist_that_is_no_number_is_a_crash() -> None:
    with pytest.raises(ValueError, match="robot 2 commands the twist"):
        world().advance({2: action(math.nan)})


def test_a_robot_without_an_action_stands_still_and_offers_nothing() -> None:
    ground = world()
    ground.advance({1: action(1.0)})
    ground.advance({2: action(1.0)})
    truth = ground.truth()
    assert truth.present[0].twist == Twist(0.0, 0.0)
    assert [request.robot for request in truth.transmit_requests] == [2]


def test_observations_are_what_truth_says_and_scans_cannot_be_written() -> None:
    ground = world()
    run(ground, 3, 1.0)
    truth, seen = ground.truth(), ground.observe()
    assert list(seen) == [1, 2, 3]
    for one in truth.present:
        observation = seen[one.robot]
        assert (observation.pose, observation.twist) == (one.pose, one.twist)
        assert (observation.tick, observation.time_ns) == (3, 150_000_000)
        with pytest.raises(ValueError, match="read-only"):
            observation.scan[0] = 0.0
    assert seen[1].scan[90] == pytest.approx(14.0 - 4.15)
    assert seen[1].scan[0] == pytest.approx(4.0 - 0.2)


def test_what_was_offered_comes_with_the_next_truth_only() -> None:
    ground = world()
    frame = Transmission(2, b"hello", 800, 0)
    ground.advance({1: action(outbox=(frame,)), 2: action()})
    requests = ground.truth().transmit_requests
    assert [(one.robot, one.outbox, one.remaining_distance) for one in requests] == [
        (1, (frame,), 5.0),
        (2, (), 5.0),
    ]
    ground.advance({})
    assert ground.truth().transmit_requests == ()


def test_truth_is_the_same_until_the_next_tick() -> None:
    ground = world()
    before = ground.truth()
    ground.fence(2, "silent")
    assert ground.truth() is before
    ground.advance({})
    assert present(ground) == [1, 3]


def test_a_fenced_robot_departs_once_and_its_last_words_are_not_offered() -> None:
    ground = world()
    ground.truth()
    ground.fence(2, "its process died")
    ground.fence(2, "again")
    ground.advance({1: action(), 2: action(3.0), 3: action()})
    truth = ground.truth()
    assert truth.departures == (Departure(2, "its process died"),)
    assert [request.robot for request in truth.transmit_requests] == [1, 3]
    assert list(ground.observe()) == [1, 3]
    ground.advance({})
    assert ground.truth().departures == ()


def test_the_body_of_a_dead_robot_stays_in_the_way() -> None:
    ground = world(poses=((4.0, 10.0, 0.0), (6.0, 10.0, 0.0)))
    ground.fence(2, "died")
    assert ground.observe()[1].scan[90] == pytest.approx(1.8)
    for _ in range(60):
        ground.advance({1: action(1.0)})
    assert ground.truth().present[0].pose.x == pytest.approx(5.6, abs=1e-6)


def test_an_admitted_robot_wakes_up_in_its_body_as_a_new_incarnation() -> None:
    ground = world()
    run(ground, 10, 1.0)
    ground.fence(2, "died")
    run(ground, 10, 1.0)
    ground.admit(2)
    ground.truth()
    woken = ground.truth().present[1]
    assert (woken.robot, woken.incarnation) == (2, 1)
    assert woken.pose.x == pytest.approx(4.5)
    assert ground.observe()[2].incarnation == 1
    ground.advance({2: action(1.0, incarnation=0)})
    assert ground.truth().present[1].twist == Twist(0.0, 0.0)
    ground.advance({2: action(1.0, incarnation=1)})
    assert ground.truth().present[1].twist == Twist(1.0, 0.0)


def test_what_a_robot_offered_before_it_was_restarted_is_lost() -> None:
    ground = world()
    ground.advance({1: action(1.0), 2: action(1.0)})
    ground.fence(2, "died")
    ground.admit(2)
    truth = ground.truth()
    assert [request.robot for request in truth.transmit_requests] == [1]
    assert (truth.present[1].robot, truth.present[1].twist) == (2, Twist(0.0, 0.0))


def test_a_scripted_kill_shows_in_the_first_tick_at_or_after_its_time() -> None:
    ground = world(FaultSection("kill", at_s=0.12, robots=(3, 1)))
    for tick in range(3):
        assert ground.truth().faults == ()
        assert present(ground) == [1, 2, 3], tick
        ground.advance({})
    assert [fault.kind for fault in ground.truth().faults] == ["kill"]
    assert present(ground) == [2]
    assert ground.truth().departures == (
        Departure(1, "killed by a fault"),
        Departure(3, "killed by a fault"),
    )
    ground.advance({})
    assert ground.truth().faults == ()


def test_a_fault_at_zero_is_in_the_first_truth() -> None:
    assert present(world(FaultSection("kill", at_s=0.0, robots=(1,)))) == [2, 3]


def test_a_scripted_restart_readmits_or_replaces() -> None:
    ground = world(
        FaultSection("restart", at_s=0.1, robots=(1, 2)), FaultSection("kill", at_s=0.05, robots=(2,))
    )
    ground.advance({})
    assert present(ground) == [1, 3]
    ground.advance({})
    truth = ground.truth()
    assert [(one.robot, one.incarnation) for one in truth.present] == [(1, 1), (2, 1), (3, 0)]
    assert truth.departures == (Departure(1, "restarted by a fault"),)


def test_a_held_robot_does_not_move_and_is_shown_as_held() -> None:
    ground = world(FaultSection("hold", at_s=0.05, robots=(1,), duration_s=0.1))
    x, held = [], []
    for _ in range(5):
        x.append(ground.truth().present[0].pose.x)
        held.append(ground.truth().present[0].held)
        ground.advance({1: action(2.0)})
    assert held == [False, True, True, False, False]
    assert x == pytest.approx([4.0, 4.1, 4.1, 4.1, 4.2])


def test_a_cut_without_others_separates_from_all_the_rest() -> None:
    ground = world(FaultSection("cut", at_s=0.0, robots=(3,), duration_s=0.1))
    cuts = []
    for _ in range(3):
        cuts.append([(cut.side_a, cut.side_b) for cut in ground.truth().cuts])
        ground.advance({})
    assert cuts == [[((3,), (1, 2))], [((3,), (1, 2))], []]


def test_a_fault_without_duration_lasts_until_it_is_healed() -> None:
    ground = world(
        FaultSection("jam", at_s=0.0, x=1.0, y=2.0, radius=3.0, noise_dbm=-50.0),
        FaultSection("cut", at_s=0.0, robots=(1,), others=(2,)),
        FaultSection("hold", at_s=0.0, robots=(3,)),
        FaultSection("heal", at_s=0.1, robots=(3,)),
        FaultSection("heal", at_s=0.15),
    )
    force = []
    for _ in range(4):
        truth = ground.truth()
        force.append((len(truth.jams), len(truth.cuts), truth.present[2].held))
        ground.advance({})
    assert force == [(1, 1, True), (1, 1, True), (1, 1, False), (0, 0, False)]


def test_a_fault_begins_with_the_first_truth_at_its_time_or_after() -> None:
    ground = world(
        FaultSection("hold", at_s=0.19, robots=(1,), duration_s=0.05),
        FaultSection("kill", at_s=0.2, robots=(2,)),
    )
    run(ground, 3)
    assert not ground.truth().present[0].held
    run(ground, 1)
    assert ground.truth().present[0].held
    assert present(ground) == [1, 3]
    ground.advance({})
    assert not ground.truth().present[0].held


def test_a_contact_is_reported_in_the_tick_of_its_onset() -> None:
    ground = world(poses=((13.4, 10.0, 0.0),))
    contacts = []
    for v in (3.0, 3.0, 3.0, 3.0, 3.0, -1.0, 0.2, 3.0):
        ground.advance({1: action(v)})
        contacts.append(ground.truth().contacts)
    onset = Contact(1, 0, pytest.approx(13.8, abs=1e-6), 10.0)
    assert contacts == [(), (), (onset,), (), (), (), (), (onset,)]


def test_two_robots_that_meet_are_one_contact() -> None:
    ground = world(poses=((4.0, 10.0, 0.0), (5.0, 10.0, 180.0)))
    run(ground, 30, 1.0)
    assert ground.aborted("enough").collisions == 1


def test_same_scenario_and_seed_give_the_same_world() -> None:
    random = Scenario(
        name="r", goal=GoalSection(35.0, 10.0), map=YARD, start=StartSection(5.0, 10.0), seed=7
    )
    one, other = (World(random, load_map(YARD, {})) for _ in range(2))
    for ground in (one, other):
        for tick in range(200):
            ground.truth()
            ground.observe()
            ground.advance({i: action(1.5 - 0.3 * i, math.sin(tick + i)) for i in range(1, 7)})
    assert one.truth() == other.truth()
    for robot, observation in one.observe().items():
        np.testing.assert_array_equal(observation.scan, other.observe()[robot].scan)


def test_the_order_of_actions_does_not_matter() -> None:
    one, other = world(), world()
    for tick in range(50):
        actions = {i: action(1.0 + 0.1 * i, math.cos(tick * i)) for i in (1, 2, 3)}
        one.advance(actions)
        other.advance(dict(reversed(actions.items())))
    assert one.truth() == other.truth()


def test_the_mission_ends_by_the_referee() -> None:
    ground = World(scenario(limit_s=0.2), load_map(YARD, {}))
    run(ground, 3)
    assert ground.outcome() is None
    run(ground, 1)
    outcome = ground.outcome()
    assert outcome is not None
    assert (outcome.outcome, outcome.reason, outcome.ticks) == ("failed", "time limit of 0.2 s", 4)
