"""One order for everything that is recorded, and the digest over it.

Messages of a tick arrive in an order that differs from run to run. The journal puts them into the
canonical order: by tick, then truth, record, rx by robot, obs by robot, out by robot, and in real time
late and base by robot. Log and digest are made from that alone.
"""

import hashlib
import struct
from collections.abc import Callable, Iterable
from functools import lru_cache
from typing import TypeAlias

from onehop.contracts import topics

WireMessage: TypeAlias = tuple[str, bytes]
"""A bus key without the mission prefix, and the bytes that crossed it."""

_RANK = {"truth": 0, "radio": 1, "rx": 2, "obs": 3, "out": 4, "late": 5, "base": 6}


@lru_cache(maxsize=4096)
def canonical_rank(key: str) -> tuple[int, int]:
    """Where a key's message stands within its tick."""
    stem, _, robot = key.partition("/")
    return _RANK[stem], int(robot or 0)


def keys_of(robots: Iterable[int], bases: Iterable[int] = ()) -> frozenset[str]:
    """Every key that the log of a mission of these robots can have. bases: those with a real one."""
    own = (key(robot) for robot in robots for key in (topics.rx, topics.obs, topics.out))
    return frozenset((topics.TRUTH, topics.RADIO_RECORD, topics.LATE, *own, *map(topics.base, bases)))


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
    """Puts the messages of each tick into order, digests them and hands them on.

    write(tick, messages): called once per tick with its messages in canonical order.
    """

    def __init__(self, write: Callable[[int, list[WireMessage]], None]) -> None:
        self._write = write
        self._digest = Digest()
        self.last_tick = -1

    def add(self, tick: int, messages: list[WireMessage]) -> None:
        """All messages of a tick, in any order; ticks come in theirs."""
        ordered = sorted(messages, key=_rank)
        self._digest.add(tick, ordered)
        self._write(tick, ordered)
        self.last_tick = tick

    def digest(self) -> str:
        """SHA-256 over every tick so far, hexadecimal."""
        return self._digest.hex()


def _rank(message: WireMessage) -> tuple[int, int]:
    return canonical_rank(message[0])
