"""Rosters: who belongs to the team, who leads it, and which of two rosters is to be obeyed.

The thesis elects without a message: the same list gives the same leader. That breaks when the lists
differ, so every roster carries an epoch, and there is one order over all rosters. The leader of a
roster is always the median of its members; no other leader can be expressed.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from onehop.contracts.serial_numbers import following, newer, towards
from robot_agent.core.team.formation import median_leader


@dataclass(frozen=True, slots=True)
class Roster:
    """A team in one epoch, a serial number. members: sorted, never empty."""

    epoch: int
    members: tuple[int, ...]

    @property
    def leader(self) -> int:
        """The median of the members (thesis Algorithm 1)."""
        return self.members[(len(self.members) - 1) // 2]

    def beats(self, other: "Roster") -> bool:
        """Whether this roster is to be obeyed rather than the other.

        The newer epoch, then the larger team, then the lower leader id; members come last so that of two
        different rosters always one beats the other.
        """
        if self.epoch != other.epoch:
            return newer(self.epoch, other.epoch)
        return self._rank() > other._rank()

    def _rank(self) -> tuple[int, int, tuple[int, ...]]:
        return len(self.members), -self.leader, self.members

    def without(self, lost: Iterable[int]) -> "Roster":
        """The next roster after giving robots up; ValueError if nobody is left."""
        gone = frozenset(lost)
        rest = tuple(i for i in self.members if i not in gone)
        median_leader(rest)
        return Roster(following(self.epoch), rest)

    def merged(self, epoch: int, others: Iterable[int]) -> "Roster":
        """The roster of both teams together, above the epochs of both.

        Commutative: two leaders that hear each other form the same roster, whoever does it first. Of
        epochs that no two teams come to by themselves the older one follows in steps.
        """
        return Roster(following(towards(self.epoch, epoch)), tuple(sorted({*self.members, *others})))
