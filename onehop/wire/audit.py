"""Holds a log against what it says of itself, while it is read as a whole.

A finished log says how many ticks its mission had and which digest its messages have. Whoever reads all
of it reads it through here, and learns what is missing, too much or not what was said.
"""

from collections.abc import Iterator

from onehop.wire.coverage import TickRow
from onehop.wire.journal import Digest
from onehop.wire.log_reader import LogFile, LoggedTick


class Audit:
    """Reads a log from its first tick to its last.

    flaws: what is wrong with the log, in sentences; complete when ticks() has come to its end.
    """

    def __init__(self, log: LogFile) -> None:
        self._log = log
        self.flaws = list(log.unreadable)

    def ticks(self) -> Iterator[LoggedTick]:
        """Every tick. Raises LogError where the log is damaged."""
        summary = self._log.summary
        row = TickRow(None if summary is None else summary["ticks"])
        sha = Digest()
        for tick in self._log.ticks():
            self._check_keys(tick)
            sha.add(tick.tick, tick.messages)
            row.take(tick.tick, tick.tick)
            yield tick
        row.end()
        self.flaws += row.flaws
        if not row.expected:
            self.flaws.append("it has not one tick")
        elif not self.flaws and summary is not None and summary["digest"] not in (None, sha.hex()):
            self.flaws.append(
                f"its messages are not those of the mission: their digest is {sha.hex()}, "
                f"that of the mission was {summary['digest']}"
            )

    def _check_keys(self, tick: LoggedTick) -> None:
        if len(dict(tick.messages)) < len(tick.messages):
            self.flaws.append(f"tick {tick.tick} has two messages of one channel")


def audit(log: LogFile) -> list[str]:
    """The flaws of a log, found by reading all of it; none when it is what it says it is."""
    check = Audit(log)
    for _ in check.ticks():
        pass
    return check.flaws
