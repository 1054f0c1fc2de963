"""When a Next is due, and what a silent leader leaves."""

from onehop.contracts.geometry import Pose
from robot_agent.core.team.leader_view import TRAIL_POINTS, LeaderView

SECOND = 1_000_000_000
TICK = SECOND // 4
HERE = Pose(1.0, 2.0, 0.0)


def missed(view: LeaderView, first: int, last: int) -> list[float]:
    """Times of the ticks at which a Next is missed [s]."""
    return [tick / 4 for tick in range(4 * first, 4 * last) if view.misses_next(tick * TICK)]


def test_each_missing_next_is_told_once_a_period_after_its_grace() -> None:
    assert missed(LeaderView(0, 2 * SECOND), 0, 8) == [2.75, 4.75, 6.75]


def test_a_next_that_comes_late_begins_a_new_period() -> None:
    view = LeaderView(0, 2 * SECOND)
    assert missed(view, 0, 4) == [2.75]
    view.on_next(4 * SECOND, HERE, ())
    assert missed(view, 4, 8) == [6.75]


def test_poses_make_a_trail_where_the_leader_tells_none() -> None:
    view = LeaderView(0, 2 * SECOND)
    for n in range(2 * TRAIL_POINTS):
        view.on_next(n * SECOND, Pose(float(n), 0.0, 0.0), ())
    assert view.trail == tuple((float(n), 0.0) for n in range(TRAIL_POINTS, 2 * TRAIL_POINTS))
    view.on_next(99 * SECOND, HERE, ((5.0, 5.0),))
    assert view.trail == ((5.0, 5.0),)


def test_who_awaits_another_leader_forgets_the_way_and_lane_of_the_old_one() -> None:
    view = LeaderView(0, 2 * SECOND)
    view.on_word(SECOND, HERE)
    view.on_next(SECOND, HERE, ((5.0, 5.0),))
    view.lane = ((0.0, 0.0), (4.0, 0.0))
    view.await_other(3 * SECOND)
    assert (view.trail, view.lane, view.pose) == ((), (), HERE)
    assert not view.is_overdue(5 * SECOND)


def test_silence_at_the_slot_counts_from_the_last_word_or_the_arrival_less_the_grace() -> None:
    view = LeaderView(0, 2 * SECOND)
    view.on_word(4 * SECOND, HERE)
    view.stands(5 * SECOND, False)
    assert view.silent_at_slot_ns(20 * SECOND) == 0
    view.stands(6 * SECOND, True)
    view.stands(7 * SECOND, True)
    assert view.silent_at_slot_ns(9 * SECOND) == 5 * SECOND // 2
    view.on_word(8 * SECOND, HERE)
    assert view.silent_at_slot_ns(9 * SECOND) == SECOND // 2
    view.stands(9 * SECOND, False)
    assert view.silent_at_slot_ns(20 * SECOND) == 0
