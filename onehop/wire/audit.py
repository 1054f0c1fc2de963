"""Holds a log against what it says of itself, while it is read as a whole.

A finished log says how many ticks its mission had and which digest its messages have. Whoever reads all
of it reads it through here, and learns what is missing, too much or not what was said.
"""

from collections.abc import Iterator

from onehop.contracts.printable import printable
from onehop.wire.coverage import TickRow
from onehop.wire.journal import Digest
from onehop.wire.log_reader import LogFile, LoggedTick


class Audit:
    """Reads a log from its first tick to its last."""

    def __init__(self, log: LogFile) -> None:
        self._log = log
        self._row = TickRow(None if log.summary is None else log.summary["ticks"])
        self._flaws = list(log.unreadable)

    @property
    def flaws(self) -> list[str]:
        """What is wrong with what has been read so far, in sentences."""
        return [*self._flaws, *self._row.flaws]

    def ticks(self) -> Iterator[LoggedTick]:
        """Every tick; at the end, their number and digest are checked. Raises LogError."""
        sha, row = Digest(), self._row
        for tick in self._log.ticks():
            self._check_keys(tick)
            sha.add(tick.tick, tick.messages)
            row.take(tick.tick, tick.tick)
            yield tick
        row.end()
        if not row.expected:
            self._flaws.append("it has not one tick")
        elif not self.flaws:
            self._compare(sha.hex())

    def _compare(self, found: str) -> None:
        summary = self._log.summary
        if summary is not None and summary["digest"] not in (None, found):
            self._flaws.append(
                f"its messages are not those of the mission: their digest is {found}, "
                f"that of the mission was {printable(summary['digest'], len(found))}"
            )

    def _check_keys(self, tick: LoggedTick) -> None:
        if len(dict(tick.messages)) < len(tick.messages):
            self._flaws.append(f"tick {tick.tick} has two messages of one channel")


def audit(log: LogFile) -> list[str]:
    """The flaws of a log, found by reading all of it; none when it is what it says it is."""
    check = Audit(log)
    for _ in check.ticks():
        pass
    return check.flaws
