"""How wide the passage before the robot is."""

import math

import numpy as np
import pytest

from robot_agent.core.planning.passage import passage_width
from robot_agent.core.planning.view import NO_POINTS
from tests.agent.planning.fields import box, field, look


@pytest.mark.parametrize("beams", [90, 181, 721])
def test_passage_width_is_the_free_width_between_both_walls(beams: int) -> None:
    corridor = field(box(0, 0, 30, 13), box(0, 16, 12, 30), box(12, 15.5, 30, 30), size=30.0)
    tight, wide = look(corridor, 10.0, 14.4, 0.0, beams), look(corridor, 5.0, 14.4, 0.0, beams)
    assert passage_width(tight, NO_POINTS, 4.0) == pytest.approx(2.5, abs=0.05)
    assert passage_width(wide, NO_POINTS, 4.0) == pytest.approx(3.0, abs=0.05)
    assert passage_width(look(field(size=60.0), 30.0, 30.0, 0.0), NO_POINTS, 4.0) == math.inf


def test_passage_width_is_measured_along_a_way_that_bends() -> None:
    """The robot comes along a wall and turns into a door of 3 m."""
    wall = field(box(14, 0, 16, 15), box(14, 18, 16, 30), size=30.0)
    view = look(wall, 12.0, 13.0, math.pi / 2)
    way = np.array(((12.0, 13.0), (12.2, 15.5), (14.0, 16.5), (18.0, 16.5)))
    assert passage_width(view, NO_POINTS, 4.0) == math.inf
    assert passage_width(view, way, 6.0) == pytest.approx(3.0, abs=0.1)
