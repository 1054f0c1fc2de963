"""Shadowing that belongs to places: Gudmundson's autocorrelation, both ends, reach."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.radio_section import RadioSection
from onehop.contracts.randomness import generator
from radio_proxy.core.link_budget import CLIP, REACH_DB, link_budget
from radio_proxy.core.propagation import SILENT_DB, Propagation
from radio_proxy.core.shadowing import Shadowing, shadowing
from tests.radio.test_propagation import present

SIGMA_DB, DECORRELATION = 9.0, 1.8
Places = np.ndarray
INDOOR = RadioSection(preset="indoor")


def field(seed: int = 1) -> Shadowing:
    return Shadowing(generator(seed, "shadowing"), SIGMA_DB, DECORRELATION)


def between(ground: Shadowing, a: Places, b: Places) -> Places:
    """Shadowing of links from a to b, (links, 2) each [dB]."""
    values = []
    for here, there in zip(a.tolist(), b.tolist(), strict=True):
        ground.place([tuple(here), tuple(there)])
        values.append(ground.row_db(0)[1])
    return np.array(values)


def links(count: int, seed: int = 5) -> tuple[Places, Places]:
    """Links whose ends lie anywhere in a square of 200 m."""
    drawn = np.random.default_rng(seed).uniform(-100.0, 100.0, (2, count, 2))
    return drawn[0], drawn[1]


def steps(count: int, length: float, seed: int = 6) -> Places:
    """Steps of one length in any direction."""
    angle = np.random.default_rng(seed).uniform(0.0, 2.0 * math.pi, count)
    return length * np.stack((np.cos(angle), np.sin(angle)), axis=1)


def correlation(x: Places, y: Places) -> float:
    return float(np.corrcoef(x, y)[0, 1])


def test_over_many_places_it_is_normal_with_the_sigma_asked_for() -> None:
    values = between(field(), *links(6000)) / SIGMA_DB
    assert values.mean() == pytest.approx(0.0, abs=0.05)
    assert values.std() == pytest.approx(1.0, abs=0.03)
    for quantile, share in ((-1.6449, 0.05), (-0.6745, 0.25), (0.6745, 0.75), (1.6449, 0.95)):
        assert (values < quantile).mean() == pytest.approx(share, abs=0.02)
    assert np.abs(values).max() <= CLIP


@pytest.mark.parametrize("moved", [0.1, 0.5, 1.0, 2.0])
def test_one_end_that_moves_decorrelates_it_exponentially(moved: float) -> None:
    """Gudmundson 1991: exp(-d / D); 1/e after the decorrelation distance."""
    ground, (a, b) = field(), links(3000)
    before = between(ground, a, b)
    after = between(ground, a + steps(3000, moved * DECORRELATION), b)
    assert correlation(before, after) == pytest.approx(math.exp(-moved), abs=0.04)
    far_end = between(ground, a, b + steps(3000, moved * DECORRELATION))
    assert correlation(before, far_end) == pytest.approx(math.exp(-moved), abs=0.04)


@pytest.mark.slow
@pytest.mark.parametrize("step_of_the_other", [6, 7])
def test_both_ends_that_move_decorrelate_it_by_the_product(step_of_the_other: int) -> None:
    """Wang, Tameh and Nix 2008: both ends count alike and independently, moving together or not."""
    half, found = 0.5 * DECORRELATION, []
    for seed in range(8):
        ground, (a, b) = field(seed), links(500, seed)
        before = between(ground, a, b)
        after = between(ground, a + steps(500, half, 6), b + steps(500, half, step_of_the_other))
        found.append(correlation(before, after))
    assert np.mean(found) == pytest.approx(math.exp(-1.0), abs=0.05)


@pytest.mark.slow
def test_a_walk_in_one_direction_is_correlated_as_any_other() -> None:
    """Over seeds, along one line: within what 64 waves promise."""
    errors = []
    for seed in range(12):
        ground, (a, b) = field(seed), links(600, seed)
        before = between(ground, a, b)
        after = between(ground, a + np.array([DECORRELATION, 0.0]), b)
        errors.append(correlation(before, after) - math.exp(-1.0))
    assert np.sqrt(np.mean(np.square(errors))) < 0.08
    assert np.mean(errors) == pytest.approx(0.0, abs=0.04)


@pytest.mark.parametrize("apart", [0.0, 0.2, 1.0])
def test_ends_near_each_other_have_the_same_sigma(apart: float) -> None:
    values = []
    for seed in range(5):
        a, _ = links(600, seed)
        values.append(between(field(seed), a, a + steps(600, apart * DECORRELATION)))
    assert np.concatenate(values).std() == pytest.approx(SIGMA_DB, rel=0.05)


coordinate = st.floats(-1e5, 1e5)


@given(coordinate, coordinate, coordinate, coordinate)
def test_it_is_the_same_both_ways_and_whoever_stands_there(
    ax: float, ay: float, bx: float, by: float
) -> None:
    ground = field()
    ground.place([(ax, ay), (bx, by), (ax + 50.0, ay)])
    there, back = ground.row_db(0)[1], ground.row_db(1)[0]
    assert there == back
    ground.place([(bx, by), (0.0, 0.0), (ax, ay)])
    assert ground.row_db(0)[2] == pytest.approx(there, abs=1e-6)


def test_a_place_keeps_its_shadow() -> None:
    """A robot that comes back meets what it left, to the bit."""
    ground = field()
    there = [(3.0, 4.0), (9.0, 1.0)]
    ground.place(there)
    before = ground.row_db(0)[1]
    ground.place([(30.0, 40.0), (9.0, 1.0)])
    assert ground.row_db(0)[1] != before
    ground.place(there)
    assert ground.row_db(0)[1] == before


def test_another_seed_is_another_ground() -> None:
    budget = link_budget(INDOOR)
    rows = []
    for seed in (1, 1, 2):
        ground = shadowing(budget, seed)
        assert ground is not None
        ground.place([(0.0, 0.0), (5.0, 5.0)])
        rows.append(ground.row_db(0)[1])
    assert rows[0] == rows[1] != rows[2]
    assert shadowing(link_budget(RadioSection()), 1) is None


def propagation(section: RadioSection, *places: tuple[float, float]) -> Propagation:
    budget = link_budget(section)
    ground = shadowing(budget, 3)
    found = Propagation(budget, tuple(range(1, len(places) + 1)), (), ground)
    found.update(present(*places), (), ())
    return found


def test_the_shadow_comes_on_top_of_the_path_loss() -> None:
    places = ((0.0, 0.0), (20.0, 0.0), (0.0, 7.0))
    bare = propagation(RadioSection(preset="indoor", spatial_shadowing_db=0.0), *places)
    shadowed = propagation(INDOOR, *places)
    ground = shadowing(link_budget(INDOOR), 3)
    assert ground is not None
    ground.place(list(places))
    for sender in range(3):
        for other in {0, 1, 2} - {sender}:
            gain = shadowed.mean_snr_row(sender)[other] - bare.mean_snr_row(sender)[other]
            assert gain == pytest.approx(ground.row_db(sender)[other])


@given(st.lists(st.tuples(st.floats(-900, 900), st.floats(-900, 900)), min_size=2, max_size=10))
def test_reach_misses_nobody_whom_a_shadow_lets_through(places: list[tuple[float, float]]) -> None:
    """Whoever is heard above the floor of reach, shadow included, is in the row."""
    section = RadioSection(preset="indoor", path_loss_exponent=4.0, tx_power_dbm=0.0)
    found, budget = propagation(section, *places), link_budget(section)
    ground = shadowing(budget, 3)
    assert ground is not None
    ground.place(places)
    for a, here in enumerate(places):
        for b, there in enumerate(places):
            if a != b:
                snr_db = budget.mean_snr_db(math.dist(here, there)) + ground.row_db(a)[b]
                heard = found.mean_snr_row(a)[b]
                assert heard == pytest.approx(snr_db) if snr_db > REACH_DB else heard < REACH_DB + 1e-9


def test_reach_grows_by_the_strongest_shadow() -> None:
    """27 dB more at an exponent of 2.4: 13.3 times as far."""
    bare = link_budget(RadioSection(preset="indoor", spatial_shadowing_db=0.0))
    assert link_budget(INDOOR).reach == pytest.approx(bare.reach * 10 ** (27.0 / 24.0))
    far = propagation(INDOOR, (0.0, 0.0), (link_budget(INDOOR).reach * 1.001, 0.0))
    assert far.mean_snr_row(0)[1] == SILENT_DB


def test_who_is_in_a_shadow_is_not_counted_as_sensing() -> None:
    """Of many places at one distance some sense the sender and some do not, as their row says."""
    section = RadioSection(preset="indoor", tx_power_dbm=-30.0)
    places = [(8.0 * math.cos(k), 8.0 * math.sin(k)) for k in range(40)]
    least, sensed = link_budget(section).carrier_sense_db, []
    for place in places:
        found = propagation(section, (0.0, 0.0), place)
        sensed.append(found.is_sensed_by_all(0))
        assert sensed[-1] == (found.mean_snr_row(0)[1] >= least)
    assert 5 < sum(sensed) < 35
