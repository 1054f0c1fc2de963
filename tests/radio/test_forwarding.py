"""p_r = min(1, (1/v)^gamma) and sequence numbers."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from radio_proxy.core.routing.forwarding import forwarding_probability, gamma

number = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize(
    ("speed", "weight", "expected"),
    [(2, 1, 0.5), (2, 3, 0.125), (0.5, 7, 1.0), (3, 10, 1.69e-5), (0, 4, 1.0), (1, 9, 1.0)],
)
def test_forwarding_probability(speed: float, weight: float, expected: float) -> None:
    """Thesis 3.7.2: (1/v)^gamma."""
    assert forwarding_probability(speed, weight) == pytest.approx(expected, rel=3e-3)


@given(st.floats(0, 1e4), st.floats(0, 1e3), st.floats(1e-2, 1e3))
def test_forwarding_probability_is_one(speed: float, distance: float, scale: float) -> None:
    assert 0.0 <= forwarding_probability(speed, gamma(distance, scale)) <= 1.0


def test_gamma_grows_with_the_distance_to_go() -> None:
    assert [gamma(d, 10.0) for d in (0.0, 10.0, 100.0)] == [0.0, 1.0, 10.0]
