"""How far a campaign is, how fast, and how long it will yet take: on stderr, for people."""

import sys
import time
from typing import Self

from rich.console import Console
from rich.live import Live
from rich.text import Text

from onehop.commands.output import say

PLAIN_S = 10.0
"""Wall-clock time between two plain lines of progress [s]."""


class ProgressLine:
    """One line over itself on a terminal; elsewhere a plain line now and then.

    total: missions that are wanted. Who derives from it says the line.
    """

    def __init__(self, total: int) -> None:
        self._total = total
        self._before = 0
        self._done = 0
        self._started = time.monotonic()
        self._next_plain = self._started + PLAIN_S
        self._live: Live | None = None

    def __enter__(self) -> Self:
        if sys.stderr.isatty():
            self._live = Live(Text("starting …"), console=Console(stderr=True), transient=True)
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Take the line away: what comes now is the end."""
        if self._live is not None:
            self._live.stop()

    def begin(self, before: int) -> None:
        """Start the clock. before: missions that were done by an earlier call."""
        self._before = before
        self._started = time.monotonic()

    def count(self) -> None:
        """One more mission is done."""
        self._done += 1
        now = time.monotonic()
        if self._live is not None:
            self._live.update(Text(self.line()))
        elif now >= self._next_plain:
            self._next_plain = now + PLAIN_S
            say(self.line())

    def put(self, text: str) -> None:
        """Say something else."""
        if self._live is not None:
            self._live.update(Text(text))
        else:
            say(text)

    def line(self) -> str:
        """What is shown after each mission."""
        return self.pace()

    def pace(self) -> str:
        """How many are done, how many a second, and how long the rest takes at this rate."""
        rate = self._done / max(time.monotonic() - self._started, 1e-9)
        done = self._before + self._done
        left = duration((self._total - done) / rate) if rate > 0 else "unknown"
        return f"{done} of {self._total} missions, {rate:.2f} a second, {left} left"


def duration(seconds: float) -> str:
    """A time for people, e.g. "3 min 5 s", "2 h 10 min"."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"
