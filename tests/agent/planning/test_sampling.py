"""Where the points of a road map come from."""

import math

import numpy as np
import pytest

from onehop.contracts.randomness import generator
from robot_agent.core.planning.sampling import (
    corner_samples,
    goal_sample,
    outline_end_samples,
    spread_draws,
)
from tests.agent.planning.fields import box, field, look

BLOCK = field(box(20, 10, 25, 30), size=40.0)


def test_spread_draws_leave_no_large_hole_and_follow_the_seed() -> None:
    """200 draws over 64 cells. Independent ones would leave 2.7 of them empty on average."""
    for seed in range(1, 51):
        draws = spread_draws(200, generator(seed, "test"))
        assert ((draws >= 0.0) & (draws < 1.0)).all()
        assert len(set(map(tuple, (draws * 8.0).astype(int).tolist()))) == 64
        assert (draws == spread_draws(200, generator(seed, "test"))).all()


def test_a_corner_in_view_has_a_point_beside_it_on_the_open_side() -> None:
    points = corner_samples(look(BLOCK, 14.0, 27.0, 0.3), 1.0, 0.8)
    away = np.hypot(*(points - (20.0, 30.0)).T)
    assert (np.abs(away - 0.8) < 0.15).any()
    beside = points[np.argmin(np.abs(away - 0.8))]
    assert beside[1] > 30.3


def test_the_point_towards_the_goal_is_as_far_as_the_view_allows() -> None:
    view = look(BLOCK, 14.0, 20.0, 0.0)
    assert goal_sample(view, np.array((35.0, 20.0)), 0.5)[0] == pytest.approx((19.5, 20.0), abs=0.01)
    behind = goal_sample(view, np.array((5.0, 20.0)), 0.5)
    assert behind.shape == (0, 2)
    far = goal_sample(look(BLOCK, 5.0, 35.0, 0.0), np.array((39.0, 35.0)), 0.5)[0]
    assert math.dist(far, (5.0, 35.0)) == pytest.approx(view.beams.range - 0.5)


@pytest.mark.parametrize("beams", [90, 181, 361, 721])
def test_where_a_wall_leaves_the_range_there_are_points_with_room_for_a_robot(beams: int) -> None:
    """Along a wall on the left to beyond the range of 10 m: up to a metre of the open beside its end,
    with as many points whatever the laser.
    """
    view = look(field(box(0, 22, 40, 23), size=40.0), 10.0, 20.0, 0.0, beams)
    points = outline_end_samples(view, 0.5)
    from_wall = 22.0 - points[points[:, 1] > 20.0][:, 1]
    assert from_wall.max() == pytest.approx(1.0, abs=0.2)
    assert 3 <= len(from_wall) <= 7
