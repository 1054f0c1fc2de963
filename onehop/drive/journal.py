"""One order for everything that is recorded, and the digest over it.

A tick's wire messages come from two sides, the world (truth, obs, out) and the radio (ether, rx), in an
arrival order that differs from run to run. The journal joins them into the canonical order: by tick,
then truth, ether, rx by robot, obs by robot, out by robot. Log and digest are made from that alone.
"""

import hashlib
import struct
from collections.abc import Callable
from typing import TypeAlias

WireMessage: TypeAlias = tuple[str, bytes]
"""A bus key without the mission prefix, and the bytes that crossed it."""

_RANK = {"truth": 0, "ether": 1, "rx": 2, "obs": 3, "out": 4}


def canonical_rank(key: str) -> tuple[int, int]:
    """Where a key's message stands within its tick."""
    stem, _, robot = key.partition("/")
    return _RANK[stem], int(robot or 0)


class Digest:
    """SHA-256 over wire messages in canonical order: tick, key, length and bytes of each."""

    def __init__(self) -> None:
        self._sha = hashlib.sha256()

    def add(self, tick: int, messages: list[WireMessage]) -> None:
        """Take in the messages of one tick, already in canonical order."""
        parts = []
        for key, data in messages:
            parts.append(struct.pack("<QI", tick, len(data)))
            parts.append(key.encode())
            parts.append(data)
        self._sha.update(b"".join(parts))

    def hex(self) -> str:
        return self._sha.hexdigest()


class Journal:
    """Joins the two halves of each tick and hands every complete tick on, in order.

    write(tick, messages): called once per complete tick with its messages in canonical order.
    """

    def __init__(self, write: Callable[[int, list[WireMessage]], None]) -> None:
        self._write = write
        self._halves: dict[int, list[WireMessage]] = {}
        self._digest = Digest()
        self.complete = -1

    def add(self, tick: int, messages: list[WireMessage]) -> None:
        """One side's messages of a tick; the second call for a tick completes it."""
        if tick not in self._halves:
            self._halves[tick] = messages
            return
        joined = self._halves.pop(tick) + messages
        joined.sort(key=lambda message: canonical_rank(message[0]))
        self._digest.add(tick, joined)
        self._write(tick, joined)
        self.complete = tick

    def digest(self) -> str:
        """SHA-256 over every complete tick, hexadecimal."""
        return self._digest.hex()

    def rest(self) -> list[tuple[int, list[WireMessage]]]:
        """Halves whose other side never came, by tick: the end of a mission that was cut short."""
        return sorted(self._halves.items())
