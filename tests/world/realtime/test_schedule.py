"""When ticks are due, which of them are late, and what becomes of the schedule."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from world_server.realtime.schedule import LATE_SHARE, Schedule

PERIOD_S = 0.05


def test_a_late_tick_makes_no_later_one_late() -> None:
    schedule = Schedule(PERIOD_S, 1.0, start_s=100.0)
    assert schedule.begin(1, 100.05) is None
    assert schedule.begin(2, 100.13) == pytest.approx(0.03)
    assert schedule.due_s(3) == pytest.approx(100.15)
    assert (schedule.late_ticks, schedule.anchor) == (1, 0)
    assert schedule.latest_s == pytest.approx(0.03)


def test_a_tick_is_late_after_a_fifth_of_its_length() -> None:
    schedule = Schedule(PERIOD_S, 1.0)
    assert schedule.begin(1, PERIOD_S + 0.99 * LATE_SHARE * PERIOD_S) is None
    assert schedule.begin(2, 2 * PERIOD_S + 1.01 * LATE_SHARE * PERIOD_S) is not None


def test_more_than_a_period_moves_the_schedule_and_sets_the_clock_back() -> None:
    schedule = Schedule(PERIOD_S, 2.0, start_s=10.0)
    assert schedule.begin(4, 10.5) == pytest.approx(0.3)
    assert (schedule.anchor, schedule.moved_s) == (1, pytest.approx(0.3))
    assert schedule.due_s(5) == pytest.approx(10.55)
    assert schedule.clock_ns(10.5) == pytest.approx(4 * PERIOD_S * 2.0 * 1e9)


@given(
    delays=st.lists(st.floats(0.0, 0.3), min_size=1, max_size=30), speed=st.sampled_from([0.5, 1.0, 4.0])
)
def test_no_simulated_time_is_left_out_and_every_tick_lasts_at_least_most_of_a_period(
    delays: list[float], speed: float
) -> None:
    """Whatever the delays: the clock never runs ahead of the ticks by more than one that is late."""
    schedule = Schedule(PERIOD_S / speed, speed)
    now_s, lateness = 0.0, []
    for tick, delay_s in enumerate(delays, 1):
        now_s = max(now_s, schedule.due_s(tick)) + delay_s
        late_s = schedule.begin(tick, now_s)
        lateness.append(late_s)
        simulated_s = schedule.clock_ns(now_s) / 1e9
        assert tick * PERIOD_S - 1e-6 <= simulated_s <= (tick + 1) * PERIOD_S + 1e-6
    assert schedule.late_ticks == sum(one is not None for one in lateness)
    assert schedule.latest_s >= max(one or 0.0 for one in lateness)
