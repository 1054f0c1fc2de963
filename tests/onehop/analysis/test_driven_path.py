"""What a leader drove, as a path for a scenario."""

import tomllib
from itertools import pairwise

import numpy as np
import pytest

from onehop.analysis.driven_path import in_toml, saved_path
from onehop.contracts.errors import InputError
from onehop.maps.map_file import load_map
from tests.agent.planning.fields import box, field

OPEN = load_map(field(size=40.0), {})
BLOCK = load_map(field(box(10, 0, 14, 12), size=40.0), {})


def track(*corners: tuple[float, float]) -> np.ndarray:
    """A pose every 5 cm along these corners."""
    pieces = []
    for start, end in pairwise(corners):
        a, b = np.array(start), np.array(end)
        count = round(float(np.hypot(*(b - a))) / 0.05)
        pieces.append(a + (b - a) * (np.arange(count) / count)[:, None])
    return np.concatenate([*pieces, [corners[-1]]])


def test_a_straight_way_is_two_points_and_ends_at_the_goal() -> None:
    assert saved_path(track((5.0, 5.0), (29.7, 5.0)), (30.0, 5.0), OPEN, 0.5) == (
        (5.0, 5.0),
        (30.0, 5.0),
    )


def test_corners_stay_beside_what_was_driven_and_clear_of_walls() -> None:
    driven = track((5.0, 5.0), (5.0, 12.6), (20.0, 12.6), (30.0, 5.0))
    path = saved_path(driven, (30.0, 5.0), BLOCK, 0.5)
    assert len(path) <= 8
    for here, there in pairwise(path):
        assert BLOCK.sees(*here, *there, 0.5)
        middle = np.array(here) + 0.5 * (np.array(there) - np.array(here))
        assert np.hypot(*(driven - middle).T).min() < 0.25


def test_a_loop_is_left_out() -> None:
    loop = ((20.0, 5.0), (20.0, 20.0), (30.0, 20.0), (30.0, 10.0), (20.0, 5.1), (35.0, 5.0))
    path = saved_path(track((5.0, 5.0), *loop), (35.0, 5.0), OPEN, 0.5)
    assert max(y for _, y in path) < 6.0


def test_what_came_too_close_to_a_wall_is_refused() -> None:
    with pytest.raises(InputError, match="too close to a wall; another --seed"):
        saved_path(track((5.0, 12.3), (30.0, 12.3)), (30.0, 12.3), BLOCK, 0.5)


def test_the_section_is_toml_that_a_scenario_can_have() -> None:
    planner = tomllib.loads(in_toml(((5.0, 5.25), (30.0, 5.0)), "By hand."))["planner"]
    assert planner == {"kind": "path", "path": [[5, 5.25], [30, 5]]}
