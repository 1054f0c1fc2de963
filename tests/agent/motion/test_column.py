"""When a team drives in column: passages that are narrow for long enough, and back behind them."""

import math

import pytest

from onehop.contracts.sections import RobotSection, TeamSection
from robot_agent.core.motion.column import NARROW_AFTER, WIDEST_PASSAGE, ColumnWatch

SIX, TEAM = (1, 2, 3, 4, 5, 6), TeamSection()
PERIODS = pytest.mark.parametrize("period", [0.02, 0.05, 0.1])


def watch(columns, period, seconds, passage, column=False, members=SIX):
    """Let time pass; the column after each tick."""
    seen = []
    for _ in range(round(seconds / period)):
        column = columns.step(passage, members, column)
        seen.append(column)
    return seen


@PERIODS
def test_a_passage_makes_a_column_once_it_was_narrow_for_half_a_second(period):
    seen = watch(ColumnWatch(RobotSection(), TEAM, period), period, 1.0, 3.5)
    assert seen.index(True) * period == pytest.approx(NARROW_AFTER, abs=1.1 * period)
    assert all(seen[seen.index(True) :])


def test_one_look_past_a_corner_makes_no_column():
    columns = ColumnWatch(RobotSection(), TEAM, 0.05)
    for _ in range(5):
        assert not any(watch(columns, 0.05, 0.45, 3.5))
        assert not any(watch(columns, 0.05, 0.05, math.inf))


@pytest.mark.parametrize("passage", [0.3, WIDEST_PASSAGE, math.inf])
def test_what_nobody_fits_through_and_what_is_wide_make_no_column(passage):
    assert not any(watch(ColumnWatch(RobotSection(), TEAM, 0.05), 0.05, 3.0, passage))


@PERIODS
def test_the_shape_comes_back_when_the_last_of_the_column_is_through(period):
    """1.5 m a robot at 1 m/s: nine seconds for six."""
    columns = ColumnWatch(RobotSection(), TEAM, period)
    seen = watch(columns, period, 12.0, math.inf, column=True)
    assert seen.index(False) * period == pytest.approx(9.0, abs=2.0 * period)


def test_two_robots_are_no_column_of_a_passage():
    columns = ColumnWatch(RobotSection(), TEAM, 0.05)
    assert not any(watch(columns, 0.05, 2.0, 3.5, members=(1, 2)))
    assert columns.step(3.5, (1, 2), True) is False
