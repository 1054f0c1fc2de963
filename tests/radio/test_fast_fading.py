"""Fast fading: Rayleigh and Rician envelopes, and the Doppler of robots that move."""

import math

import numpy as np
import pytest

from onehop.contracts.radio_section import RadioSection
from onehop.contracts.randomness import generator
from radio_proxy.core.fast_fading import GRAIN, FastFading, fast_fading
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.propagation import OWN_DB, SILENT_DB, Propagation
from tests.radio.test_propagation import present

WAVELENGTH = 0.125
SECOND = 1_000_000_000
TICK = SECOND // 20
Walk = np.ndarray


def paths(seed: int = 1, k: float = 0.0, ambient: float = 0.0) -> FastFading:
    return FastFading(generator(seed, "fast fading"), WAVELENGTH, k, ambient)


def standing(air: FastFading, a: tuple[float, float], b: tuple[float, float], now: int = 0) -> float:
    """Gain between two that stand there [dB]."""
    air.move([a, b], [a, b], now, now + TICK)
    return air.row_db(0, now)[1]


def walk(air: FastFading, speed_a: float, speed_b: float, samples: int, step: int = 2 * GRAIN) -> Walk:
    """Power gains along a straight walk of both ends at an angle to each other, every `step` ns."""
    seconds = samples * step / SECOND
    a, b = (0.0, 0.0), (40.0, 3.0)
    there_a = (0.6 * speed_a * seconds, 0.8 * speed_a * seconds)
    there_b = (b[0] + speed_b * seconds, b[1])
    air.move([a, b], [there_a, there_b], 0, samples * step)
    return 10.0 ** (np.array([air.row_db(0, i * step)[1] for i in range(samples)]) / 10.0)


def j0(x: float) -> float:
    """Bessel function of the first kind, by its integral."""
    angles = (np.arange(2000) + 0.5) * math.pi / 2000
    return float(np.cos(x * np.sin(angles)).mean())


def power_correlation(power: Walk, lag: int) -> float:
    return float(np.corrcoef(power[:-lag], power[lag:])[0, 1])


def anywhere(air: FastFading, count: int) -> Walk:
    """Power gains of links whose ends lie anywhere."""
    places = np.random.default_rng(3).uniform(-50.0, 50.0, (count, 4)).tolist()
    gains = [standing(air, (ax, ay), (bx, by)) for ax, ay, bx, by in places]
    return 10.0 ** (np.array(gains) / 10.0)


def test_rayleigh_power_is_exponential_over_places() -> None:
    power = anywhere(paths(), 4000)
    assert power.mean() == pytest.approx(1.0, abs=0.05)
    for level in (0.01, 0.1, 0.5, 1.0, 3.0):
        expected = 1.0 - math.exp(-level)
        assert (power < level).mean() == pytest.approx(expected, abs=4 * math.sqrt(expected / 4000))


@pytest.mark.parametrize("k", [1.0, 10.0])
def test_rician_power_has_its_line_of_sight(k: float) -> None:
    """Mean 1 and variance (1 + 2 K) / (1 + K)^2."""
    power = anywhere(paths(k=k), 4000)
    assert power.mean() == pytest.approx(1.0, abs=0.05)
    assert power.var() == pytest.approx((1 + 2 * k) / (1 + k) ** 2, rel=0.12)


@pytest.mark.parametrize("share", [0.1, 0.2, 0.3827])
def test_power_of_one_moving_end_is_correlated_as_j0_squared(share: float) -> None:
    """Clarke 1968: J0(2 pi f_D t) of the field, so its square of the power; share of a wavelength."""
    lag = 4
    speed = share * WAVELENGTH / (lag * 2 * GRAIN / SECOND)
    found = [power_correlation(walk(paths(seed), speed, 0.0, 2500), lag) for seed in range(6)]
    assert np.mean(found) == pytest.approx(j0(2 * math.pi * share) ** 2, abs=0.06)


@pytest.mark.slow
def test_power_of_two_moving_ends_is_correlated_as_the_product() -> None:
    """Akki and Haber 1986: J0(2 pi f_1 t) J0(2 pi f_2 t)."""
    lag, share_a, share_b = 4, 0.15, 0.1
    per_second = WAVELENGTH / (lag * 2 * GRAIN / SECOND)
    found = [
        power_correlation(walk(paths(seed), share_a * per_second, share_b * per_second, 2500), lag)
        for seed in range(6)
    ]
    product = j0(2 * math.pi * share_a) * j0(2 * math.pi * share_b)
    assert np.mean(found) == pytest.approx(product**2, abs=0.06)


@pytest.mark.slow
@pytest.mark.parametrize("rho", [0.3, 1.0])
def test_levels_are_crossed_as_often_as_rice_says(rho: float) -> None:
    """sqrt(2 pi) f_D rho exp(-rho^2) a second, for a level rho times the root mean square."""
    speed, samples = 1.0, 8000
    doppler_hz, seconds = speed / WAVELENGTH, samples * 2 * GRAIN / SECOND
    crossings = []
    for seed in range(4):
        above = np.sqrt(walk(paths(seed), speed, 0.0, samples)) > rho
        crossings.append((above[1:] & ~above[:-1]).sum() / seconds)
    expected = math.sqrt(2 * math.pi) * doppler_hz * rho * math.exp(-rho * rho)
    assert np.mean(crossings) == pytest.approx(expected, rel=0.1)


def test_a_channel_stands_with_its_robots_unless_something_else_moves() -> None:
    a, b = (1.0, 2.0), (8.0, 5.0)
    still, lively = paths(), paths(ambient=2.0)
    gains = [standing(still, a, b, second * SECOND) for second in range(5)]
    assert len(set(gains)) == 1
    gains = [standing(lively, a, b, second * SECOND) for second in range(5)]
    assert len(set(gains)) == 5


@pytest.mark.slow
def test_ambient_motion_decorrelates_as_its_doppler_says() -> None:
    """J0(2 pi f t) of the field."""
    step, lag, found = SECOND // 50, 5, []
    for seed in range(8):
        air = paths(seed, ambient=2.0)
        air.move([(0.0, 0.0), (9.0, 4.0)], [(0.0, 0.0), (9.0, 4.0)], 0, TICK)
        power = [10.0 ** (air.row_db(0, i * step)[1] / 10.0) for i in range(2000)]
        found.append(power_correlation(np.array(power), lag))
    assert np.mean(found) == pytest.approx(j0(2 * math.pi * 2.0 * 0.1) ** 2, abs=0.08)


def test_it_is_the_same_both_ways() -> None:
    for k in (0.0, 4.0):
        air = paths(k=k)
        places = [(0.0, 0.0), (3.0, 1.0), (7.0, 7.0), (0.0, 0.0), (-4.0, 20.0)]
        air.move(places, places, 0, TICK)
        rows = [air.row_db(station, 0) for station in range(5)]
        assert all(rows[a][b] == rows[b][a] for a in range(5) for b in range(5))


def test_a_place_keeps_its_gain() -> None:
    air = paths()
    before = standing(air, (1.0, 1.0), (5.0, 5.0))
    assert standing(air, (1.05, 1.0), (5.0, 5.0)) != before
    assert standing(air, (1.0, 1.0), (5.0, 5.0)) == before


def propagation(section: RadioSection, *places: tuple[float, float]) -> Propagation:
    robots = tuple(range(1, len(places) + 1))
    made = Propagation(link_budget(section), robots, (), None, fast_fading(section, 1))
    made.update(present(*places), (), (), (0, TICK))
    return made


RAYLEIGH = RadioSection(fast_fading="rayleigh")


def test_robots_move_evenly_within_a_tick() -> None:
    """Where a tick ends the next one begins, and half way through it a robot is half way."""
    moving = propagation(RAYLEIGH, (0.0, 0.0), (6.0, 0.0))
    moving.update(present((0.0, 0.0), (6.1, 0.0)), (), (), (TICK, 2 * TICK))
    half_way, at_end = moving.snr_row(0, 3 * TICK // 2)[1], moving.snr_row(0, 2 * TICK)[1]
    moving.update(present((0.0, 0.0), (6.2, 0.0)), (), (), (2 * TICK, 3 * TICK))
    at_start = moving.snr_row(0, 2 * TICK)[1]
    mean_db = moving.budget.mean_snr_db
    gains = [half_way - mean_db(6.1), at_end - mean_db(6.1), at_start - mean_db(6.2)]
    air = fast_fading(RAYLEIGH, 1)
    assert air is not None
    assert gains[0] == pytest.approx(standing(air, (0.0, 0.0), (6.05, 0.0)))
    assert gains[1] == pytest.approx(standing(air, (0.0, 0.0), (6.1, 0.0)))
    assert gains[1] == pytest.approx(gains[2])


def test_fast_fading_comes_on_top_of_the_mean_and_spares_who_is_out_of_reach() -> None:
    found = propagation(RAYLEIGH, (0.0, 0.0), (6.0, 0.0), (1e6, 0.0))
    air = fast_fading(RAYLEIGH, 1)
    assert air is not None
    places = [(0.0, 0.0), (6.0, 0.0), (1e6, 0.0)]
    air.move(places, places, 0, TICK)
    row = found.snr_row(0, 0)
    assert row[1] == pytest.approx(found.mean_snr_row(0)[1] + air.row_db(0, 0)[1])
    assert (row[0], row[2]) == (OWN_DB, SILENT_DB)


def test_nobody_is_sure_to_sense_a_station_under_fast_fading() -> None:
    """A fade can hide any station from any other: no exchange is taken for undisturbed."""
    near = (0.0, 0.0), (1.0, 0.0)
    assert propagation(RadioSection(), *near).is_sensed_by_all(0)
    assert not propagation(RAYLEIGH, *near).is_sensed_by_all(0)


def test_a_scenario_names_its_kind() -> None:
    assert fast_fading(RadioSection(), 1) is None
    places = [(0.0, 0.0), (6.0, 0.0)]
    gains = []
    for kind, k_db in (("rayleigh", 6.0), ("rayleigh", 20.0), ("rician", 6.0), ("rician", 40.0)):
        section = RadioSection(fast_fading=kind, rician_k_db=k_db)  # type: ignore[arg-type]
        air = fast_fading(section, 1)
        assert air is not None
        gains.append(standing(air, *places))
    assert gains[0] == gains[1]
    assert len(set(gains)) == 3
    assert gains[3] == pytest.approx(0.0, abs=0.5)
