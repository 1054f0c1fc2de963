"""The tables that `onehop link` and `onehop saturate` print."""

import math
from dataclasses import replace

import numpy as np
import pytest

from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.closed_forms import frame_probability
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_tables import link_table, saturation_table


def test_link_table_over_distance() -> None:
    """Preset thesis: .778, .737, .244 Mb/s at 1, 10, 20 m; eq. 3.25 gives .105 at 40 dB."""
    table = link_table(RadioSection(), (1.0, 10.0, 20.0, 300.0), 800, seed=1, seconds=20.0)
    near, middle, far, deaf = table.rows
    assert (near.distance_m, near.snr_db) == (1.0, pytest.approx(60.0))
    assert near.throughput_bps == pytest.approx(0.779e6, rel=0.01)
    assert near.delay_us == pytest.approx(8214 - 314, rel=0.01)
    assert middle.throughput_bps == pytest.approx(0.737e6, rel=0.02)
    assert middle.thesis_ber == pytest.approx(0.105, abs=5e-4)
    assert middle.frame_success == pytest.approx(0.977, abs=1e-3)
    assert far.throughput_bps == pytest.approx(0.244e6, rel=0.08)
    assert 0.9 < far.delivery_ratio < 1.0
    assert (deaf.throughput_bps, deaf.delivery_ratio, deaf.delay_us) == (0.0, 0.0, None)
    assert table.ideal_throughput_bps == pytest.approx(0.7792e6, rel=1e-4)
    assert table.eq_3_16_throughput_bps == pytest.approx(0.8101e6, rel=1e-4)
    assert table.threshold_bps == pytest.approx(0.5333e6)


@pytest.mark.parametrize("fading", ["frame", "exchange"])
@pytest.mark.parametrize("rts_threshold_bytes", [0, 2304])
def test_link_table_agrees_with_the_closed_form(fading: str, rts_threshold_bytes: int) -> None:
    section = RadioSection(fading=fading, rts_threshold_bytes=rts_threshold_bytes)  # type: ignore[arg-type]
    near, far, deaf = link_table(section, (5.0, 12.0, 3000.0), 800, seed=1, seconds=60.0).rows
    assert near.closed_form_bps == pytest.approx(near.throughput_bps, rel=0.01)
    assert far.closed_form_bps == pytest.approx(far.throughput_bps, rel=0.03)
    assert far.closed_form_bps < 0.995 * near.closed_form_bps
    assert deaf.closed_form_bps == deaf.throughput_bps == 0.0


def test_link_table_of_a_fast_rate_shows_bit_errors_before_the_threshold() -> None:
    sensitive = RadioSection(rate_mbps=11.0, receive_threshold_db=0.0, shadowing_db=0.0)
    (row,) = link_table(sensitive, (10 ** (53.5 / 20.0),), 800, seed=1, seconds=1.0).rows
    assert row.snr_db == pytest.approx(6.5)
    assert 0.5 < row.frame_success < 0.95
    assert 0.0 < row.ber < 1e-3


def test_saturation_table_agrees_with_bianchi() -> None:
    table = saturation_table(RadioSection(), 6, 800, rts_cts=True, seed=1, seconds=10.0)
    assert table.bianchi_normalized == pytest.approx(0.7975, abs=6e-5)
    assert table.normalized == pytest.approx(table.bianchi_normalized, rel=0.03)
    assert table.throughput_bps == pytest.approx(1e6 * table.normalized)
    assert len(table.per_station_bps) == table.stations == 6
    assert sum(table.per_station_bps) == pytest.approx(table.throughput_bps)


def test_basic_access_beats_rts_for_one_station() -> None:
    """Radio.md: .8490 against .7792."""
    tables = [saturation_table(RadioSection(), 1, 800, rts, 1, 5.0) for rts in (False, True)]
    assert [table.normalized for table in tables] == pytest.approx([0.8490, 0.7792], rel=0.01)


def test_places_of_the_thesis_are_all_alike() -> None:
    """.737 Mb/s at 10 m are above the threshold everywhere, .529 at 15 m nowhere."""
    table = link_table(RadioSection(), (10.0, 15.0), 800, seed=1, seconds=0.1)
    assert not table.places_differ
    assert [row.good_places for row in table.rows] == [1.0, 0.0]
    assert all(row.nine_of_ten_bps == row.closed_form_bps for row in table.rows)


def test_places_indoors_differ_by_their_shadow() -> None:
    """At the distance of mean SNR 4 dB, places whose shadow costs less than 4 dB of sigma 9 are good."""
    still = RadioSection(preset="indoor", shadowing_db=0.0)
    distance = 10.0 ** ((link_budget(still).snr_reference_db - 4.0) / 24.0)
    table = link_table(still, (distance, distance / 4.0), 800, seed=1, seconds=0.1)
    far, near = table.rows
    assert table.places_differ
    assert far.good_places == pytest.approx(0.5 * math.erfc(-4.0 / 9.0 / math.sqrt(2.0)), abs=0.01)
    assert (far.nine_of_ten_bps, near.nine_of_ten_bps) == (0.0, pytest.approx(near.closed_form_bps))


def test_places_under_rayleigh_fading_are_good_with_the_share_of_an_exponential() -> None:
    """P(power > 1/2) = exp(-1/2), with the threshold 3.01 dB below the mean."""
    still = RadioSection(fast_fading="rayleigh", shadowing_db=0.0)
    distance = 10.0 ** ((60.0 - 32.0 - 10.0 * math.log10(2.0)) / 20.0)
    (row,) = link_table(still, (distance,), 800, seed=1, seconds=0.1).rows
    assert row.good_places == pytest.approx(math.exp(-0.5), abs=0.01)


def test_preset_indoor() -> None:
    """SNR = 68.5 - 24 log10 d; an office: exponent 1.9 to 2.9, sigma 8 to 10, 1/e at 1.1 to 2.5 m."""
    indoor = link_budget(RadioSection(preset="indoor"))
    assert indoor.mean_snr_db(1.0) == pytest.approx(68.5, abs=0.01)
    assert indoor.mean_snr_db(10.0) == pytest.approx(44.5, abs=0.01)
    assert 1.9 <= indoor.exponent <= 2.9
    assert 8.0 <= indoor.spatial_shadowing_db <= 10.0
    assert 1.1 <= indoor.decorrelation_distance <= 2.5


def test_preset_indoor_has_as_few_grey_links_as_the_orbit_grid() -> None:
    """Noise that leaves 12 % of the links of 20 x 20 nodes dead leaves 3 % between 10 and 90 %."""
    budget = link_budget(RadioSection(preset="indoor"))
    along = np.arange(20.0)
    nodes = np.stack([axis.ravel() for axis in np.meshgrid(along, along)], axis=1)
    one, other = np.triu_indices(400, 1)
    apart = np.sqrt(((nodes[one] - nodes[other]) ** 2).sum(axis=1))
    shadows = 9.0 * np.random.default_rng(1).standard_normal(len(apart))
    snr_db = np.array([budget.mean_snr_db(each) for each in apart.tolist()]) + shadows

    def grey_share(sigma_db: float) -> float:
        drawn = replace(budget, shadowing_db=sigma_db)
        probe = np.arange(-20.0, 20.0, 0.1)
        success = np.array([frame_probability(drawn, snr, 1.0, 834) for snr in probe.tolist()])
        low, high = np.interp((0.1, 0.9), success, probe)
        dead_db = np.quantile(snr_db, 0.12)
        return float(((snr_db > dead_db) & (snr_db < dead_db + high - low)).mean())

    assert grey_share(budget.shadowing_db) == pytest.approx(0.03, abs=0.005)
    assert grey_share(4.0) > 0.25
