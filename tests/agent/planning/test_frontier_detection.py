"""Where the seen borders on the unseen, whatever the laser."""

import math

import numpy as np
import pytest

from robot_agent.core.planning.frontier_detection import border
from tests.agent.planning.fields import box, field, look

BEAMS = pytest.mark.parametrize("beams", [90, 181, 361, 721])


@BEAMS
def test_the_edge_of_a_shadow_is_border_and_faces_into_the_shadow(beams: int) -> None:
    """Past the corner of a block at (14, 20), which hides what lies to the right of it."""
    view = look(field(box(14, 10, 16, 20), size=40.0), 10.0, 17.0, 0.3, beams)
    seen = border(view, 1.0, np.array((39.0, 39.0)), 0.0)
    along = math.atan2(3.0, 4.0)
    offset = seen.points - (14.0, 20.0)
    edge = np.hypot(*offset.T) < 4.0
    assert edge.sum() >= 3
    assert np.abs(0.8 * offset[edge, 1] - 0.6 * offset[edge, 0]).max() < 0.3
    assert np.abs(seen.outward[edge] - (along - math.pi / 2)).max() < 0.1


@BEAMS
def test_beside_a_wall_that_leaves_the_range_a_metre_is_border(beams: int) -> None:
    view = look(field(box(0, 22, 40, 23), size=40.0), 10.0, 20.0, 0.0, beams)
    seen = border(view, 1.0, np.array((39.0, 39.0)), 0.0)
    left = seen.points[seen.points[:, 1] > 20.0]
    assert 22.0 - left[:, 1].min() == pytest.approx(1.1, abs=0.35)


@BEAMS
def test_in_the_open_what_is_closer_to_the_goal_than_the_record_is_border(beams: int) -> None:
    """The goal lies ahead: of the ends of the beams, 10 m away, those within 24 m of it."""
    view = look(field(size=100.0), 50.0, 50.0, 0.0, beams)
    seen = border(view, 1.0, np.array((80.0, 50.0)), 24.0)
    assert np.hypot(*(seen.points - (80.0, 50.0)).T).max() < 24.0
    assert 20 <= len(seen.points) <= 34
    assert not len(border(view, 1.0, np.array((80.0, 50.0)), 19.0).points)
