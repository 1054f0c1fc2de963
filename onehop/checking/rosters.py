"""Leader, shape and order of rosters, by definition (thesis 3.3, Algorithm 1; docs/modes.md)."""

from statistics import median_low
from typing import NamedTuple

from onehop.contracts.team import Shape

_BITS = 32


def is_newer(a: int, b: int) -> bool:
    """Whether epoch a comes after b: serial numbers of 32 bits (RFC 1982, 3.2).

    The RFC leaves two that lie 2^31 apart undefined; docs/modes.md takes the greater one.
    """
    half = 1 << (_BITS - 1)
    return (a < b and b - a > half) or (a > b and a - b <= half)


class Roster(NamedTuple):
    """Who belongs to a team in one epoch."""

    epoch: int
    members: tuple[int, ...]

    @property
    def leader(self) -> int:
        """The median id, of an even number the lower one."""
        return median_low(self.members)

    def is_larger(self, other: "Roster") -> bool:
        """Of two in one epoch, which is obeyed: the larger, then the lower leader, then by members."""
        mine, its = (len(self.members), -self.leader), (len(other.members), -other.leader)
        return (*mine, self.members) > (*its, other.members)


def shape_for(size: int, narrow: bool) -> Shape:
    """The shape that a team drives in: by its size, or the column of a narrow passage."""
    if size == 1:
        return Shape.SOLO
    if narrow or size == 2:
        return Shape.COLUMN
    if size == 4:
        return Shape.DIAMOND
    return Shape.HEXAGON if size % 2 == 0 else Shape.WEDGE
