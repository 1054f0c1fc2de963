"""One independent random stream per component, fixed by the run's seed.

Nothing else in the programs may draw randomness: `generator(seed, "robot/3/0")` gives the same stream
in whichever process or driver it is made, and streams of different names are independent.
"""

import numpy as np

from onehop.contracts.arrays import FloatArray

_GRAIN = 1.0 / (1 << 20)
"""Normal numbers are multiples of this: beyond 3.65 the generator takes a logarithm from the C library,
whose last place depends on the processor."""


def generator(seed: int, component: str) -> np.random.Generator:
    """The random stream of one component of one run (PCG64 on a SeedSequence of seed and name)."""
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, *component.encode()])))


def normals(stream: np.random.Generator, count: int) -> FloatArray:
    """Standard normal numbers, (count,), with the same bits on every processor."""
    drawn: FloatArray = np.rint(stream.standard_normal(count) / _GRAIN) * _GRAIN
    return drawn
