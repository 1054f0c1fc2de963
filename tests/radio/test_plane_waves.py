"""The sum of plane waves is the one that its docstring writes."""

import cmath
import math

import numpy as np
import pytest

from radio_proxy.core.plane_waves import PlaneWaves, directions, strata

WAVES, STATIONS = 7, 4


def test_it_is_the_sum_over_both_ends_and_back() -> None:
    stream = np.random.default_rng(1)
    first, second = stream.normal(size=(2, 2, WAVES))
    offset, drift = stream.random((2, WAVES))
    places = stream.uniform(-20.0, 20.0, (STATIONS, 2))
    waves = PlaneWaves(first, second, offset)

    def phases(vectors: np.ndarray, place: np.ndarray, start: np.ndarray) -> list[float]:
        return (place[0] * vectors[0] + place[1] * vectors[1] + start).tolist()

    def written(a: np.ndarray, b: np.ndarray, start: np.ndarray) -> complex:
        nothing = np.zeros(WAVES)
        out = zip(phases(first, a, start), phases(second, b, nothing), strict=True)
        back = zip(phases(first, b, start), phases(second, a, nothing), strict=True)
        return sum(cmath.exp(2j * math.pi * (u + v)) for u, v in [*out, *back])

    for shift in (None, drift):
        waves.place(places, shift)
        start = offset if shift is None else offset + shift
        for a in range(STATIONS):
            real, imaginary = waves.real(a), waves.imaginary(a)
            for b in range(STATIONS):
                expected = written(places[a], places[b], start)
                assert complex(real[b], imaginary[b]) == pytest.approx(expected, abs=1e-9)


def test_strata_have_one_number_in_each_part() -> None:
    drawn = strata(np.random.default_rng(1), 50)
    assert sorted(np.floor(50 * drawn).tolist()) == list(range(50))
    assert np.floor(50 * drawn).tolist() != list(range(50))


def test_directions_are_unit_vectors_from_all_sides() -> None:
    found = directions(np.random.default_rng(1), 40)
    assert (found * found).sum(axis=0) == pytest.approx(1.0)
    assert found.sum(axis=1) == pytest.approx(0.0, abs=2.0)
