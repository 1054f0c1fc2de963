"""What a map's picture is in memory, whatever format it came from, and how large it may be."""

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from onehop.contracts.errors import MapError

GreyArray: TypeAlias = npt.NDArray[np.uint8]

LARGEST_PICTURE = 1 << 26
"""Pixels of the largest picture that is read, e.g. 8192 x 8192: 410 m square at 5 cm a pixel."""


class Picture(NamedTuple):
    """grey: (rows, columns), 0 black to 255 white, row 0 at the top; alpha likewise, or None."""

    grey: GreyArray
    alpha: GreyArray | None


def check_size(name: str, width: int, height: int) -> None:
    """Raises MapError for a picture without pixels, or with too many."""
    if not (width > 0 and height > 0 and width * height <= LARGEST_PICTURE):
        raise MapError(
            name, f"{width} x {height} pixels", f"at least one, and at most {LARGEST_PICTURE} in all"
        )
