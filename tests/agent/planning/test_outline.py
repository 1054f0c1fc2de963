"""The outline through hits: even along walls, closed where they are grazed, open where a robot fits."""

import math

import numpy as np
import pytest

from robot_agent.core.planning.outline import outline
from tests.agent.planning.fields import box, field, look

GRAIN = 0.05


def widest_gap(points: np.ndarray) -> float:
    """Between neighbours along x [m]."""
    return float(np.diff(np.sort(points[:, 0])).max())


def test_dense_hits_are_thinned_to_the_grain() -> None:
    hits = np.column_stack((np.arange(0.0, 5.0, 0.004), np.zeros(1250)))
    thin = outline(hits, GRAIN, 0.001)
    assert 90 < len(thin) < 110
    assert widest_gap(thin) < 1.1 * GRAIN


@pytest.mark.parametrize("beams", [46, 90, 181, 361, 721])
def test_a_wall_that_the_beams_graze_is_closed_whatever_their_spacing(beams: int) -> None:
    """Seen from 0.9 m beside it, to where the beams meet it at 5.7 degrees: hits of a coarse laser are
    metres apart there, and each gap is wider than the one before.
    """
    view = look(field(box(0, 21, 40, 22), size=40.0), 8.0, 20.1, 0.0, beams)
    wall = view.obstacles[(view.obstacles[:, 1] > 20.5) & (view.obstacles[:, 0] > 8.0)]
    assert wall[:, 0].max() > 14.0
    assert widest_gap(wall) < 0.5


@pytest.mark.parametrize("beams", [90, 181, 721])
def test_a_door_stays_open(beams: int) -> None:
    """1.2 m wide, seen from 4 m at 45 degrees."""
    wall = field(box(0, 24, 20, 25), box(21.2, 24, 40, 25), size=40.0)
    points = look(wall, 17.8, 21.2, math.pi / 4, beams).obstacles
    near = points[np.abs(points[:, 1] - 24.0) < 0.01]
    assert not ((near[:, 0] > 20.05) & (near[:, 0] < 21.15)).any()


def test_few_hits_are_left_alone() -> None:
    hits = np.array(((0.0, 0.0), (3.0, 0.0)))
    assert outline(hits, GRAIN, 0.02).tolist() == hits.tolist()
