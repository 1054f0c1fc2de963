"""How far a search may go without coming closer to the goal, and when it must end.

The record is the least distance to the goal that the robot ever had. It is broken by steps of one
inflation, so there are finitely many records, and each gives the search its whole budget back.
"""

from onehop.contracts.sections import PlannerSection

LONGEST = 2000.0
"""Way without breaking the record after which the robot gives up without proof, in laser ranges. It is
there so that an answer comes even if rounding keeps a boundary from closing; no way of the campaigns was
that long."""

LEAST_SPENT = 0.5
"""What a planning moment spends at least, in inflations: also a search that stands still ends."""


class SearchBudget:
    """The budget of one search. distance: to the goal at its start [m].

    record: least distance to the goal [m]. spent: way since the record was broken [m]. allowed: way
    that the search by frontiers may spend, `longest`: that all of it may [m].
    """

    def __init__(self, section: PlannerSection, laser_range: float, distance: float) -> None:
        self.record = distance
        self.spent = 0.0
        self.allowed = section.patience * laser_range
        self.longest = LONGEST * laser_range
        self._inflation = section.inflation
        self._to_break = distance

    @property
    def exhausted(self) -> bool:
        """Has the search by frontiers spent what it may?"""
        return self.spent > self.allowed

    @property
    def hopeless(self) -> bool:
        """Is it time to give up without proof?"""
        return self.spent > self.longest

    def spend(self, moved: float) -> None:
        """The robot is `moved` metres from where it was at the last planning moment."""
        self.spent += max(moved, LEAST_SPENT * self._inflation)

    def compare(self, distance: float) -> bool:
        """Keep the record with a distance to the goal [m]; says whether it was broken."""
        self.record = min(self.record, distance)
        if self.record >= self._to_break - self._inflation:
            return False
        self._to_break, self.spent = self.record, 0.0
        return True
