"""Closed forms against numbers computed by hand and those of Bianchi's paper."""

import pytest

from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.airtime import dsss
from radio_proxy.core.closed_forms import (
    SaturatedLink,
    bianchi_normalized,
    bianchi_tau,
    frame_probability,
)
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_rules import RetryLimits
from tests.radio.stations import fhss, threshold_probability

STANDARD_1999 = dsss(RadioSection(cts_timeout_us=334.0))


@pytest.mark.parametrize(
    ("p", "ratio", "throughput", "delay"),
    [
        (1.0, 1.0, 0.77916, 8214.0),
        (0.9, 1.0, 0.76421, 8374.6),
        (0.7, 0.99978, 0.71306, 8967.7),
        (0.5, 0.99219, 0.59722, 10437.0),
        (0.3, 0.91765, 0.38570, 13409.0),
        (0.1, 0.52170, 0.12757, 17640.0),
    ],
)
def test_one_draw_per_exchange(p: float, ratio: float, throughput: float, delay: float) -> None:
    link = SaturatedLink(STANDARD_1999, 800, RetryLimits())
    expected = (ratio, throughput, delay)
    assert link.one_draw_per_exchange(p) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ("p", "throughput"),
    [(0.98, 0.74238), (0.95, 0.68683), (0.9, 0.59090), (0.8, 0.39829), (0.5, 0.10639)],
)
def test_one_draw_per_frame(p: float, throughput: float) -> None:
    link = SaturatedLink(dsss(RadioSection()), 800, RetryLimits())
    assert link.one_draw_per_frame(p, p, p, p)[1] == pytest.approx(throughput, rel=1e-4)


# Preset thesis: distance, SNR, p, Mb/s with fading per frame and per exchange.
FADING = [
    (1, 60.0, 1.0, 0.779, 0.779),
    (5, 46.0, 0.9998, 0.779, 0.779),
    (8, 41.9, 0.994, 0.767, 0.778),
    (10, 40.0, 0.977, 0.737, 0.776),
    (12, 38.4, 0.946, 0.679, 0.772),
    (15, 36.5, 0.869, 0.529, 0.759),
    (20, 34.0, 0.690, 0.244, 0.709),
    (25, 32.0, 0.504, 0.109, 0.601),
    (30, 30.5, 0.350, 0.044, 0.446),
    (40, 28.0, 0.156, 0.005, 0.201),
]


@pytest.mark.parametrize(("distance", "snr_db", "p", "per_frame", "per_exchange"), FADING)
def test_saturated_throughput_over_distance(
    distance: float, snr_db: float, p: float, per_frame: float, per_exchange: float
) -> None:
    budget = link_budget(RadioSection())
    assert budget.mean_snr_db(distance) == pytest.approx(snr_db, abs=0.051)
    probability = threshold_probability(budget, budget.mean_snr_db(distance))
    assert probability == pytest.approx(p, abs=6e-4)
    link = SaturatedLink(dsss(RadioSection()), 800, RetryLimits())
    assert link.one_draw_per_frame(*[probability] * 4)[1] == pytest.approx(per_frame, abs=6e-4)
    standard = SaturatedLink(STANDARD_1999, 800, RetryLimits())
    assert standard.one_draw_per_exchange(probability)[1] == pytest.approx(per_exchange, abs=6e-4)


def test_frames_above_the_threshold_are_lost_to_nothing_else() -> None:
    """At 1 Mb/s bit errors begin 34 dB below the threshold of 32 dB."""
    budget = link_budget(RadioSection())
    for snr_db in (28.0, 32.0, 36.0):
        expected = threshold_probability(budget, snr_db)
        assert frame_probability(budget, snr_db, 1.0, 834) == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize(("n", "expected"), [(2, 0.7919), (5, 0.7974), (6, 0.7975)])
def test_bianchi_for_802_11b(n: int, expected: float) -> None:
    assert bianchi_normalized(n, dsss(RadioSection()), 800, True) == pytest.approx(expected, abs=6e-5)


@pytest.mark.parametrize(
    ("window", "stages", "rts_cts", "row"),
    [
        (32, 3, False, (0.8097, 0.7532, 0.6788, 0.5529)),
        (32, 3, True, (0.8343, 0.8371, 0.8356, 0.8270)),
        (32, 5, False, (0.8102, 0.7579, 0.6976, 0.6109)),
        (32, 5, True, (0.8342, 0.8370, 0.8362, 0.8317)),
        (128, 3, False, (0.8250, 0.8263, 0.7981, 0.7252)),
        (128, 3, True, (0.7979, 0.8217, 0.8327, 0.8363)),
    ],
)
def test_bianchi_for_his_own_setting(
    window: int, stages: int, rts_cts: bool, row: tuple[float, ...]
) -> None:
    for n, expected in zip((5, 10, 20, 50), row, strict=True):
        value = bianchi_normalized(n, fhss(window, stages), 1023, rts_cts, propagation_delay=1000)
        assert value == pytest.approx(expected, abs=1.01e-4)


@pytest.mark.parametrize(("n", "tau", "p"), [(5, 0.048164, 0.179179), (10, 0.038685, 0.298884)])
def test_bianchi_fixed_point(n: int, tau: float, p: float) -> None:
    assert bianchi_tau(n, 32, 3) == pytest.approx((tau, p), abs=1e-6)
