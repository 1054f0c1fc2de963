"""Random numbers of the radio, from its one stream, in blocks because single draws are slow."""

import numpy as np

_BLOCK = 512

_GRAIN = 1.0 / (1 << 20)
"""Normal numbers are multiples of this: beyond 3.65 the generator takes a logarithm from the C library,
whose last place depends on the processor."""


class Draws:
    """Uniform and normal draws of one generator, each in the order in which the events need them."""

    def __init__(self, stream: np.random.Generator) -> None:
        self._stream = stream
        self._uniform: list[float] = []
        self._normal: list[float] = []

    def uniform(self) -> float:
        """A number in [0, 1)."""
        try:
            return self._uniform.pop()
        except IndexError:
            self._uniform = self._stream.random(_BLOCK).tolist()
            return self._uniform.pop()

    def normal(self) -> float:
        """A standard normal number."""
        try:
            return self._normal.pop()
        except IndexError:
            drawn = self._stream.standard_normal(_BLOCK)
            self._normal = (np.rint(drawn / _GRAIN) * _GRAIN).tolist()
            return self._normal.pop()

    def slots(self, window: int) -> int:
        """A backoff, uniform on 0..window [slots] (802.11-1999, 9.2.4)."""
        return int(self.uniform() * (window + 1))
