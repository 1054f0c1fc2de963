"""Which ticks a log covers: one row from 0 to the end of the mission, or what is missing in it."""

from collections.abc import Iterable, Iterator

from onehop.wire.contents import Stretch
from onehop.wire.log_writer import LOG_EPOCH_NS


class TickRow:
    """Takes ticks in the order of the log, and says what is wrong with their row.

    total: how many there were when the mission ended, None when nobody knows.
    """

    def __init__(self, total: int | None) -> None:
        self._total = total
        self.expected = 0
        self.flaws: list[str] = []

    def take(self, first: int, last: int) -> None:
        """Ticks first..last. A tick may lie in two stretches: it may begin where the last one ended."""
        if first > self.expected:
            self._miss(self.expected, first - 1)
        elif first < self.expected - 1 or last < first:
            self.flaws.append(f"tick {first} comes after tick {self.expected - 1}")
        self.expected = max(self.expected, last + 1)

    def end(self) -> None:
        """No tick follows."""
        if self._total is None:
            return
        if self.expected < self._total:
            self._miss(self.expected, self._total - 1)
        elif self.expected > self._total:
            self.flaws.append(f"it has {self.expected} ticks, and its mission had {self._total}")

    def _miss(self, first: int, last: int) -> None:
        which = f"tick {first} is" if first == last else f"ticks {first}..{last} are"
        self.flaws.append(f"{which} missing{'' if self._total is None else f' of {self._total}'}")


def coverage_flaws(stretches: Iterable[Stretch], period_ns: int, total: int | None) -> Iterator[str]:
    """What the heads of a log's stretches say about its ticks, without reading them."""
    row = TickRow(total)
    for stretch in stretches:
        if not stretch.last_ns:
            continue
        first, off_first = divmod(stretch.first_ns - LOG_EPOCH_NS, period_ns)
        last, off_last = divmod(stretch.last_ns - LOG_EPOCH_NS, period_ns)
        if first < 0 or off_first or off_last:
            yield f"the times in the head of the record at byte {stretch.at} are those of no tick"
        else:
            row.take(first, last)
    row.end()
    yield from row.flaws
