"""Algorithm 2's cases (thesis 3.4.1): which obstacle it is, and where the fan turns."""

import math

import pytest

from onehop.contracts.sections import Point
from robot_agent.core.planning.obstacle import TURNS, Obstacle, classify, fan_direction
from tests.agent.planning.fields import box, field, look

AHEAD, LEFT, RIGHT = box(17, 14, 18, 16), box(10, 17, 30, 18), box(10, 12, 30, 13)


@pytest.mark.parametrize(
    ("walls", "case"),
    [
        ((), Obstacle.NONE),
        ((AHEAD,), Obstacle.FRONT),
        ((LEFT,), Obstacle.LEFT),
        ((RIGHT,), Obstacle.RIGHT),
        ((LEFT, RIGHT), Obstacle.BOTH),
        ((box(17, 10, 18, 17), box(10, 16, 17, 17)), Obstacle.LEFT_CORNER),
        ((box(17, 13, 18, 20), box(10, 13, 17, 14)), Obstacle.RIGHT_CORNER),
    ],
)
def test_cases_of_algorithm_2(walls: tuple[tuple[Point, ...], ...], case: Obstacle) -> None:
    assert classify(look(field(*walls, size=40.0), 15.0, 15.0, 0.0), 3.0) is case


def test_what_is_farther_than_the_range_does_not_count() -> None:
    assert classify(look(field(AHEAD, size=40.0), 13.9, 15.0, 0.0), 3.0) is Obstacle.NONE


def test_turns_are_those_of_the_thesis() -> None:
    degrees = {case: math.degrees(turn) for case, turn in TURNS.items()}
    assert degrees == {Obstacle.LEFT_CORNER: -90, Obstacle.RIGHT_CORNER: 90, Obstacle.FRONT: 180}


@pytest.mark.parametrize("beams", [90, 181, 721])
@pytest.mark.parametrize("heading", [-0.3, 0.0, 0.3])
def test_beside_a_wall_the_fan_points_along_it(heading: float, beams: int) -> None:
    view = look(field(LEFT, size=40.0), 15.0, 15.0, heading, beams)
    assert fan_direction(view, Obstacle.LEFT, 3.0) == pytest.approx(0.0, abs=0.05)


def test_between_two_walls_the_fan_points_to_the_middle() -> None:
    view = look(field(LEFT, RIGHT, size=40.0), 15.0, 15.0, 0.0)
    assert fan_direction(view, Obstacle.BOTH, 3.0) == pytest.approx(0.0, abs=0.05)
