"""Compiled kernels: kept on disk from run to run where there is a place for them."""

from collections.abc import Callable
from typing import Any, TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(**options: Any) -> Callable[[Function], Function]:
    """numba.njit with these options, cached if that is possible.

    numba keeps what it compiles beside the source or in the user's cache folder, and raises
    RuntimeError where neither can be written: a package folder of root's, a user without a home.
    """

    def compiled(function: Function) -> Function:
        try:
            made: Function = numba.njit(cache=True, **options)(function)
        except RuntimeError:
            made = numba.njit(**options)(function)
        return made

    return compiled
