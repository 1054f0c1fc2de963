"""The rolling disc: it draws the boundary of the grown obstacle, and passes only where it fits."""

import math

import numpy as np
import pytest

from onehop.contracts.arrays import FloatArray
from onehop.contracts.beams import Beams
from onehop.contracts.geometry import Pose
from onehop.contracts.sections import RobotSection
from robot_agent.core.planning.boundary import _pivot, settle, trace
from robot_agent.core.planning.view import View

BODY = RobotSection()
BEAMS = Beams(BODY)
NOTHING_SEEN = np.full(BODY.laser_beams, np.inf, dtype=np.float32)


def square(side: float, step: float = 0.05) -> FloatArray:
    s = np.arange(0.0, side, step)
    zero, full = np.zeros_like(s), np.full_like(s, side)
    edges = [(s, zero), (full, s), (side - s, full), (zero, side - s)]
    return np.concatenate([np.column_stack(edge) for edge in edges])


def once_around(points: FloatArray, start: FloatArray, radius: float, side: int) -> float:
    """Length of the disc's way until it is back where it began."""
    centre, contact = settle(points, start, radius)
    first, angle = centre, math.atan2(*(centre - points[contact])[::-1])
    before, length = contact, 0.0
    while length < 3.0 * radius or math.dist(centre, first) > 0.04:
        turn, following = _pivot(points, contact, before, angle, radius, side)
        angle += side * turn
        length += radius * turn
        centre = points[contact] + radius * np.array((math.cos(angle), math.sin(angle)))
        angle = math.atan2(*(centre - points[following])[::-1])
        before, contact = contact, following
        assert length < 100.0
    return length


@pytest.mark.parametrize("side", [1, -1])
def test_disc_rolls_once_around_a_square(side: int) -> None:
    """The boundary of a square grown by r has the length 4 a + 2 pi r."""
    length = once_around(square(4.0), np.array((2.0, -0.6)), 0.5, side)
    assert length == pytest.approx(16.0 + math.pi, rel=5e-3)


@pytest.mark.parametrize(("gap", "passes"), [(0.9, False), (1.1, True)])
def test_disc_passes_a_gap_only_if_it_fits(gap: float, passes: bool) -> None:
    """Two walls with a gap between: a disc of radius 0.5 rolls over it or around the end."""
    s = np.arange(0.0, 4.0, 0.05)
    walls = np.concatenate((np.column_stack((s, 0 * s)), np.column_stack((4.0 + gap + s, 0 * s))))
    view = View(BEAMS, Pose(2.0, -2.0, 0.0), NOTHING_SEEN, 0.05, walls)
    traced = trace(view, np.array((2.0, -0.5)), 0.5, 1, 10.0)
    assert (traced[:, 0].max() > 6.0) is not passes


def test_trace_stops_where_nothing_is_known() -> None:
    """Behind the robot and out of reach of its memory nothing is known to be free."""
    s = np.arange(-9.0, 9.0, 0.05)
    wall = np.column_stack((s, 0 * s))
    view = View(BEAMS, Pose(0.0, -0.5, 0.0), NOTHING_SEEN, 0.05, wall)
    assert trace(view, np.array((0.0, -0.5)), 0.5, 1, 10.0)[:, 0].max() > 8.0
    assert trace(view, np.array((0.0, -0.5)), 0.5, -1, 10.0)[:, 0].min() > -1.2
