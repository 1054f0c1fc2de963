"""Where a robot stands in its team: mode, roster, leader, and whom it waits for. State, no rules."""

from onehop.contracts.scenario import Briefing
from onehop.contracts.team import Mode
from robot_agent.core.leading import Acquaintances, Leadership
from robot_agent.core.link import Link
from robot_agent.core.messages import Command, Phase
from robot_agent.core.modes import RESTART, START, Event, next_mode
from robot_agent.core.outbox import Outbox
from robot_agent.core.roster import Roster

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
        self.phase = Phase.SETUP if self.mode is START else Phase.DRIVING
        self.narrow = False
        self.lane: tuple[tuple[float, float], ...] = ()
        self.link = Link(now_ns)
        self.host = 0
        self.waiting = False
        self.leadership: Leadership | None = None
        self.counters = {"garbled": 0, "stale": 0, "foreign": 0}
        self._patience_ns = self._leader_patience_ns
        self._acquaintances = Acquaintances()
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

    def fire(self, event: Event) -> None:
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

    def _told(self, phase: Phase, narrow: bool) -> None:
        self.phase, self.narrow = phase, narrow
        if phase is Phase.SETUP:
            self.fire(Event.TOLD_SETUP)
        elif phase is Phase.DRIVING or self.mode is not Mode.STOPPED:
            if self.link.lane:
                self.fire(Event.TOLD_TO_MAKE_ROOM)
            else:
                self.fire(Event.TOLD_NARROW if narrow else Event.TOLD_NEXT)

    def _wait_for_leader(self, now_ns: int, patience_ns: int) -> None:
        self.leadership = None
        self.waiting = True
        self.link.heard_ns = now_ns
        self.link.trail = self.link.lane = ()
        self._patience_ns = patience_ns
