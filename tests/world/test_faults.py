"""Faults in the world: when they begin, whom they concern, what they do to actions and senses."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from onehop.contracts.errors import ScenarioError
from onehop.contracts.fault_section import FaultKind, FaultSection
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Note, Slow, Transmission
from tests.world.test_world import action, present, world
from world_server.core.faults import Faults
from world_server.core.world import World

GREETING = Transmission(0, b"hello", 60, 0)


def driving(ground: World, robot: int, *notes: Note, outbox: bool = False) -> None:
    """One tick in which a robot leads and drives ahead with 1 m/s."""
    one = action(1.0, outbox=(GREETING,) if outbox else (), notes=notes)
    status = replace(one.status, leader=robot)
    ground.advance({robot: replace(one, tick=ground.tick, status=status)})


def test_a_stopped_robot_sees_nothing_and_does_nothing_and_stays_where_it_is() -> None:
    ground = world(FaultSection("stop", 0.05, robots=(1,), duration_s=0.1))
    seen, x = [], []
    for _ in range(5):
        truth = ground.truth()
        seen.append((truth.stopped, 1 in ground.observe(), truth.present[0].robot))
        x.append(truth.present[0].pose.x)
        driving(ground, 1)
    running, stopped = ((), True, 1), ((1,), False, 1)
    assert seen == [running, stopped, stopped, running, running]
    assert x == pytest.approx([4.0, 4.05, 4.05, 4.05, 4.10])
    assert present(ground) == [1, 2, 3]


def test_a_robot_goes_on_by_order_alone_while_the_others_stay_stopped() -> None:
    ground = world(
        FaultSection("stop", 0.0, robots=(1, 2)),
        FaultSection("continue", 0.05, robots=(1,)),
        FaultSection("heal", 0.1),
    )
    stopped = []
    for _ in range(3):
        stopped.append(ground.truth().stopped)
        ground.advance({})
    assert stopped == [(1, 2), (2,), ()]


@pytest.mark.parametrize(("kind", "gone"), [("kill", [2, 3]), ("restart", [1, 2, 3])])
def test_a_new_process_is_not_stopped_any_more(kind: str, gone: list[int]) -> None:
    later = (FaultSection(kind, 0.05, robots=(1,)), FaultSection("restart", 0.1, robots=(1,)))  # type: ignore[arg-type]
    ground = world(FaultSection("stop", 0.0, robots=(1,)), *later)
    ground.advance({})
    assert present(ground) == gone
    assert ground.truth().stopped == ()
    ground.advance({})
    assert (present(ground), ground.truth().stopped) == ([1, 2, 3], ())


def test_a_kidnapped_robot_is_elsewhere_at_rest_and_knows_it() -> None:
    ground = world(FaultSection("kidnap", 0.05, robots=(1,), x=8.0, y=15.0, heading_deg=90.0))
    driving(ground, 1)
    one = ground.truth().present[0]
    assert (one.pose.x, one.pose.y) == (8.0, 15.0)
    assert one.pose.heading == pytest.approx(math.pi / 2)
    assert (one.twist.v, one.twist.w) == (0.0, 0.0)
    assert ground.observe()[1].pose == one.pose
    driving(ground, 1)
    assert ground.truth().contacts == ()
    assert ground.truth().present[0].pose.y == pytest.approx(15.05)


def test_a_robot_that_is_put_where_another_stands_comes_to_lie_beside_it() -> None:
    ground = world(FaultSection("kidnap", 0.0, robots=(1,), x=4.0, y=6.1))
    by_id = {one.robot: one.pose for one in ground.truth().present}
    apart = math.hypot(by_id[1].x - by_id[2].x, by_id[1].y - by_id[2].y)
    assert 0.4 < apart < 1.0
    ground.advance({})
    assert ground.truth().contacts == ()


@pytest.mark.parametrize(
    ("x", "y", "said"),
    [
        (500.0, 5.0, r"faults\[1\]\.x, faults\[1\]\.y: .* outside of the map.*nearest free point is"),
        (14.0, 10.0, r"faults\[1\]\.x, faults\[1\]\.y: .* not 0\.5 m clear.*nearest free point is"),
    ],
)
def test_a_kidnap_into_a_wall_or_off_the_map_is_refused_with_the_nearest_free_point(
    x: float, y: float, said: str
) -> None:
    with pytest.raises(ScenarioError, match=said):
        world(FaultSection("heal", 0.0), FaultSection("kidnap", 0.05, robots=(1,), x=x, y=y))


def test_a_blind_robot_sees_nothing_in_range_and_the_others_see_on() -> None:
    ground = world(FaultSection("blind", 0.0, robots=(2,), duration_s=0.05))
    seen = ground.observe()
    assert ground.truth().blind == (2,)
    assert np.all(np.isposinf(seen[2].scan))
    assert np.any(np.isfinite(seen[1].scan))
    ground.advance({})
    assert np.any(np.isfinite(ground.observe()[2].scan))


def test_what_a_slow_robot_does_takes_effect_late_and_all_at_once_when_it_has_caught_up() -> None:
    ground = world(FaultSection("slow", 0.05, robots=(1,), delay_ticks=2, duration_s=0.2))
    moves, sent = [], []
    for _ in range(7):
        driving(ground, 1, outbox=True)
        truth = ground.truth()
        moves.append(truth.present[0].twist.v)
        sent.append(sum(len(request.outbox) for request in truth.transmit_requests))
    assert moves == [1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]
    assert sent == [1, 0, 0, 1, 1, 3, 1]


def test_of_two_slow_faults_the_greater_delay_counts() -> None:
    ground = world(
        FaultSection("slow", 0.0, robots=(1, 2), delay_ticks=2),
        FaultSection("slow", 0.0, robots=(1,), delay_ticks=1),
        FaultSection("heal", 0.05, robots=(2,)),
    )
    assert ground.truth().slow == (Slow(1, 2), Slow(2, 2))
    ground.advance({})
    assert ground.truth().slow == (Slow(1, 2),)


@pytest.mark.parametrize(
    ("direction", "sides"),
    [
        ("both", ((1,), (2, 3), False)),
        ("from", ((1,), (2, 3), True)),
        ("to", ((2, 3), (1,), True)),
    ],
)
def test_a_cut_has_a_direction(direction: str, sides: tuple[object, ...]) -> None:
    (cut,) = world(FaultSection("cut", 0.0, robots=(1,), direction=direction)).truth().cuts  # type: ignore[arg-type]
    assert (cut.side_a, cut.side_b, cut.one_way) == sides


def test_a_corruption_without_robots_is_of_everybody() -> None:
    ground = world(
        FaultSection("corrupt", 0.0, probability=0.5), FaultSection("corrupt", 0.0, robots=(2,))
    )
    found = [(one.robots, one.probability) for one in ground.truth().corruptions]
    assert found == [((1, 2, 3), 0.5), ((2,), 1.0)]


def test_a_truth_tells_of_the_faults_that_begin_with_it_as_they_were_carried_out() -> None:
    ground = world(FaultSection("hold", 0.03, robots=(3, 1, 3), duration_s=1.0))
    assert ground.truth().faults == ()
    ground.advance({})
    assert ground.truth().faults == (FaultSection("hold", 0.05, robots=(1, 3), duration_s=1.0),)
    ground.advance({})
    assert ground.truth().faults == ()


def test_a_fault_by_hand_is_what_the_same_line_in_the_script_is() -> None:
    by_hand, scripted = world(), world(FaultSection("kill", 0.1, robots=(1,)))
    for ground, orders in ((by_hand, (FaultSection("kill", robots=(1,)),)), (scripted, ())):
        ground.advance({})
        ground.advance({}, orders)
    assert by_hand.truth() == scripted.truth()
    assert present(by_hand) == [2, 3]


def test_an_order_that_the_script_gives_as_well_counts_once() -> None:
    ground = world(FaultSection("kill", 0.05, robots=(1,)))
    ground.advance({}, [FaultSection("kill", 0.05, robots=(1,)), FaultSection("heal")])
    assert [fault.kind for fault in ground.truth().faults] == ["kill", "heal"]


def test_a_fault_follows_an_event_by_its_delay_and_concerns_who_did_it() -> None:
    ground = world(FaultSection("kill", on="narrow", nth=2, after_s=0.05))
    narrow = Note("narrow", {})
    driving(ground, 1, narrow)
    ground.advance({})
    driving(ground, 2, narrow)
    assert present(ground) == [1, 2, 3]
    ground.advance({})
    assert present(ground) == [1, 3]
    assert ground.truth().faults == (FaultSection("kill", 0.2, robots=(2,)),)


def test_a_new_process_is_not_slow_any_more() -> None:
    ground = world(
        FaultSection("slow", 0.0, robots=(1, 2), delay_ticks=9),
        FaultSection("restart", 0.05, robots=(1,)),
    )
    ground.advance({})
    assert ground.truth().slow == (Slow(2, 9),)


@pytest.mark.parametrize("kind", ["hold", "stop"])
def test_who_will_go_on_by_itself_rests_and_who_will_not_does_not(kind: FaultKind) -> None:
    faults = Faults((), (1, 2, 3))
    for one in (
        FaultSection(kind, 0.0, robots=(1, 2), duration_s=1.0), FaultSection(kind, 0.0, robots=(2, 3))
    ):  # fmt: skip
        faults.begin(one, 0)
    assert faults.resting == {1}


def test_faults_that_begin_together_do_so_in_the_order_of_the_script() -> None:
    ground = world(
        FaultSection("heal", on="narrow"), FaultSection("hold", 0.05, robots=(1,), duration_s=1.0)
    )
    driving(ground, 1, Note("narrow", {}))
    assert [fault.kind for fault in ground.truth().faults] == ["heal", "hold"]
    assert ground.truth().present[0].held


def test_a_robot_that_leads_again_after_its_restart_is_elected_again() -> None:
    ground = world(
        FaultSection("restart", 0.05, robots=(1,)), FaultSection("hold", on="leader elected", nth=2)
    )
    driving(ground, 1)
    leads = replace(action(incarnation=1), tick=ground.tick)
    ground.advance({1: replace(leads, status=replace(leads.status, leader=1))})
    assert ground.truth().present[0].held


def test_what_a_slow_robot_owes_when_it_is_stopped_comes_when_it_goes_on() -> None:
    ground = world(
        FaultSection("slow", 0.0, robots=(1,), delay_ticks=1),
        FaultSection("stop", 0.05, robots=(1,), duration_s=0.1),
    )
    moves = []
    driving(ground, 1)
    for _ in range(3):
        moves.append(ground.truth().present[0].twist.v)
        ground.advance({})
    assert [*moves, ground.truth().present[0].twist.v] == [0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("event", "note"),
    [
        ("formed", Note("mode", {"on": "formed"})),
        ("arrived", Note("arrived", {})),
        ("leader elected", Note("roster", {})),
    ],
)
def test_every_event_is_found(event: str, note: Note) -> None:
    ground = world(FaultSection("stop", on=event))  # type: ignore[arg-type]
    driving(ground, 1, note)
    assert ground.truth().stopped == (1,)


def test_a_robot_that_leads_on_is_elected_once() -> None:
    ground = world(FaultSection("kill", on="leader elected", nth=2))
    for _ in range(3):
        driving(ground, 1)
    assert present(ground) == [1, 2, 3]


def test_the_place_of_a_kidnap_is_a_pose_like_any_other() -> None:
    for degrees in (-360.0, -180.0, 180.0, 360.0):
        ground = world(FaultSection("kidnap", 0.0, robots=(1,), x=8.0, y=15.0, heading_deg=degrees))
        pose: Pose = ground.truth().present[0].pose
        assert -math.pi < pose.heading <= math.pi
