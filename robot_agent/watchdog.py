"""Finds a program that does not come back from its step, says where it is, and ends its process.

It looks some times in the time that a robot has, from a thread of its own, and counts its looks instead
of going by the clock: in a process that was stopped meanwhile it has not looked. A program that holds
Python's interpreter lock, in machine code, holds this thread too: then the world gives the robot up.
"""

import contextlib
import sys
import threading
import time
from collections.abc import Callable, Iterator

from onehop.programs.host import ProgramError, hang_of

PATIENCE = 0.8
"""Share of the world's patience after which a step has hung: the robot itself can say where."""

_LOOKS = 10


class Watchdog:
    """Watches the thread that makes it. silence_s: the world's patience [s]. on_hang: told of a hang."""

    def __init__(self, silence_s: float, on_hang: Callable[[ProgramError], None]) -> None:
        self._steps = 0  # begun and ended, both counted: odd within a step
        self._limit_s = PATIENCE * silence_s
        self._on_hang = on_hang
        self._watched = threading.get_ident()
        threading.Thread(target=self._watch, name="watchdog", daemon=True).start()

    @contextlib.contextmanager
    def watching(self) -> Iterator[None]:
        """A step, from its begin to its end."""
        self._steps += 1
        try:
            yield
        finally:
            self._steps += 1

    def _watch(self) -> None:
        before, looks = 0, 0
        while looks < _LOOKS:
            time.sleep(self._limit_s / _LOOKS)
            now = self._steps
            looks = looks + 1 if now == before and now % 2 else 0
            before = now
        self._on_hang(hang_of(sys._current_frames()[self._watched], self._limit_s))
