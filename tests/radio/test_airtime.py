"""Times and bounds of 802.11b against the thesis's equations and published throughputs."""

import pytest

from onehop.contracts.ideal_link import (
    exchange_us,
    frame_us,
    ideal_throughput_bps,
    mean_backoff_us,
    threshold_bps,
)
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.airtime import (
    collision_us,
    delay_ns,
    dsss,
    printed_exchange_us,
    printed_throughput_bps,
)

# Maximum throughput = 8x / (a x + b): rate, a, b basic, b RTS/CTS, then Mb/s at 800 B.
BOUNDS = [
    (1.0, 8.0, 1138.0, 1814.0, 0.8490, 0.7792),
    (2.0, 4.0, 1002.0, 1678.0, 1.5231, 1.3120),
    (5.5, 1.45455, 915.45, 1591.45, 3.0783, 2.3230),
    (11.0, 0.72727, 890.73, 1566.73, 4.3462, 2.9788),
]


def test_control_frames_take_what_the_standard_says() -> None:
    """RTS 352 us, CTS and ACK 304 us, mean backoff 310 us (802.11-1999; thesis eq. 3.18, 3.19, 3.21)."""
    timing = dsss(RadioSection())
    assert (timing.rts, timing.cts, timing.ack) == (352_000, 304_000, 304_000)
    assert mean_backoff_us() == 310.0


@pytest.mark.parametrize(("rate", "a", "basic", "rts", "at_800_basic", "at_800_rts"), BOUNDS)
def test_maximum_throughput_of_every_rate(
    rate: float, a: float, basic: float, rts: float, at_800_basic: float, at_800_rts: float
) -> None:
    for size in (100, 512, 800, 1500):
        assert exchange_us(rate, size, rts_cts=False) == pytest.approx(a * size + basic, rel=1e-5)
        assert exchange_us(rate, size, rts_cts=True) == pytest.approx(a * size + rts, rel=1e-5)
    assert ideal_throughput_bps(rate, 800, rts_cts=False) == pytest.approx(at_800_basic * 1e6, rel=1e-4)
    assert ideal_throughput_bps(rate, 800, rts_cts=True) == pytest.approx(at_800_rts * 1e6, rel=1e-4)


@pytest.mark.parametrize(
    ("size", "basic", "rts"), [(100, 0.4128, 0.3060), (512, 0.7826, 0.6931), (1500, 0.9134, 0.8687)]
)
def test_maximum_throughput_at_1_mbps_over_size(size: int, basic: float, rts: float) -> None:
    assert ideal_throughput_bps(1.0, size, rts_cts=False) / 1e6 == pytest.approx(basic, abs=5e-5)
    assert ideal_throughput_bps(1.0, size, rts_cts=True) / 1e6 == pytest.approx(rts, abs=5e-5)


def test_equation_3_16_as_printed_has_no_ack() -> None:
    """7900 us and .8101 Mb/s, against 8214 us and .7792 with the full exchange."""
    assert printed_exchange_us(1.0, 800) == pytest.approx(7900.0)
    assert printed_throughput_bps(1.0, 800) == pytest.approx(0.8101e6, rel=1e-4)
    assert exchange_us(1.0, 800) == pytest.approx(8214.0)


def test_propagation_delay_enters_as_often_as_printed() -> None:
    """Three times in eq. 3.16, once in eq. 3.17, four times in the full exchange."""
    assert printed_exchange_us(1.0, 800, 1.0) - printed_exchange_us(1.0, 800) == pytest.approx(3.0)
    assert collision_us(1.0) - collision_us() == pytest.approx(1.0)
    assert exchange_us(1.0, 800, propagation_us=1.0) - exchange_us(1.0, 800) == pytest.approx(4.0)


def test_collision_costs_rts_difs_and_backoff() -> None:
    """Thesis eq. 3.17: 352 + 50 + 310 us."""
    assert collision_us() == pytest.approx(712.0)


def test_delay_is_distance_over_the_speed_of_light() -> None:
    """Thesis eq. 3.22: 300 m take a microsecond."""
    assert delay_ns(299.792458) == 1000


def test_data_frames_grow_with_the_header_and_shrink_with_the_rate() -> None:
    """192 + 8 (34 + x) / R us (thesis eq. 3.20)."""
    assert dsss(RadioSection()).data(800) == 6_864_000
    assert dsss(RadioSection(mac_header_bytes=28)).data(800) == 6_816_000
    assert dsss(RadioSection(rate_mbps=11.0)).data(800) == pytest.approx(
        frame_us(834, 11.0) * 1000, abs=1
    )
    assert dsss(RadioSection(rate_mbps=11.0)).broadcast(800) == 6_864_000


def test_threshold_is_the_thesis_share_of_the_ideal() -> None:
    """0.5333 Mb/s at 1 Mb/s and 800 B, the same share elsewhere (f = 0.684)."""
    assert threshold_bps(1.0, 800) == pytest.approx(533_300.0)
    assert threshold_bps(11.0, 800) / ideal_throughput_bps(11.0, 800) == pytest.approx(0.684, abs=5e-4)


def test_windows_double_up_to_the_limit() -> None:
    """CW_i = min(32 * 2^i - 1, 1023) (802.11-1999, 9.2.4)."""
    timing = dsss(RadioSection())
    assert [timing.window(i) for i in range(7)] == [31, 63, 127, 255, 511, 1023, 1023]
