"""Payloads that are altered on their way, past every check of the link: a fault, not the channel."""

import numpy as np

from onehop.contracts.messages import Corruption

MOST_BYTES = 8
"""Bytes of one payload that are altered, at most."""


class Corrupter:
    """Alters what robots receive. random: its own stream, so that no other draw of the radio shifts.

    in_force: corruptions of this tick.
    """

    def __init__(self, random: np.random.Generator) -> None:
        self._random = random
        self.in_force: tuple[Corruption, ...] = ()

    def received(self, robot: int, payload: bytes) -> bytes:
        """What a robot gets of a payload: the same, or one with other bytes at some places."""
        probability = max((one.probability for one in self.in_force if robot in one.robots), default=0.0)
        if not payload or not probability > 0.0 or self._random.random() >= probability:
            return payload
        altered = bytearray(payload)
        count = int(self._random.integers(1, MOST_BYTES + 1))
        for place in self._random.integers(0, len(payload), count).tolist():
            altered[place] = payload[place] ^ int(self._random.integers(1, 256))
        return bytes(altered)
