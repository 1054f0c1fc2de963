"""The team protocol of one robot: whom it obeys, when it gives somebody up, what it sends.

Messages and rules of the thesis (3.3.3 to 3.3.5, 4.3) in both profiles; profile `team` adds epochs,
yielding, merging and joining (team.md). Nothing here moves a robot.

Theory of operation. A robot acts as leader while the roster in force names it. A leader sends a command
to each follower once a period and counts those that do not answer. A follower that hears no leader for
`leader_timeout` elects from the list that it has, and waits for the elected one (`waiting`) before it
gives that one up too. Two leaders that hear each other form the union of their rosters; the union is
the same whoever forms it, and its leader is its median. Whoever finds that a new roster has another
leader tells everyone so in a Lost_Follower command (a hand-over), repeated until that leader is heard.
"""

from collections.abc import Iterable, Sequence

from onehop.contracts.briefings import Briefing
from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import BROADCAST, Reception
from onehop.contracts.team import LossReason, Mode
from robot_agent.core.team.follower_ledger import FollowerLedger
from robot_agent.core.team.modes import ModeEvent
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.standing import NANOSECONDS, Standing
from robot_agent.core.team.team_messages import (
    Ack,
    Beacon,
    Command,
    CommandKind,
    Join,
    MissionPhase,
    decode,
)

ACK_MSDU_BYTES = 60
BEACON_MSDU_BYTES = 100
"""Sizes on the air [B]: the payload of an ordinary team plus the network headers; ours."""

STALE_PERIODS = 2
"""Periods after which a message that was under way means nothing any more: routing may hold one back
for many seconds, and a restarted robot would take it for news."""

HANDOVER_PATIENCE = 2
"""Periods for which a hand-over is repeated before the new leader is given up."""

FOREVER_NS = 2**62


class TeamProtocol(Standing):
    """One robot's side of the team protocol. `receive`, then `speak`, once a tick."""

    def __init__(self, briefing: Briefing, now_ns: int) -> None:
        super().__init__(briefing, now_ns)
        if self.roster is not None and self.roster.leader == self.robot:
            self._lead(now_ns)

    # hearing

    def receive(self, now_ns: int, pose: Pose, in_position: bool, inbox: Iterable[Reception]) -> None:
        """Take the messages of one tick, in the order of their arrival."""
        for reception in inbox:
            try:
                message = decode(reception.payload)
            except DecodeError:
                self.counters["garbled"] += 1
                continue
            source = reception.source
            if source == self.robot or source not in self._known:
                self.counters["foreign"] += 1
            elif now_ns - reception.service_start_ns > STALE_PERIODS * self._period_ns:
                self.counters["stale"] += 1
            elif isinstance(message, Command):
                self._on_command(now_ns, pose, in_position, message, reception)
            elif isinstance(message, Ack):
                if self.leadership is None or not self.leadership.on_ack(source, message):
                    self.counters["stale"] += 1
            elif not self.open:
                self.counters["foreign"] += 1
            elif isinstance(message, Beacon):
                self._on_beacon(now_ns, pose, source, message)
            else:
                self._on_join(now_ns, pose, source, message)

    def _on_command(
        self, now_ns: int, pose: Pose, in_position: bool, command: Command, reception: Reception
    ) -> None:
        source, roster = reception.source, command.roster
        if self.robot not in roster.members or not self._known.issuperset(roster.members):
            self.counters["foreign"] += 1
        elif source != roster.leader:
            self._on_handover(now_ns, source, command)
        elif self._obeys(now_ns, source, roster):
            link = self.link
            link.lane = command.lane
            self._obey(now_ns, roster, command.phase, command.narrow, command.pose)
            link.trail = command.trail or (*link.trail[-15:], (command.pose.x, command.pose.y))
            link.next_ns = now_ns
            duration = max(1, reception.arrival_ns - reception.service_start_ns)
            link.throughput_bps = 8.0 * reception.msdu_bytes * NANOSECONDS / duration
            ack = Ack(self.epoch, command.sequence, in_position, pose)
            self.send(source, ack, ACK_MSDU_BYTES)
        else:
            self._on_lesser_leader(now_ns, pose, source, roster)

    def _obeys(self, now_ns: int, source: int, roster: Roster) -> bool:
        """Whether a roster that its leader speaks for, and that lists this robot, is to be obeyed.

        Differs from team.md: a roster without the leader that this robot hears is not obeyed, whatever
        its epoch, because one robot that was cut off for long would otherwise tear the team apart. The
        two leaders merge as soon as they hear each other.
        """
        mine = self.roster
        if not self.open:
            return self.leadership is None and (mine is None or self.waiting or source == mine.leader)
        if mine is None or roster == mine:
            return True
        followed = self.leadership is None and not self.waiting and self.mode is not Mode.JOINING
        if followed and mine.leader not in roster.members and not self._missed_next(now_ns):
            return False
        if roster.beats(mine):
            return True
        return (self.waiting or self.mode is Mode.JOINING) and roster.epoch >= self.epoch

    def _on_handover(self, now_ns: int, source: int, command: Command) -> None:
        """Lost_Follower from a leader that gives way: the roster names somebody else."""
        roster, mine = command.roster, self.roster
        if command.order is not CommandKind.LOST_FOLLOWER:
            accepted = False
        elif self.open:
            accepted = roster.beats(mine)
        else:
            accepted = mine is not None and source == mine.leader
        if not accepted:
            self.counters["stale"] += 1
        elif roster.leader == self.robot:
            self._adopt(roster)
            self._lead(now_ns)
        else:
            self._adopt(roster)
            self._wait_for_leader(now_ns, self._successor_patience_ns)
            self._told(command.phase, command.narrow)

    def _on_beacon(self, now_ns: int, pose: Pose, source: int, beacon: Beacon) -> None:
        roster = beacon.roster
        if source != roster.leader or not self._known.issuperset(roster.members):
            self.counters["foreign"] += 1
        elif self.robot in roster.members and self._obeys(now_ns, source, roster):
            self._obey(now_ns, roster, beacon.phase, beacon.narrow, beacon.pose)
        elif self.leadership is not None:
            self._on_lesser_leader(now_ns, pose, source, roster)
        elif self.mode is Mode.JOINING or (source == self.leader and roster.beats(self.roster)):
            self._visit(now_ns, pose, source, beacon)
        else:
            self._on_lesser_leader(now_ns, pose, source, roster)

    def _visit(self, now_ns: int, pose: Pose, host: int, beacon: Beacon) -> None:
        """Stay near a leader whose roster lacks this robot, and ask it to be taken in."""
        if self.mode is not Mode.JOINING:
            self.fire(ModeEvent.DISMISSED)
        self.host, self.waiting, self._handover = host, False, None
        self.link.heard_ns, self.link.pose = now_ns, beacon.pose
        self.link.phase, self.link.narrow = beacon.phase, beacon.narrow
        self._patience_ns = self._leader_patience_ns
        self._ask(now_ns, pose, host)

    def _on_lesser_leader(self, now_ns: int, pose: Pose, source: int, roster: Roster) -> None:
        """Another leader is in reach whose roster is not to be obeyed."""
        leadership = self.leadership
        if leadership is not None and self.open:
            if source not in leadership.roster.members:
                self._meet(now_ns, source, roster.epoch, roster.members)
        elif self.open and (self.waiting or self.mode is Mode.JOINING):
            self._ask(now_ns, pose, source)
        else:
            self.counters["stale"] += 1

    def _on_join(self, now_ns: int, pose: Pose, source: int, join: Join) -> None:
        """A robot without a leader calls. Who has missed a Next of the same leader agrees with it."""
        leadership = self.leadership
        if leadership is None:
            missed = self._missed_next(now_ns)
            if missed and not self.waiting and source in self.members and self.mode is not Mode.JOINING:
                self._on_silence(now_ns, pose)
            else:
                self.counters["stale"] += 1
        elif source not in leadership.roster.members:
            self._meet(now_ns, source, join.epoch, (source,))
        elif join.epoch > leadership.roster.epoch:
            self._change_roster(now_ns, leadership.roster.merged(join.epoch, ()), ())
        elif now_ns - leadership.opened_ns >= self._successor_patience_ns // 2:
            leadership.urgent = True

    def _meet(self, now_ns: int, source: int, epoch: int, members: tuple[int, ...]) -> None:
        """A leader met a stranger: take it and those it speaks for in, once it is known well enough."""
        assert self.leadership is not None
        if self._acquaintances.meet(source, now_ns // self._period_ns):
            merged = self.leadership.roster.merged(epoch, members)
            joined = tuple(i for i in merged.members if i not in self.leadership.roster.members)
            self.note("joined", robots=joined, epoch=merged.epoch)
            self._change_roster(now_ns, merged, ())

    # obeying and electing

    def _obey(self, now_ns: int, roster: Roster, phase: MissionPhase, narrow: bool, pose: Pose) -> None:
        """Follow the leader of this roster, whose voice was just heard."""
        if self.leadership is not None:
            self.note("yielded", leader=roster.leader, epoch=roster.epoch)
            self.leadership = None
        if self.roster is None or roster.leader != self.roster.leader:
            self.link.trail = ()
        self._adopt(roster)
        self.waiting = False
        self._patience_ns = self._leader_patience_ns
        link = self.link
        link.heard_ns, link.pose, link.phase, link.narrow = now_ns, pose, phase, narrow
        self._told(phase, narrow)

    def _lead(self, now_ns: int) -> None:
        """Become the leader of the roster in force."""
        assert self.roster is not None
        self.leadership = FollowerLedger(self.robot, self.roster, now_ns)
        self.waiting, self._handover, self.host = False, None, 0
        if self.phase is MissionPhase.SETUP and self.epoch == 0:
            return
        self.phase, self.narrow, self.lane = MissionPhase.DRIVING, False, ()
        self.fire(ModeEvent.ELECTED if len(self.roster.members) > 1 else ModeEvent.LEFT_ALONE)
        self.note("elected", epoch=self.epoch, members=self.roster.members)

    def _change_roster(self, now_ns: int, roster: Roster, lost: tuple[int, ...]) -> None:
        """A leader puts a new roster in force, and gives way if that has another leader."""
        assert self.leadership is not None
        self._adopt(roster)
        self.note("roster", epoch=self.epoch, members=roster.members, lost=lost)
        if roster.leader == self.robot:
            self.leadership.adopt(roster)
            self.leadership.urgent = True
            if self.mode in (Mode.LEADING, Mode.ALONE):
                self.fire(ModeEvent.ELECTED if len(roster.members) > 1 else ModeEvent.LEFT_ALONE)
            return
        command = self._command(
            CommandKind.LOST_FOLLOWER, self.link.pose or Pose(0.0, 0.0, 0.0), lost, ()
        )
        self._wait_for_leader(now_ns, HANDOVER_PATIENCE * self._period_ns)
        self.fire(ModeEvent.GAVE_WAY)
        self._handover = (command, now_ns)

    def keep_clear(self, lane: tuple[tuple[float, float], ...], say: bool) -> None:
        """A leader wants this lane kept clear, none if it is empty. say: now, not at the next period."""
        self.lane = lane
        if say and self.leadership is not None:
            self.leadership.urgent = True

    # speaking

    def speak(self, now_ns: int, pose: Pose, trail: Sequence[tuple[float, float]]) -> None:
        """Everything that is due at this tick: commands, hand-overs, giving up, asking."""
        if self.leadership is not None:
            if now_ns >= self.leadership.due_ns or self.leadership.urgent:
                self.link.pose = pose
            if now_ns >= self.leadership.due_ns:
                self._lead_period(now_ns, pose, trail)
            elif self.leadership.urgent:
                self._speak_to_followers(now_ns, pose, trail, ())
        elif now_ns - self.link.heard_ns >= self._patience_ns:
            self._on_silence(now_ns, pose)
            if self.leadership is not None:
                self.speak(now_ns, pose, trail)
        if self._handover is not None and now_ns >= self._handover[1]:
            command, _ = self._handover
            self._handover = (command, now_ns + self._period_ns) if self.open else None
            others = [i for i in command.roster.members if i != self.robot]
            self.send_to(others, command, self.team.next_msdu_bytes)

    def _lead_period(self, now_ns: int, pose: Pose, trail: Sequence[tuple[float, float]]) -> None:
        leadership = self.leadership
        assert leadership is not None
        unanswered = leadership.close_period(self.team.lost_after)
        missing = self._end_setup(now_ns, leadership) if self.mode is Mode.SETUP else ()
        absent = tuple(i for i in missing if i not in unanswered)
        for robots, reason in (
            (unanswered, LossReason.UNANSWERED),
            (absent, LossReason.NOT_IN_POSITION),
        ):
            if robots:
                self.note("lost_follower", robots=robots, reason=reason.value)
        lost = tuple(sorted(unanswered + absent))
        if lost:
            self._acquaintances.give_up(lost)
            self._change_roster(now_ns, leadership.roster.without(lost), lost)
        if self.leadership is None:
            return
        leadership.open_period(now_ns, self._period_ns)
        self._speak_to_followers(now_ns, pose, trail, lost)

    def _speak_to_followers(
        self, now_ns: int, pose: Pose, trail: Sequence[tuple[float, float]], lost: tuple[int, ...]
    ) -> None:
        """The command to each follower, and the beacon to everyone in range."""
        leadership = self.leadership
        assert leadership is not None
        leadership.next_command(now_ns)
        order = CommandKind.NARROW if self.narrow else CommandKind.NEXT
        if lost or self.lane:
            order = CommandKind.LOST_FOLLOWER if lost else CommandKind.MAKE_ROOM
        command = self._command(order, pose, lost, tuple(trail) if self.open else ())
        self.send_to(leadership.followers, command, self.team.next_msdu_bytes)
        if self.open:
            assert self.roster is not None
            self.send(BROADCAST, Beacon(self.roster, self.phase, self.narrow, pose), BEACON_MSDU_BYTES)

    def _end_setup(self, now_ns: int, leadership: FollowerLedger) -> tuple[int, ...]:
        """Drive off when everyone is in position; after the setup timeout those who are not are lost.

        Returns those who are lost for not being in position.

        Differs: in profile `team` only the silent are lost, because one that answers and is still on its
        way can be led; the thesis loses it.
        """
        missing = leadership.not_in_position()
        late = now_ns - leadership.since_ns >= round(self.team.setup_timeout * NANOSECONDS)
        if missing and not late:
            return ()
        self.phase = MissionPhase.DRIVING
        self.fire(ModeEvent.FORMED)
        if not leadership.followers:
            self.fire(ModeEvent.LEFT_ALONE)
        return () if self.open else missing

    def _command(
        self,
        order: CommandKind,
        pose: Pose,
        lost: tuple[int, ...],
        trail: tuple[tuple[float, float], ...],
    ) -> Command:
        assert self.roster is not None
        assert self.leadership is not None
        sequence = self.leadership.sequence
        return Command(
            order, self.roster, sequence, self.phase, self.narrow, pose, lost, trail, self.lane
        )

    def _on_silence(self, now_ns: int, pose: Pose) -> None:
        """Lost_Leader: the leader, or the one elected in its place, was silent for too long.

        In profile `team` the robot also calls: a leader that still lives takes it in again, and who
        missed the same leader elects at the same time.
        """
        if self.roster is None or self.mode is Mode.JOINING:
            self._go_alone(now_ns)
            return
        silent = self.roster.leader
        self.note("lost_leader", leader=silent)
        self._acquaintances.give_up((silent,))
        if not self.open and self.mode is Mode.LOST_LEADER:
            self._go_alone(now_ns)
            return
        self._adopt(self.roster.without((silent,)))
        if self.roster.leader == self.robot:
            self._lead(now_ns)
        else:
            self.fire(ModeEvent.LEADER_SILENT)
            patience = self._successor_patience_ns if self.open else self._leader_patience_ns
            self._wait_for_leader(now_ns, patience)
            if self.open:
                self.send(BROADCAST, Join(self.epoch, pose), ACK_MSDU_BYTES)

    def _go_alone(self, now_ns: int) -> None:
        """Nobody is left to hear (thesis 3.8.1: stop, or plan to the goal alone)."""
        if not self.open and self.team.orphan == "stop":
            self.fire(ModeEvent.FORSAKEN)
            self._wait_for_leader(now_ns, FOREVER_NS)
            return
        self._adopt(Roster(self.epoch + 1, (self.robot,)))
        self._lead(now_ns)

    def _ask(self, now_ns: int, pose: Pose, leader: int) -> None:
        if now_ns - self._asked_ns >= self._period_ns // 2:
            self._asked_ns = now_ns
            self.send(leader, Join(self.epoch, pose), ACK_MSDU_BYTES)
