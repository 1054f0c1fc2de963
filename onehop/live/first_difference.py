"""Where two logs begin to differ, for the page that shows them side by side."""

import threading
from collections.abc import Callable
from typing import Any

from onehop.analysis.difference import Comparison, compare
from onehop.analysis.log import Log
from onehop.contracts.errors import LogError
from onehop.contracts.printable import printable

LONGEST_VALUE = 60
"""Letters of a value that differs that are shown."""

MOST_KEYS = 3
"""Keys of two scenarios that are named."""


class FirstDifference:
    """Looked for in a thread of its own: it reads both logs from end to end.

    found: None until then; at, its time [s] or None, and what differs, in words.
    """

    def __init__(self, a: Log, b: Log) -> None:
        self._a, self._b = a, b
        self.found: dict[str, Any] | None = None

    def start(self, changed: Callable[[], None]) -> None:
        """Begin to look; `changed` is called when it is found."""
        threading.Thread(target=self._look, args=(changed,), name="difference", daemon=True).start()

    def _look(self, changed: Callable[[], None]) -> None:
        try:
            self.found = told(compare(self._a, self._b), self._a.period_ns / 1e9)
        except LogError as error:
            self.found = {"at": None, "words": f"They cannot be compared: {printable(str(error))}"}
        changed()


def told(found: Comparison, period_s: float) -> dict[str, Any]:
    """A comparison as the page shows it."""
    keys = [printable(key, LONGEST_VALUE) for key, _, _ in found.scenario]
    more = f" and {len(keys) - MOST_KEYS} more" if len(keys) > MOST_KEYS else ""
    scenarios = f" Their scenarios differ in {', '.join(keys[:MOST_KEYS])}{more}." if keys else ""
    first = found.first
    if first is None:
        return {"at": None, "words": f"The logs are the same in all of {found.ticks} ticks.{scenarios}"}
    at_s = first.tick * period_s
    if not first.channel:
        words = "one of the logs ends"
    else:
        a, b = (printable(repr(value), LONGEST_VALUE) for value in (first.a, first.b))
        words = f"{first.channel}, {printable(first.field, LONGEST_VALUE)}: {a} and {b}"
    return {
        "at": at_s,
        "words": f"First difference at {at_s:.2f} s, tick {first.tick}: {words}.{scenarios}",
    }
