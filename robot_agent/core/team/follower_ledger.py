"""What a leader keeps about its followers and about strangers: answers, reports, acquaintances."""

from collections.abc import Iterable
from dataclasses import dataclass

from robot_agent.core.team.roster import Roster
from robot_agent.core.team.team_messages import Ack

LONGEST_PROBATION = 3
"""Periods in a row that a robot which comes and goes must be heard before it is taken in again."""


@dataclass(slots=True)
class Acquaintance:
    """A robot outside the roster that was heard. streak: periods in a row; last_period: their last."""

    streak: int
    last_period: int


class FollowerLedger:
    """Bookkeeping of one leader, from its election to its end."""

    def __init__(self, robot: int, roster: Roster, now_ns: int) -> None:
        self.robot = robot
        self.roster = roster
        self.sequence = 0
        self.since_ns = now_ns
        self.opened_ns = now_ns
        self.due_ns = now_ns
        self.urgent = False
        self.reports: dict[int, Ack] = {}
        self._answered: dict[int, bool] = {}
        self._misses: dict[int, int] = {}
        self.adopt(roster)

    @property
    def followers(self) -> tuple[int, ...]:
        """Members but for the leader, sorted."""
        return tuple(i for i in self.roster.members if i != self.robot)

    def adopt(self, roster: Roster) -> None:
        """Go on with another roster; who stays keeps its record."""
        self.roster = roster
        followers = self.followers
        self._misses = {i: self._misses.get(i, 0) for i in followers}
        self._answered = {i: self._answered.get(i, True) for i in followers}
        self.reports = {i: self.reports[i] for i in followers if i in self.reports}

    def on_ack(self, source: int, ack: Ack) -> bool:
        """Take an acknowledgement; False if it is nobody's or names a command that was never given."""
        if source not in self._answered or ack.sequence > self.sequence:
            return False
        self._answered[source] = True
        known = self.reports.get(source)
        if known is None or ack.sequence >= known.sequence:
            self.reports[source] = ack
        return True

    def close_period(self, lost_after: int) -> tuple[int, ...]:
        """Count who did not answer since the last commands; the followers that are lost by now."""
        for robot, answered in self._answered.items():
            self._misses[robot] = 0 if answered else self._misses[robot] + 1
        return tuple(i for i in self.followers if self._misses[i] >= lost_after)

    def open_period(self, now_ns: int, period_ns: int) -> None:
        """Answers are counted anew from here."""
        self.due_ns = now_ns + period_ns
        self._answered = dict.fromkeys(self._answered, False)

    def next_command(self, now_ns: int) -> None:
        """Commands go out now, at their time or because something urgent changed in between.

        Only whole periods count for missing answers: nobody can have answered what was just said.
        """
        self.sequence += 1
        self.opened_ns = now_ns
        self.urgent = False

    def not_in_position(self) -> tuple[int, ...]:
        """Followers that have not reported to be in their slot of the roster in force."""
        return tuple(
            i
            for i in self.followers
            if (report := self.reports.get(i)) is None
            or not report.in_position
            or report.epoch != self.roster.epoch
        )


class JoinProbation:
    """Who was heard outside the roster, and when it may be taken in: the damping of rejoining.

    A robot that was given up n times must be heard in min(1 + n, 3) periods in a row. At the edge of
    the radio it comes and goes, and the team would change shape at every period otherwise.
    """

    def __init__(self) -> None:
        self._known: dict[int, Acquaintance] = {}
        self._given_up: dict[int, int] = {}

    def give_up(self, robots: Iterable[int]) -> None:
        """Remember that these robots were lost once more."""
        for robot in robots:
            self._given_up[robot] = self._given_up.get(robot, 0) + 1
            self._known.pop(robot, None)

    def meet(self, robot: int, period: int) -> bool:
        """Heard `robot` in this period; whether it has been heard for long enough to be taken in."""
        known = self._known.get(robot)
        if known is None or period - known.last_period > 1:
            known = self._known[robot] = Acquaintance(1, period)
        elif period > known.last_period:
            known.streak += 1
            known.last_period = period
        return known.streak >= min(1 + self._given_up.get(robot, 0), LONGEST_PROBATION)
