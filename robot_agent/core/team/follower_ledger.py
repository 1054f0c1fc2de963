"""What a leader keeps about its followers: who answered, where each last was, when commands are due."""

from robot_agent.core.team.team_messages import Ack


class CommandSchedule:
    """When a leader speaks: once a period, and at once when something urgent changed in between.

    since_ns: start of the leadership. due_ns: start of the next period. commanded_ns: of the last
    commands. sequence: counts them; an acknowledgement names it. urgent: say it now.
    """

    def __init__(self, now_ns: int) -> None:
        self.since_ns = now_ns
        self.due_ns = now_ns
        self.commanded_ns = now_ns
        self.sequence = 0
        self.urgent = False

    def open_period(self, now_ns: int, period_ns: int) -> None:
        """A period begins."""
        self.due_ns = now_ns + period_ns

    def next_command(self, now_ns: int) -> int:
        """Commands go out now; their sequence number."""
        self.sequence += 1
        self.commanded_ns = now_ns
        self.urgent = False
        return self.sequence


class FollowerLedger:
    """Answers of the followers of one leader, from its election to its end.

    reports: the last acknowledgement of each, by robot. heard: somebody has answered ever.
    """

    def __init__(self, followers: tuple[int, ...]) -> None:
        self.followers: tuple[int, ...] = ()
        self.reports: dict[int, Ack] = {}
        self.heard = False
        self._answered: dict[int, bool] = {}
        self._misses: dict[int, int] = {}
        self.adopt(followers)

    def adopt(self, followers: tuple[int, ...]) -> None:
        """Go on with these followers, sorted; who stays keeps its record."""
        self.followers = followers
        self._misses = {i: self._misses.get(i, 0) for i in followers}
        self._answered = {i: self._answered.get(i, True) for i in followers}
        self.reports = {i: self.reports[i] for i in followers if i in self.reports}

    def on_ack(self, source: int, ack: Ack, sequence: int) -> bool:
        """Take an acknowledgement; False if it is nobody's, or names a command after the last one.

        sequence: of the last command.
        """
        if source not in self._answered or ack.sequence > sequence:
            return False
        self._answered[source] = self.heard = True
        known = self.reports.get(source)
        if known is None or ack.sequence >= known.sequence:
            self.reports[source] = ack
        return True

    def close_period(self, lost_after: int) -> tuple[int, ...]:
        """Count who did not answer since the last whole period began; who is lost by now.

        Only whole periods count: nobody can have answered what was just said.
        """
        for robot, answered in self._answered.items():
            self._misses[robot] = 0 if answered else self._misses[robot] + 1
        self._answered = dict.fromkeys(self._answered, False)
        return tuple(i for i in self.followers if self._misses[i] >= lost_after)

    def not_in_position(self, epoch: int) -> tuple[int, ...]:
        """Followers that have not reported to be in their slot of the roster of this epoch."""
        return tuple(
            i
            for i in self.followers
            if (report := self.reports.get(i)) is None or not report.in_position or report.epoch != epoch
        )
