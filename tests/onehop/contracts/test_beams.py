"""Angles in beams, whatever the laser."""

import math
from dataclasses import replace

import numpy as np
import pytest

from onehop.contracts.beams import Beams
from onehop.contracts.randomness import generator
from onehop.contracts.sections import RobotSection


def beams(count: int) -> Beams:
    return Beams(replace(RobotSection(), laser_beams=count))


@pytest.mark.parametrize(("count", "spanned"), [(2, 1), (90, 3), (181, 6), (361, 12), (721, 24)])
def test_an_angle_spans_as_many_beams_as_the_laser_has_in_it(count: int, spanned: int) -> None:
    assert beams(count).spanned(math.radians(6.0)) == spanned


@pytest.mark.parametrize("count", [2, 5, 90, 181, 721])
@pytest.mark.parametrize("degrees", [1.0, 6.0, 200.0])
def test_near_are_those_within_the_angle_of_a_marked_one(count: int, degrees: float) -> None:
    laser, angle = beams(count), math.radians(degrees)
    for share in (0.0, 0.02, 0.5, 1.0):
        marked = generator(1, f"{count}/{share}").random(count) < share
        reach, places = laser.spanned(angle), np.arange(count)
        expected = [bool(marked[max(0, k - reach) : k + reach + 1].any()) for k in places]
        assert laser.near(marked, angle).tolist() == expected
