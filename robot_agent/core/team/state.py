"""Where a robot stands in its team: roster, part, mode, phase of the mission; and the ways they change.

Everything here changes by `become_*` and the few methods beside them, and only the protocol calls them.
Part and mode change together, so a mode that its part cannot show does not exist.
"""

from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.serial_numbers import newest
from onehop.contracts.team import Mode
from onehop.contracts.units import nanoseconds
from robot_agent.core.team.events import BecameFollower, BecameLeader, TeamEvent
from robot_agent.core.team.follower_ledger import CommandSchedule, FollowerLedger
from robot_agent.core.team.leader_view import LeaderView, Points
from robot_agent.core.team.modes import RESTART, START, ModeEvent, next_mode
from robot_agent.core.team.outbox import Outbox
from robot_agent.core.team.part import MODES, Following, Handover, Joining, Leading, Part, Waiting
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.team_messages import Command, CommandKind, MissionPhase


class TeamState:
    """One robot's place in its team.

    phase, narrow: what the leader has ordered, or orders itself. events: what the rest of the robot has
    yet to hear of, in order.
    """

    def __init__(self, briefing: Briefing, now_ns: int, pose: Pose, outbox: Outbox) -> None:
        self.robot = briefing.robot
        self.narrow = False
        self.events: list[TeamEvent] = []
        self._outbox = outbox
        self._period_ns = nanoseconds(briefing.team.next_period)
        view = LeaderView(now_ns, self._period_ns)
        self.part: Part
        if briefing.incarnation:
            self.mode, self.phase = RESTART, MissionPhase.DRIVING
            self.roster = Roster(0, (self.robot,))
            self.part = Joining(view, 0)
            return
        self.mode, self.phase = START, MissionPhase.SETUP
        self.roster = Roster(0, briefing.team.robots)
        self.part = self._leading(now_ns, pose) if self._is_mine else Following(view)

    @property
    def _is_mine(self) -> bool:
        """Whether the roster in force names this robot as leader."""
        return self.roster.leader == self.robot

    @property
    def leader(self) -> int:
        """Whom this robot obeys, itself if it leads; 0 for nobody."""
        return self.part.host if isinstance(self.part, Joining) else self.roster.leader

    @property
    def followers(self) -> tuple[int, ...]:
        """Members of the roster but for this robot, sorted."""
        return tuple(i for i in self.roster.members if i != self.robot)

    def on(self, event: ModeEvent) -> None:
        """Go to the mode that the table gives."""
        after = next_mode(self.mode, event)
        if after is self.mode:
            return
        if after not in MODES[type(self.part)]:
            raise LookupError(f"{type(self.part).__name__} cannot be {after.value} ({event.value})")
        self._outbox.note("mode", mode=after.value, was=self.mode.value, on=event.value)
        self.mode = after

    def adopt(self, roster: Roster) -> None:
        """Put a roster in force; the epoch of one robot never goes back."""
        self.roster = Roster(newest(self.roster.epoch, roster.epoch), roster.members)

    def become_leader(self, now_ns: int, pose: Pose, roster: Roster) -> None:
        """Lead this roster, which names this robot, on the way to the goal."""
        self.adopt(roster)
        self.part = self._leading(now_ns, pose)
        self.events.append(BecameLeader())
        self.phase, self.narrow = MissionPhase.DRIVING, False
        self.on(self._election)
        self._outbox.note("elected", epoch=self.roster.epoch, members=self.roster.members)

    def become_follower(self, now_ns: int, pose: Pose, roster: Roster) -> LeaderView:
        """Obey the leader of this roster, whose voice was just heard at this pose; the view of it."""
        if isinstance(self.part, Leading):
            self._outbox.note("yielded", leader=roster.leader, epoch=roster.epoch)
        view = self._view(now_ns)
        if roster.leader != self.roster.leader:
            view.trail = ()
        self.adopt(roster)
        if not isinstance(self.part, Following):
            self.part = Following(view)
        view.on_word(now_ns, pose)
        return view

    def become_waiting(
        self, now_ns: int, patience_ns: int, event: ModeEvent | None, handover: Handover | None = None
    ) -> None:
        """Wait for the leader of the roster in force. event: what that is to the mode, if anything."""
        view = self._view(now_ns)
        view.await_other(now_ns)
        self.part = Waiting(view, patience_ns, handover)
        if event is not None:
            self.on(event)

    def become_joining(self, now_ns: int, host: int, pose: Pose) -> None:
        """Stay near a leader whose roster lacks this robot."""
        view = self._view(now_ns)
        view.on_word(now_ns, pose)
        self.part = Joining(view, host)
        if self.mode is not Mode.JOINING:
            self.on(ModeEvent.LEFT_OUT)

    def keep_leading(self, part: Leading, roster: Roster) -> None:
        """Go on as the leader of another roster."""
        self.adopt(roster)
        part.ledger.adopt(self.followers)
        if self.phase is MissionPhase.DRIVING:
            self.on(self._election)

    def form_up(self) -> None:
        """A leader's setup is over."""
        self.phase = MissionPhase.DRIVING
        self.on(ModeEvent.FORMED)
        if not self.followers:
            self.on(ModeEvent.LEFT_ALONE)

    def obey(self, phase: MissionPhase, narrow: bool, lane: Points) -> None:
        """Do what the leader orders."""
        self.phase, self.narrow = phase, narrow
        if phase is MissionPhase.SETUP:
            self.on(ModeEvent.TOLD_SETUP)
        elif phase is MissionPhase.FINAL and self.mode is Mode.STOPPED:
            return
        elif lane:
            self.on(ModeEvent.TOLD_TO_MAKE_ROOM)
        else:
            self.on(ModeEvent.TOLD_NARROW if narrow else ModeEvent.TOLD_NEXT)

    def command(self, part: Leading, kind: CommandKind, lost: tuple[int, ...], trail: Points) -> Command:
        """What this robot commands as leader now. lost: given up with this roster."""
        return Command(
            kind, self.roster, part.schedule.sequence, self.phase, self.narrow, part.told, lost, trail,
            part.lane,
        )  # fmt: skip

    def _leading(self, now_ns: int, pose: Pose) -> Leading:
        return Leading(FollowerLedger(self.followers), CommandSchedule(now_ns), pose)

    @property
    def _election(self) -> ModeEvent:
        return ModeEvent.ELECTED if self.followers else ModeEvent.LEFT_ALONE

    def _view(self, now_ns: int) -> LeaderView:
        """The view of the leader that this robot has, or a new one for a robot that led until now."""
        if not isinstance(self.part, Leading):
            return self.part.leader
        self.events.append(BecameFollower())
        return LeaderView(now_ns, self._period_ns, self.part.told)
