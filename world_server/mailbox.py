"""What the others say to the world, and the one way in which it waits for them.

Whoever in this program is spoken to registers a reader. Nothing reads the bus but `Mailbox.wait`, and
every wait ends in time: with what it waited for, at its limit, or since the mission has been broken off.
"""

import time
from collections.abc import Callable

from onehop.node.bus import Bus

POLL_S = 0.1
"""How often a wait for which nothing arrives looks whether the mission has been broken off."""


class MissionBrokenError(Exception):
    """The mission cannot go on. reason: what its outcome will say."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class Mailbox:
    """The world's end of the bus for receiving."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._readers: dict[str, Callable[[bytes], None]] = {}
        self._on_stray: Callable[[str], None] = lambda _: None
        self._break: tuple[float, str] | None = None
        self._mission_is_over = False

    def read(self, name: str, what: str, reader: Callable[[bytes], None]) -> None:
        """Let `reader` take in every message `what` of the process `name`."""
        self._readers[f"{name}/{what}"] = reader

    def read_stray(self, reader: Callable[[str], None]) -> None:
        """Let `reader` know who has said something that nobody here reads."""
        self._on_stray = reader

    def break_off(self, reason: str, after_s: float = 0.0) -> None:
        """Let the next wait raise MissionBrokenError, or the first one after some seconds [s].

        Of several reasons that counts which is due first.
        """
        due = time.monotonic() + after_s
        if not self._mission_is_over and (self._break is None or due < self._break[0]):
            self._break = due, reason

    def call_off(self, reason: str) -> None:
        """What was said to be a reason is none any more."""
        if self._break is not None and self._break[1] == reason:
            self._break = None

    def close_mission(self) -> None:
        """From here on nothing breaks it off any more."""
        self._mission_is_over = True
        self._break = None

    def wait(self, done: Callable[[], bool], limit_s: float) -> bool:
        """Take in messages until done() or until limit_s have passed [s]; whether it is done.

        Raises MissionBrokenError when the mission has been broken off.
        """
        now = time.monotonic()
        deadline = now + limit_s
        while not done():
            if self._break is not None and self._break[0] <= now:
                raise MissionBrokenError(self._break[1])
            if now >= deadline:
                return False
            received = self._bus.receive_by(min(deadline, now + POLL_S))
            if received is not None:
                what, data = received
                reader = self._readers.get(what)
                if reader is None:
                    self._on_stray(what.partition("/")[0])
                else:
                    reader(data)
            now = time.monotonic()
        return True
