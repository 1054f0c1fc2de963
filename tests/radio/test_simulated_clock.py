"""The world's clock as the radio sees it, from messages that took some time."""

import pytest

from radio_proxy.simulated_clock import MEMORY_S, SimulatedClock


def test_the_message_that_took_least_time_tells_what_the_time_is() -> None:
    clock = SimulatedClock(speed=2.0)
    assert not clock.is_set
    for sent_s, delay_s in ((0.0, 0.010), (1.0, 0.001), (2.0, 0.007)):
        clock.on_stamp(round(2.0 * sent_s * 1e9), 500.0 + sent_s + delay_s, anchor=0)
    assert clock.is_set
    assert clock.now_ns(503.001) == pytest.approx(6.0e9, abs=10)
    assert clock.wall_s(round(6.0e9)) == pytest.approx(503.001)


def test_a_clock_that_drifts_is_followed() -> None:
    """100 microseconds a second, for ten minutes."""
    clock = SimulatedClock(speed=1.0)
    for second in range(600):
        clock.on_stamp(second * 10**9, second * 1.0001 + 0.0002, anchor=0)
    error_s = clock.wall_s(600 * 10**9) - 600 * 1.0001
    assert abs(error_s) < 2 * MEMORY_S * 1e-4 + 0.0003


def test_a_clock_that_was_set_back_is_believed_at_once() -> None:
    clock = SimulatedClock(speed=1.0)
    clock.on_stamp(10**9, 1.0, anchor=0)
    clock.on_stamp(10**9, 1.5, anchor=1)
    assert clock.now_ns(1.5) == pytest.approx(10**9, abs=10)
