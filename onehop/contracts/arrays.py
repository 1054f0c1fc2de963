"""Names of the array types that contracts, programs and tools share."""

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
Ranges: TypeAlias = npt.NDArray[np.float32]
"""A laser scan: (n_beams,) [m]; +inf where nothing is in range (REP 117)."""
