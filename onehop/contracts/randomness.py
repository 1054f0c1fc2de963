"""One independent random stream per component, fixed by the run's seed.

Nothing else in the programs may draw randomness: `generator(seed, "robot/3/0")` gives the same stream
in whichever process or driver it is made, and streams of different names are independent.
"""

import numpy as np


def generator(seed: int, component: str) -> np.random.Generator:
    """The random stream of one component of one run (PCG64 on a SeedSequence of seed and name)."""
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, *component.encode()])))
