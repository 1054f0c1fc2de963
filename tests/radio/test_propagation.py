"""Path loss, presets, walls, cuts and jams."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Cut, Jam, Presence
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.link_budget import (
    REACH_DB,
    THERMAL_NOISE_DBM,
    free_space_loss_db,
    link_budget,
)
from radio_proxy.core.path_loss import walls_crossed
from radio_proxy.core.propagation import (
    OWN_DB,
    SILENT_DB,
    Propagation,
)

THESIS, PHYSICAL = link_budget(RadioSection()), link_budget(RadioSection(preset="physical"))
NO_CUTS: tuple[Cut, ...] = ()
NO_JAMS: tuple[Jam, ...] = ()


def present(*places: tuple[float, float]) -> tuple[Presence, ...]:
    return tuple(
        Presence(i, 0, Pose(x, y, 0.0), Twist(0.0, 0.0), False) for i, (x, y) in enumerate(places, 1)
    )


def propagation_of(
    *places: tuple[float, float],
    section: RadioSection | None = None,
    walls: tuple[tuple[float, float, float, float], ...] = (),
    cuts: tuple[Cut, ...] = NO_CUTS,
    jams: tuple[Jam, ...] = NO_JAMS,
) -> Propagation:
    result = Propagation(link_budget(section or RadioSection()), tuple(range(1, len(places) + 1)), walls)
    result.update(present(*places), cuts, jams)
    return result


def test_free_space_loss_at_a_metre() -> None:
    """PL(1 m, 2.4 GHz) = 40.046 dB; kTB of 22 MHz at 290 K = -100.55 dBm."""
    assert free_space_loss_db(1.0, 2.4e9) == pytest.approx(40.046, abs=5e-4)
    assert 10 * math.log10(1.380649e-23 * 290 * 22e6 * 1e3) == pytest.approx(THERMAL_NOISE_DBM, abs=5e-3)


def test_preset_thesis() -> None:
    """SNR = 60 - 20 log10 d, range 25.1 m at 32 dB."""
    assert THESIS.mean_snr_db(1.0) == pytest.approx(60.0, abs=1e-9)
    assert THESIS.mean_snr_db(10.0) == pytest.approx(40.0, abs=1e-9)
    assert THESIS.mean_snr_db(25.1) >= 32.0 > THESIS.mean_snr_db(25.2)


def test_preset_physical() -> None:
    """SNR = 68.5 - 26 log10 d, range 25.4 m."""
    assert PHYSICAL.mean_snr_db(1.0) == pytest.approx(68.5, abs=0.01)
    assert PHYSICAL.mean_snr_db(10.0) == pytest.approx(42.5, abs=0.01)
    assert PHYSICAL.mean_snr_db(25.3) >= 32.0 > PHYSICAL.mean_snr_db(25.4)


def test_a_scenario_overrides_its_preset() -> None:
    louder = link_budget(RadioSection(tx_power_dbm=30.0, noise_dbm=-90.0, shadowing_db=0.0))
    assert louder.mean_snr_db(1.0) == pytest.approx(30.0 - 40.046 + 90.0, abs=5e-4)
    assert louder.shadowing_db == 0.0
    antennas = link_budget(RadioSection(antenna_gain_dbi=2.0, system_loss_db=1.0))
    assert antennas.mean_snr_db(1.0) == pytest.approx(63.0, abs=1e-9)


def test_every_wall_costs_its_loss() -> None:
    walls = ((5.0, -1.0, 5.0, 1.0), (6.0, -1.0, 6.0, 1.0), (7.0, 3.0, 7.0, 9.0))
    hard = RadioSection(wall_loss_db=7.0)
    bare = propagation_of((0, 0), (10, 0)).mean_snr_row(0)[1]
    assert propagation_of((0, 0), (10, 0), walls=walls).mean_snr_row(0)[1] == bare
    walled = propagation_of((0, 0), (10, 0), section=hard, walls=walls)
    assert walled.mean_snr_row(0)[1] == pytest.approx(bare - 14.0)


coordinate = st.floats(-20, 20)


@given(coordinate, coordinate, coordinate, coordinate)
def test_walls_count_the_same_both_ways(ax: float, ay: float, bx: float, by: float) -> None:
    walls = ((0.0, -30.0, 0.1, 30.0), (-30.0, 1.0, 30.0, 1.2), (3.0, 3.0, 9.0, 4.0))
    assert walls_crossed(walls, ax, ay, bx, by) == walls_crossed(walls, bx, by, ax, ay)


@given(st.lists(st.tuples(st.floats(-900, 900), st.floats(-900, 900)), min_size=2, max_size=12))
def test_cells_miss_nobody_in_reach(places: list[tuple[float, float]]) -> None:
    """The grid finds whatever comparing all pairs finds."""
    section = RadioSection(preset="physical", path_loss_exponent=4.0)
    propagation = propagation_of(*places, section=section)
    for a, (ax, ay) in enumerate(places):
        for b, (bx, by) in enumerate(places):
            if a != b:
                mean = propagation.budget.mean_snr_db(math.hypot(ax - bx, ay - by))
                heard = propagation.mean_snr_row(a)[b]
                assert heard == pytest.approx(mean) if mean > REACH_DB else heard in (SILENT_DB, mean)


def test_a_cut_silences_both_directions_and_nobody_else() -> None:
    propagation = propagation_of((0, 0), (5, 0), (9, 0), cuts=(Cut((1,), (2,)),))
    assert propagation.mean_snr_row(0)[1] == propagation.mean_snr_row(1)[0] == SILENT_DB
    assert propagation.mean_snr_row(0)[2] > SILENT_DB < propagation.mean_snr_row(1)[2]
    assert propagation.mean_snr_row(0)[0] == OWN_DB


def test_a_jam_raises_the_noise_inside_its_disc_alone() -> None:
    jam = Jam(0.0, 0.0, 6.0, THESIS.noise_dbm + 10.0)
    propagation = propagation_of((0, 0), (5, 0), (9, 0), jams=(jam,))
    propagation.mean_snr_row(0)
    rise = 10 * math.log10(11.0)
    assert propagation.noise_rise_db == pytest.approx([rise, rise, 0.0])
    propagation.update(present((0, 0), (5, 0), (9, 0)), (), ())
    propagation.mean_snr_row(0)
    assert propagation.noise_rise_db == [0.0, 0.0, 0.0]
