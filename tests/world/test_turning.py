"""Sine and cosine of the compiled kernels."""

import math

import numba
from hypothesis import given, settings
from hypothesis import strategies as st

from world_server.core.turning import direction


@settings(deadline=None)
@given(st.floats(-1e3, 1e3))
def test_direction_is_cosine_and_sine(angle: float) -> None:
    ahead, left = direction(angle)
    assert abs(ahead - math.cos(angle)) <= 4e-16
    assert abs(left - math.sin(angle)) <= 4e-16


def test_the_compiler_fuses_no_product_with_a_sum() -> None:
    compiled = numba.njit(direction.py_func)
    compiled(1.0)
    for text in compiled.inspect_asm().values():
        assert "vmulsd" in text or "mulsd" in text
        assert "fmadd" not in text
        assert "fmsub" not in text
