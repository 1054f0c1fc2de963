"""Polygon maps and the questions that a map answers."""

import math
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from onehop.contracts.sections import MapSection
from onehop.maps.grid import GridFrame, grid_map
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap, gap_between, segment_distances

SQUARE = ((4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0))


@pytest.fixture(scope="module")
def square_in_a_yard() -> WallMap:
    return load_map(MapSection(width=10.0, height=8.0, obstacles=(SQUARE,)), {})


def test_a_polygon_map_has_a_wall_around_it(square_in_a_yard: WallMap) -> None:
    assert square_in_a_yard.bounds == (0.0, 0.0, 10.0, 8.0)
    assert square_in_a_yard.segments.shape == (8, 4)
    assert square_in_a_yard.clearance(np.array([[1.0, 2.0]]))[0] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("x", "y", "free"),
    [(5.0, 5.0, False), (3.9, 5.0, True), (4.0, 5.0, False), (-0.1, 5.0, False), (5.0, 8.1, False)],
)
def test_obstacles_are_filled_and_the_outside_is_not_free(
    square_in_a_yard: WallMap, x: float, y: float, free: bool
) -> None:
    assert square_in_a_yard.is_free(x, y) is free


def test_a_disc_that_only_touches_fits(square_in_a_yard: WallMap) -> None:
    assert square_in_a_yard.is_free(3.5, 5.0, 0.5)
    assert not square_in_a_yard.is_free(3.5 + 1e-9, 5.0, 0.5)


def test_the_corner_of_an_obstacle_is_round_for_a_disc(square_in_a_yard: WallMap) -> None:
    apart = 0.5 * math.sqrt(0.5)
    assert square_in_a_yard.is_free(4.0 - apart - 1e-6, 4.0 - apart - 1e-6, 0.5)
    assert not square_in_a_yard.is_free(4.0 - apart + 1e-6, 4.0 - apart + 1e-6, 0.5)


def test_a_hollow_obstacle_is_free_inside() -> None:
    ring = ((1, 1), (9, 1), (9, 9), (1, 9), (1, 1), (3, 3), (3, 7), (7, 7), (7, 3), (3, 3))
    obstacle = tuple((float(x), float(y)) for x, y in ring)
    walls = load_map(MapSection(width=10.0, height=10.0, obstacles=(obstacle,)), {})
    assert walls.is_free(5.0, 5.0)
    assert not walls.is_free(2.0, 5.0)


def test_nearest_free_point_is_near_and_free(square_in_a_yard: WallMap) -> None:
    near = square_in_a_yard.nearest_free(5.0, 5.9, 0.5)
    assert near is not None
    assert square_in_a_yard.is_free(*near, 0.5)
    assert math.dist(near, (5.0, 5.9)) <= 0.6 + 0.1


@settings(max_examples=50, deadline=None)
@given(
    filled=arrays(np.bool_, st.tuples(st.integers(1, 8), st.integers(1, 8))),
    place=st.tuples(st.integers(0, 799), st.integers(0, 799)),
    radius=st.floats(0.01, 3.0),
)
def test_a_point_with_room_is_its_own_nearest_free_point(
    filled: np.ndarray[tuple[int, int], np.dtype[np.bool_]], place: tuple[int, int], radius: float
) -> None:
    """Nothing that fits is passed over by looking at a few places in the disc first."""
    walls = grid_map(filled, GridFrame(0.0, 0.0, 0.0, 1.0))
    x, y = place[0] / 100.0, place[1] / 100.0
    near = walls.nearest_free(x, y, radius)
    assert near is None or walls.is_free(*near, radius)
    assert (near == (x, y)) is walls.is_free(x, y, radius)


def test_a_map_of_noise_is_searched_within_seconds() -> None:
    """600,000 walls, and no place for the disc."""
    noise = np.random.default_rng(0).random((1100, 1100)) < 0.5
    walls = grid_map(noise, GridFrame(0.0, 0.0, 0.0, 0.05))
    began = time.process_time()
    assert walls.nearest_free(20.0, 20.0, 0.5) is None
    assert time.process_time() - began < 20.0


def test_a_map_without_room_has_no_nearest_free_point(square_in_a_yard: WallMap) -> None:
    assert square_in_a_yard.nearest_free(5.0, 5.0, 4.1) is None


def test_sight_is_blocked_by_a_wall_and_by_too_narrow_a_gap(square_in_a_yard: WallMap) -> None:
    assert square_in_a_yard.sees(1.0, 3.0, 9.0, 3.0, 0.9)
    assert not square_in_a_yard.sees(1.0, 3.0, 9.0, 3.0, 1.1)
    assert not square_in_a_yard.sees(1.0, 5.0, 9.0, 5.0, 0.1)


coordinate = st.floats(-20.0, 20.0, allow_nan=False)


@given(st.lists(coordinate, min_size=6, max_size=6))
def test_distance_to_a_segment_is_that_to_its_nearest_point(numbers: list[float]) -> None:
    x, y, x0, y0, x1, y1 = numbers
    share = np.linspace(0.0, 1.0, 2001)
    sampled = np.hypot(x - x0 - share * (x1 - x0), y - y0 - share * (y1 - y0)).min()
    distance = segment_distances(np.array([[x, y]]), np.array([[x0, y0, x1, y1]]))[0, 0]
    assert distance <= sampled + 1e-9
    assert sampled - distance <= math.hypot(x1 - x0, y1 - y0) / 4000.0 + 1e-9


def test_crossing_segments_have_no_gap() -> None:
    assert gap_between(np.array([0.0, 0.0, 4.0, 4.0]), np.array([[0.0, 4.0, 4.0, 0.0]])) == 0.0
    assert gap_between(np.array([0.0, 0.0, 4.0, 0.0]), np.array([[5.0, 3.0, 5.0, 9.0]])) == (
        pytest.approx(math.hypot(1.0, 3.0))
    )
    assert gap_between(np.array([0.0, 0.0, 1.0, 0.0]), np.empty((0, 4))) == math.inf
