"""Elementary functions: right, and the same whichever code the C library and NumPy pick."""

import math
from collections.abc import Callable
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts import elementary

angle = st.floats(-1e4, 1e4)
coordinate = st.floats(-1e3, 1e3).map(lambda x: 0.0 if abs(x) < 1e-9 else x)
GRID = 2.0**36


def _is_on_grid(value: float) -> bool:
    return value * GRID == round(value * GRID)


@given(angle)
def test_sine_and_cosine_are_the_nearest_grid_points(x: float) -> None:
    for ours, library in ((elementary.sin, math.sin), (elementary.cos, math.cos)):
        assert _is_on_grid(ours(x))
        assert abs(ours(x) - library(x)) <= 0.5 / GRID + 1e-15


@given(coordinate, coordinate)
def test_directions_are_the_nearest_grid_points_and_stay_within_half_a_turn(y: float, x: float) -> None:
    ours = elementary.atan2(y, x)
    assert _is_on_grid(ours)
    assert abs(ours - math.atan2(y, x)) <= 0.5 / GRID + 1e-15
    assert -math.pi < ours < math.pi


@given(st.lists(st.tuples(coordinate, coordinate), min_size=1, max_size=20))
def test_arrays_have_the_bits_of_single_values(points: list[tuple[float, float]]) -> None:
    y, x = np.array(points).T
    assert elementary.sines(y).tolist() == [elementary.sin(one) for one in y.tolist()]
    assert elementary.cosines(y).tolist() == [elementary.cos(one) for one in y.tolist()]
    both = zip(y.tolist(), x.tolist(), strict=True)
    assert elementary.directions(y, x).tolist() == [elementary.atan2(*one) for one in both]


@given(st.lists(st.floats(-1e4, 1e4), min_size=1, max_size=20))
def test_a_circle_has_cosine_and_sine_of_every_angle_in_turns(turns: list[float]) -> None:
    cosines, sines = elementary.circle(np.array([turns]))
    assert cosines.shape == sines.shape == (1, len(turns))
    for turn, cosine, sine in zip(turns, cosines[0], sines[0], strict=True):
        whole = turn - round(turn)
        assert cosine == pytest.approx(math.cos(2.0 * math.pi * whole), abs=1e-11)
        assert sine == pytest.approx(math.sin(2.0 * math.pi * whole), abs=1e-11)


@pytest.mark.parametrize(
    ("name", "argument"),
    [
        (name, argument)
        for name in ("sin", "cos", "log10", "exp", "power_of_ten", "log1p", "expm1", "erf")
        for argument in (0.1, 0.7, 1.0, 2.5, 3.1)
    ],
)
@pytest.mark.parametrize("places", [-4, -1, 1, 4])
def test_a_library_that_is_some_units_in_the_last_place_off_gives_the_same(
    monkeypatch: pytest.MonkeyPatch, name: str, argument: float, places: int
) -> None:
    function: Callable[[float], float] = getattr(elementary, name)
    before = [function(argument + k * 0.37) for k in range(200)]
    called = {"power_of_ten": "pow"}.get(name, name)
    library = getattr(math, called)

    def off(*arguments: float) -> float:
        value: float = library(*arguments)
        return value + places * math.ulp(value)

    monkeypatch.setattr(elementary.math, called, off)
    assert [function(argument + k * 0.37) for k in range(200)] == before


@pytest.mark.parametrize("x", [1e-3, 0.4, 1.0, 2.2, 4.0])
def test_what_is_computed_anew_is_the_library_s_to_the_last_place(x: float) -> None:
    for exact, library in (
        (elementary._exact_sin, math.sin), (elementary._exact_cos, math.cos),
        (elementary._exact_exp, math.exp), (elementary._exact_log10, math.log10),
        (elementary._exact_log1p, math.log1p), (elementary._exact_expm1, math.expm1),
        (elementary._exact_erf, math.erf),
    ):  # fmt: skip
        assert float(exact(Decimal(x))) == pytest.approx(library(x), rel=3e-16)
    assert float(elementary._exact_atan2(Decimal(x), Decimal(-1))) == pytest.approx(
        math.atan2(x, -1.0), rel=3e-16
    )


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (elementary.sin, (math.nan,)),
        (elementary.cos, (math.nan,)),
        (elementary.log10, (math.nan,)),
        (elementary.atan2, (math.nan, 1.0)),
        (elementary.atan2, (1.0, math.nan)),
    ],
)
def test_what_is_no_number_stays_none(
    function: Callable[..., float], arguments: tuple[float, ...]
) -> None:
    assert math.isnan(function(*arguments))
