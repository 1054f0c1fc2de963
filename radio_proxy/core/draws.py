"""Random numbers of the radio, from its one stream, in blocks because single draws are slow."""

import numpy as np

from onehop.contracts.randomness import normals

_BLOCK = 512


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
            self._normal = normals(self._stream, _BLOCK).tolist()
            return self._normal.pop()

    def slots(self, window: int) -> int:
        """A backoff, uniform on 0..window [slots] (802.11-1999, 9.2.4)."""
        return int(self.uniform() * (window + 1))
