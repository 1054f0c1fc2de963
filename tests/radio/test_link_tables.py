"""The tables that `onehop link` and `onehop saturate` print."""

import pytest

from onehop.contracts.radio_section import RadioSection
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
