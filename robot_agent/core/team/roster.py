"""Rosters: who belongs to the team, who leads it, and which of two rosters is to be obeyed.

The thesis elects without a message: the same list gives the same leader. That breaks when the lists
differ, so every roster carries an epoch, and there is one order over all rosters. The leader of a
roster is always the median of its members; no other leader can be expressed.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from robot_agent.core.team.formation import median_leader


@dataclass(frozen=True, slots=True)
class Roster:
    """A team in one epoch. members: sorted, never empty."""

    epoch: int
    members: tuple[int, ...]

    @property
    def leader(self) -> int:
        """The median of the members (thesis Algorithm 1)."""
        return self.members[(len(self.members) - 1) // 2]

    def key(self) -> tuple[int, int, int, tuple[int, ...]]:
        """CommandKind of obedience: highest epoch, then larger team, then lower leader id.

        Members come last so that two different rosters are never equal.
        """
        return self.epoch, len(self.members), -self.leader, self.members

    def beats(self, other: "Roster | None") -> bool:
        """Whether this roster is to be obeyed rather than the other."""
        return other is None or self.key() > other.key()

    def without(self, lost: Iterable[int]) -> "Roster":
        """The next roster after giving robots up; ValueError if nobody is left."""
        gone = frozenset(lost)
        rest = tuple(i for i in self.members if i not in gone)
        median_leader(rest)
        return Roster(self.epoch + 1, rest)

    def merged(self, epoch: int, others: Iterable[int]) -> "Roster":
        """The roster of both teams together, above the epochs of both.

        Commutative: two leaders that hear each other form the same roster, whoever does it first.
        """
        return Roster(max(self.epoch, epoch) + 1, tuple(sorted({*self.members, *others})))
