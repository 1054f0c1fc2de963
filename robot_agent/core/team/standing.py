"""Where a robot stands in its team: mode, roster, leader, and whom it waits for. State, no rules."""

from onehop.contracts.briefings import Briefing
from onehop.contracts.team import Mode
from robot_agent.core.team.follower_ledger import FollowerLedger, JoinProbation
from robot_agent.core.team.leader_view import LeaderView
from robot_agent.core.team.modes import RESTART, START, ModeEvent, next_mode
from robot_agent.core.team.outbox import Outbox
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.team_messages import Command, MissionPhase

NANOSECONDS = 1_000_000_000


class Standing(Outbox):
    """The state of the protocol, and the few ways in which it changes."""

    def __init__(self, briefing: Briefing, now_ns: int) -> None:
        super().__init__()
        team = briefing.team
        self.robot = briefing.robot
        self.team = team
        self.open = team.profile == "team"
        self._known = frozenset(team.robots)
        self._period_ns = round(team.next_period * NANOSECONDS)
        self._leader_patience_ns = round(team.leader_timeout * NANOSECONDS)
        self._successor_patience_ns = round(team.successor_timeout * NANOSECONDS)
        self.mode: Mode = START if briefing.incarnation == 0 else RESTART
        self.roster: Roster | None = Roster(0, team.robots) if self.mode is START else None
        self.epoch = 0
        self.phase = MissionPhase.SETUP if self.mode is START else MissionPhase.DRIVING
        self.narrow = False
        self.lane: tuple[tuple[float, float], ...] = ()
        self.link = LeaderView(now_ns)
        self.host = 0
        self.waiting = False
        self.leadership: FollowerLedger | None = None
        self.counters = {"garbled": 0, "stale": 0, "foreign": 0}
        self._patience_ns = self._leader_patience_ns
        self._acquaintances = JoinProbation()
        self._handover: tuple[Command, int] | None = None
        self._asked_ns = -self._period_ns

    # what the rest of the robot asks

    @property
    def leading(self) -> bool:
        """Whether this robot acts as leader."""
        return self.leadership is not None

    @property
    def leader(self) -> int:
        """Whom this robot obeys, itself if it leads; 0 for nobody."""
        if self.mode is Mode.JOINING:
            return self.host
        return self.roster.leader if self.roster is not None else 0

    @property
    def members(self) -> tuple[int, ...]:
        """The roster in force, or this robot alone while it has none."""
        return self.roster.members if self.roster is not None else (self.robot,)

    def fire(self, event: ModeEvent) -> None:
        """Go to the mode that the table gives."""
        after = next_mode(self.mode, event)
        if after is not self.mode:
            self.note("mode", mode=after.value, was=self.mode.value, on=event.value)
            self.mode = after

    def _missed_next(self, now_ns: int) -> bool:
        """Whether the leader was silent for more than a period and a quarter."""
        return now_ns - self.link.heard_ns > self._period_ns * 5 // 4

    def _adopt(self, roster: Roster) -> None:
        self.epoch = max(self.epoch, roster.epoch)
        self.roster = roster if roster.epoch == self.epoch else Roster(self.epoch, roster.members)
        self._handover = None

    def _told(self, phase: MissionPhase, narrow: bool) -> None:
        self.phase, self.narrow = phase, narrow
        if phase is MissionPhase.SETUP:
            self.fire(ModeEvent.TOLD_SETUP)
        elif phase is MissionPhase.DRIVING or self.mode is not Mode.STOPPED:
            if self.link.lane:
                self.fire(ModeEvent.TOLD_TO_MAKE_ROOM)
            else:
                self.fire(ModeEvent.TOLD_NARROW if narrow else ModeEvent.TOLD_NEXT)

    def _wait_for_leader(self, now_ns: int, patience_ns: int) -> None:
        self.leadership = None
        self.waiting = True
        self.link.heard_ns = now_ns
        self.link.trail = self.link.lane = ()
        self._patience_ns = patience_ns
