"""A kernel is compiled whether or not there is a place to keep it."""

import numba
import pytest

from onehop.contracts.kernels import kernel


def test_a_kernel_that_cannot_be_kept_is_compiled_all_the_same() -> None:
    """numba finds no folder for a function without a file, as for a user without a home."""
    names: dict[str, object] = {}
    exec("def twice(x):\n    return 2.0 * x\n", names)
    with pytest.raises(RuntimeError, match="cannot cache"):
        numba.njit(cache=True)(names["twice"])
    assert kernel()(names["twice"])(1.5) == 3.0  # type: ignore[type-var]
