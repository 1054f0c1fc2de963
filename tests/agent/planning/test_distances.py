"""Distances in single precision, relative to their first point."""

import numpy as np
import pytest

from onehop.contracts.randomness import generator
from onehop.maps.walls import segment_distances
from robot_agent.core.planning.distances import squared_distances, squared_segment_distances


def test_single_precision_distances_agree_with_the_world() -> None:
    """Far from the origin of the map."""
    random = generator(3, "test")
    a, b, points = (random.uniform(200.0, 220.0, (40, 2)) for _ in range(3))
    exact = segment_distances(points, np.concatenate((a, b), axis=1)).T
    assert np.sqrt(squared_segment_distances(a, b, points)) == pytest.approx(exact, abs=1e-4)
    exact = np.hypot(*(a[:, None] - points).transpose(2, 0, 1))
    assert np.sqrt(squared_distances(a, points)) == pytest.approx(exact, abs=1e-4)
