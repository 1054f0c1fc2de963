"""What asks a program to end: Ctrl-C, SIGTERM, and SIGHUP when its terminal closes.

Outside of a mission they are an exception. During one they are noted, so that nothing is
torn that has to be finished; whoever runs the mission looks and ends it in order.
"""

import signal
import time
from collections.abc import Callable
from typing import Any, NoReturn, Self

ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Stopped(BaseException):
    """This program was asked to end; no mistake, and not to be caught as one. number: of the signal."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def _raise(number: int, _: object) -> NoReturn:
    raise Stopped(number)


def raise_when_asked_to_end() -> None:
    """Let each of these signals raise Stopped from here on."""
    _handle(_raise)


def _handle(handler: Callable[[int, object], None]) -> dict[signal.Signals, Any]:
    """Install a handler; gives those before. What is ignored (nohup, background jobs) stays so."""
    previous = {number: signal.getsignal(number) for number in ENDS}
    changed = {number: old for number, old in previous.items() if old is not signal.SIG_IGN}
    for number in changed:
        signal.signal(number, handler)
    return changed


class StopRequest:
    """Whether this program has been asked to end, while it is entered.

    number: the first such signal, None before it. at_s: when it came (time.monotonic() [s]).
    """

    def __init__(self) -> None:
        self.number: int | None = None
        self.at_s = 0.0
        self._previous: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Self:
        self._previous = _handle(self._note)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)

    def _note(self, number: int, _: object) -> None:
        if self.number is None:
            self.number, self.at_s = number, time.monotonic()

    def obey(self) -> None:
        """Raise Stopped if the program has been asked to end."""
        if self.number is not None:
            raise Stopped(self.number)
