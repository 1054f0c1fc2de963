"""What was found: how often each invariant was judged, and what breaks it, with evidence."""

from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

KEPT = 20
"""Violations of one invariant that are kept for people; the rest is counted."""


class Exhibit(NamedTuple):
    """One message that shows a violation: its tick, its log channel, and what it says there."""

    tick: int
    topic: str
    says: str


@dataclass(frozen=True, slots=True)
class Violation:
    """One broken promise. tick: where it shows. robots: whom it concerns, sorted."""

    invariant: str
    tick: int
    robots: tuple[int, ...]
    what: str
    evidence: tuple[Exhibit, ...]


@dataclass(slots=True)
class Findings:
    """Collects what the checks find. wanted: invariants that are asked. kept: violations of each.

    checked: how often each was judged. broken: how many violations each has. violations: the first of
    each, in the order in which they were found.
    """

    wanted: frozenset[str]
    kept: int = KEPT
    checked: Counter[str] = field(default_factory=Counter)
    broken: Counter[str] = field(default_factory=Counter)
    violations: list[Violation] = field(default_factory=list)
    _lasting: dict[tuple[str, tuple[int, ...]], int] = field(default_factory=dict)

    def count(self, invariant: str, times: int = 1) -> None:
        """It was judged so many times."""
        self.checked[invariant] += times

    def report(
        self, invariant: str, tick: int, robots: tuple[int, ...], what: str, *evidence: Exhibit
    ) -> None:
        """A violation."""
        if invariant not in self.wanted:
            return
        self.broken[invariant] += 1
        if self.broken[invariant] <= self.kept:
            found = Violation(invariant, tick, tuple(sorted(robots)), what, evidence)
            self.violations.append(found)

    def report_state(
        self, invariant: str, tick: int, robots: tuple[int, ...], what: str, *evidence: Exhibit
    ) -> None:
        """A violation that lasts from tick to tick: it is reported where it begins."""
        key = invariant, tuple(sorted(robots))
        before = self._lasting.get(key)
        self._lasting[key] = tick
        if before is None or tick > before + 1:
            self.report(invariant, tick, robots, what, *evidence)
