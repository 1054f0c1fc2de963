"""Where the points of a road map come from."""

import math

import numpy as np
import pytest

from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose
from onehop.contracts.randomness import generator
from onehop.contracts.sections import RobotSection
from onehop.maps.map_file import load_map
from robot_agent.core.planning.sampling import corner_samples, goal_sample, spread_draws
from robot_agent.core.planning.view import View
from tests.agent.planning.fields import box, field
from world_server.core.laser import Laser

BODY = RobotSection()


def look(x: float, y: float, heading: float) -> View:
    """At a block from (20, 10) to (25, 30) in a field of 40 m."""
    walls = load_map(field(box(20, 10, 25, 30), size=40.0), {})
    scan = Laser(walls, BODY).scans(np.array([(x, y, heading)]), np.zeros(1, dtype=np.int32))[0]
    return View(Beams(BODY), Pose(x, y, heading), scan, 0.05)


def test_spread_draws_leave_no_large_hole_and_follow_the_seed() -> None:
    """200 draws over 64 cells. Independent ones would leave 2.7 of them empty on average."""
    for seed in range(1, 51):
        draws = spread_draws(200, generator(seed, "test"))
        assert ((draws >= 0.0) & (draws < 1.0)).all()
        assert len(set(map(tuple, (draws * 8.0).astype(int).tolist()))) == 64
        assert (draws == spread_draws(200, generator(seed, "test"))).all()


def test_a_corner_in_view_has_a_point_beside_it_on_the_open_side() -> None:
    points = corner_samples(look(14.0, 27.0, 0.3), 1.0, 0.8)
    away = np.hypot(*(points - (20.0, 30.0)).T)
    assert (np.abs(away - 0.8) < 0.15).any()
    beside = points[np.argmin(np.abs(away - 0.8))]
    assert beside[1] > 30.3


def test_the_point_towards_the_goal_is_as_far_as_the_view_allows() -> None:
    view = look(14.0, 20.0, 0.0)
    assert goal_sample(view, np.array((35.0, 20.0)), 0.5)[0] == pytest.approx((19.5, 20.0), abs=0.01)
    behind = goal_sample(view, np.array((5.0, 20.0)), 0.5)
    assert behind.shape == (0, 2)
    far = goal_sample(look(5.0, 35.0, 0.0), np.array((39.0, 35.0)), 0.5)[0]
    assert math.dist(far, (5.0, 35.0)) == pytest.approx(BODY.laser_range - 0.5)
