"""Wakes up a process that waits for messages at an instant of the clock, exact to some 0.1 ms.

A wait of Zenoh's channel has no time limit. A thread of this process sleeps until the instant, and then
puts a message into the same channel.
"""

import math
import threading
import time
from collections.abc import Callable


class Alarm:
    """Calls `ring` once for each instant that it is asked for, from a thread of its own.

    Whoever waits asks again after it has rung. An instant behind the one that is being waited for is not
    remembered: the earlier one rings first.
    """

    def __init__(self, ring: Callable[[], None]) -> None:
        self._ring = ring
        self._due = math.inf
        self._changed = threading.Condition()
        self._ended = False
        self._thread = threading.Thread(target=self._watch, name="alarm", daemon=True)
        self._thread.start()

    def ring_by(self, due: float) -> None:
        """Ring at an instant (time.monotonic() [s]) or before."""
        if due < self._due:
            with self._changed:
                self._due = due
                self._changed.notify()

    def end(self) -> None:
        """Ring no more; returns when nothing rings."""
        with self._changed:
            self._ended = True
            self._changed.notify()
        self._thread.join()

    def _watch(self) -> None:
        while True:
            with self._changed:
                while not self._ended and (left := self._due - time.monotonic()) > 0.0:
                    self._changed.wait(None if left == math.inf else min(left, threading.TIMEOUT_MAX))
                if self._ended:
                    return
                self._due = math.inf
            self._ring()
