"""How long a robot outside the roster must be heard before it is taken in: the damping of rejoining."""

from collections.abc import Iterable
from dataclasses import dataclass

LONGEST_PROBATION = 3
"""Periods in a row that a robot which comes and goes must be heard before it is taken in again."""


@dataclass(slots=True)
class Hearing:
    """A robot outside the roster that was heard. streak: periods in a row; last_period: their last."""

    streak: int
    last_period: int


class JoinProbation:
    """Who was heard outside the roster, and how often each was given up.

    A robot that was given up n times must be heard in min(1 + n, 3) periods in a row. At the edge of
    the radio it comes and goes, and the team would change shape at every period otherwise.
    """

    def __init__(self) -> None:
        self._heard: dict[int, Hearing] = {}
        self._given_up: dict[int, int] = {}

    def give_up(self, robots: Iterable[int]) -> None:
        """Remember that these robots were lost once more."""
        for robot in robots:
            self._given_up[robot] = self._given_up.get(robot, 0) + 1
            self._heard.pop(robot, None)

    def meet(self, robot: int, period: int) -> bool:
        """Heard `robot` in this period; whether it has been heard for long enough to be taken in."""
        known = self._heard.get(robot)
        if known is None or period - known.last_period > 1:
            known = self._heard[robot] = Hearing(1, period)
        elif period > known.last_period:
            known.streak += 1
            known.last_period = period
        return known.streak >= min(1 + self._given_up.get(robot, 0), LONGEST_PROBATION)
