"""The team protocol of one robot: whom it obeys, when it gives somebody up, what it sends.

Messages and rules of the thesis (3.3.3 to 3.3.5, 4.3). What profile `team` does otherwise is in
rules.py, how rosters change in election.py. Nothing here moves a robot.

Theory of operation. A robot acts as leader while the roster in force names it. A leader sends a command
to each follower once a period and counts those that do not answer. A follower that hears no leader for
`leader_timeout` elects from the list that it has, and waits for the elected one before it gives that
one up too. Two leaders that hear each other form the union of their rosters; the union is the same
whoever forms it, and its leader is its median. Whoever finds that a new roster has another leader tells
everyone so in a Lost_Follower command (a hand-over), repeated until that leader is heard. All messages
are renewed within a period, so none lives longer; a hand-over that is said once lives for ever.
"""

from collections.abc import Iterable, Sequence

from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.briefings import Briefing
from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import BROADCAST, Note, Reception, Transmission
from onehop.contracts.team import LossReason, Mode
from onehop.contracts.units import nanoseconds
from robot_agent.core.team.election import ACK_MSDU_BYTES, Election
from robot_agent.core.team.events import NextMeasured, NextMissed, TeamEvent
from robot_agent.core.team.leader_view import Points
from robot_agent.core.team.modes import ModeEvent
from robot_agent.core.team.outbox import Outbox
from robot_agent.core.team.part import Answered, Following, Joining, Leading, Waiting
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.rules import Meeting, make_rules
from robot_agent.core.team.state import TeamState
from robot_agent.core.team.team_messages import (
    Ack,
    Beacon,
    Command,
    CommandKind,
    Join,
    MissionPhase,
    decode,
)

BEACON_MSDU_BYTES = 100
"""Size of a beacon on the air [B]: the payload of an ordinary team plus the network headers; ours."""

STALE_PERIODS = 2
"""Periods after which a message that was under way means nothing any more: routing may hold one back
for many seconds, and a restarted robot would take it for news."""


class TeamProtocol:
    """One robot's side of the team protocol. `receive`, then `speak`, once a tick.

    counters: messages that were ignored so far, by why.
    """

    def __init__(self, briefing: Briefing, now_ns: int, pose: Pose) -> None:
        self.robot = briefing.robot
        self.rules = make_rules(briefing.team)
        self.counters = {"garbled": 0, "stale": 0, "foreign": 0}
        self._garbled_from: set[int] = set()
        self._team = briefing.team
        period_ns = nanoseconds(briefing.team.next_period)
        self._outbox = Outbox(ActionLimits(briefing.team.robots), lifetime_ns=period_ns)
        self.state = TeamState(briefing, now_ns, pose, self._outbox)
        self._known = frozenset(briefing.team.robots)
        self._period_ns = period_ns
        self._leader_patience_ns = nanoseconds(briefing.team.leader_timeout)
        self._target_patience_ns = nanoseconds(briefing.team.target_timeout)
        self._election = Election(briefing.team, self.rules, self.state, self._outbox, now_ns)

    # what the rest of the robot takes, once a tick

    def take_events(self) -> tuple[TeamEvent, ...]:
        """What happened since the last call, in order."""
        if not self.state.events:
            return ()
        events, self.state.events = tuple(self.state.events), []
        return events

    def take_outbox(self) -> tuple[Transmission, ...]:
        """What is to be sent."""
        return self._outbox.take_outbox()

    def take_notes(self) -> tuple[Note, ...]:
        """What people are to be told."""
        return self._outbox.take_notes()

    # what the rest of the robot tells it

    def order_column(self, narrow: bool, passage: float | None) -> None:
        """A leader wants a column, or the shape again.

        passage: free width that made it so [m]; None where the team has no other shape.
        """
        if narrow is self.state.narrow:
            return
        self.state.narrow = narrow
        if passage is not None:
            self._outbox.note("narrow" if narrow else "wide", passage=passage)

    def keep_clear(self, lane: Points, now: bool) -> None:
        """A leader wants this lane kept clear, none if it is empty. now: do not wait for the period."""
        part = self.state.part
        if isinstance(part, Leading):
            part.lane = lane
            part.schedule.urgent = part.schedule.urgent or now

    def end_mission(self, arrived: bool) -> None:
        """A leader stands at the goal, or knows that there is no way."""
        self.keep_clear((), False)
        self.state.phase = MissionPhase.FINAL
        self.state.on(ModeEvent.ARRIVED)
        self._outbox.note("arrived" if arrived else "no_way")

    def rest(self) -> None:
        """A follower stands in its last slot."""
        self.state.on(ModeEvent.ARRIVED)

    def report_border(self, follows_border: bool) -> None:
        """Border following interrupts Algorithm 1 and resumes it (thesis 3.3.4)."""
        state = self.state
        if follows_border and state.mode in (Mode.FOLLOWING, Mode.NARROW):
            state.on(ModeEvent.OBSTRUCTED)
        elif not follows_border and state.mode is Mode.BORDER:
            state.on(ModeEvent.CLEARED_NARROW if state.narrow else ModeEvent.CLEARED)

    # hearing

    def receive(self, now_ns: int, pose: Pose, in_position: bool, inbox: Iterable[Reception]) -> None:
        """Take the messages of one tick in the order of arrival. Bad ones are counted, not raised.

        pose, in_position: of this robot, for its acknowledgements.
        """
        for reception in inbox:
            self._on_reception(now_ns, pose, in_position, reception)
        if self._garbled_from:
            self._outbox.note("garbled", robots=tuple(sorted(self._garbled_from)))
            self._garbled_from.clear()
        part = self.state.part
        if isinstance(part, Following):
            part.leader.stands(now_ns, in_position)
        if isinstance(part, Following | Waiting) and part.leader.misses_next(now_ns):
            self.state.events.append(NextMissed())

    def _on_reception(self, now_ns: int, pose: Pose, in_position: bool, reception: Reception) -> None:
        try:
            message = decode(reception.payload)
        except DecodeError:
            self.counters["garbled"] += 1
            self._garbled_from.add(reception.source)
            return
        source = reception.source
        if source == self.robot or source not in self._known:
            self.counters["foreign"] += 1
        elif now_ns - reception.service_start_ns > STALE_PERIODS * self._period_ns:
            self.counters["stale"] += 1
        elif isinstance(message, Command):
            self._on_command(now_ns, pose, in_position, message, reception)
        elif isinstance(message, Ack):
            self._on_ack(now_ns, reception, message)
        elif not self.rules.beacons:
            self.counters["foreign"] += 1
        elif isinstance(message, Beacon):
            self._on_beacon(now_ns, pose, source, message)
        else:
            self._on_join(now_ns, pose, source, message)

    def _obeys(self, now_ns: int, source: int, roster: Roster) -> bool:
        part = self.state.part
        overdue = isinstance(part, Following) and part.leader.is_overdue(now_ns)
        return self.rules.obeys(part, self.state.roster, source, roster, overdue)

    def _on_command(
        self, now_ns: int, pose: Pose, in_position: bool, command: Command, reception: Reception
    ) -> None:
        source, roster = reception.source, command.roster
        if self.robot not in roster.members or not self._known.issuperset(roster.members):
            self.counters["foreign"] += 1
        elif source != roster.leader:
            self._on_handover(now_ns, pose, source, command)
        elif self._obeys(now_ns, source, roster):
            self._on_next(now_ns, pose, in_position, command, reception)
        else:
            self._on_other_leader(now_ns, pose, source, roster)

    def _on_next(
        self, now_ns: int, pose: Pose, in_position: bool, command: Command, reception: Reception
    ) -> None:
        """Next, Narrow, Lost_Follower or Make_Room of the leader that this robot obeys."""
        state = self.state
        leader = state.become_follower(now_ns, command.pose, command.roster)
        leader.lane = command.lane
        leader.on_next(now_ns, command.pose, command.trail)
        state.obey(command.phase, command.narrow, leader.lane)
        state.events.append(NextMeasured(reception.throughput_bps))
        ack = Ack(state.roster.epoch, command.sequence, in_position, pose)
        self._outbox.send(reception.source, ack, ACK_MSDU_BYTES)

    def _on_ack(self, now_ns: int, reception: Reception, ack: Ack) -> None:
        part, source = self.state.part, reception.source
        if not isinstance(part, Leading) or not part.ledger.on_ack(source, ack, part.schedule.sequence):
            self.counters["stale"] += 1
            return
        part.answered[source] = Answered(reception.snr_db, reception.hops, part.told)
        if self.rules.beacons:
            self._election.catch_up(now_ns, part, ack.epoch)

    def _on_handover(self, now_ns: int, pose: Pose, source: int, command: Command) -> None:
        """Lost_Follower from a leader that gives way: the roster names somebody else."""
        state, roster = self.state, command.roster
        accepted = command.kind is CommandKind.LOST_FOLLOWER and self.rules.accepts_handover(
            state.roster, source, roster
        )
        if not accepted:
            self.counters["stale"] += 1
        elif roster.leader == self.robot:
            state.become_leader(now_ns, pose, roster)
        else:
            state.adopt(roster)
            state.become_waiting(now_ns, self.rules.successor_patience_ns, None)
            state.obey(command.phase, command.narrow, ())

    def _on_beacon(self, now_ns: int, pose: Pose, source: int, beacon: Beacon) -> None:
        state, roster = self.state, beacon.roster
        if source != roster.leader or not self._known.issuperset(roster.members):
            self.counters["foreign"] += 1
        elif self.robot in roster.members and self._obeys(now_ns, source, roster):
            leader = state.become_follower(now_ns, beacon.pose, roster)
            state.obey(beacon.phase, beacon.narrow, leader.lane)
        elif isinstance(state.part, Joining) or (
            not isinstance(state.part, Leading)
            and source == state.roster.leader
            and roster.beats(state.roster)
        ):
            state.become_joining(now_ns, source, beacon.pose)
            self._election.ask(now_ns, pose, source)
        else:
            self._on_other_leader(now_ns, pose, source, roster)

    def _on_other_leader(self, now_ns: int, pose: Pose, source: int, roster: Roster) -> None:
        """Another leader is in reach whose roster is not to be obeyed."""
        part = self.state.part
        meeting = self.rules.on_meeting(part, source, self.state.roster)
        if isinstance(part, Leading) and meeting is Meeting.MERGE:
            self._election.merge(now_ns, part, source, roster.epoch, roster.members)
        elif meeting is Meeting.ASK:
            self._election.ask(now_ns, pose, source)
        else:
            self.counters["stale"] += 1

    def _on_join(self, now_ns: int, pose: Pose, source: int, join: Join) -> None:
        """A robot without a leader calls. Who has missed a Next of the same leader agrees with it."""
        state, part = self.state, self.state.part
        if not isinstance(part, Leading):
            agrees = isinstance(part, Following) and part.leader.is_overdue(now_ns)
            if agrees and source in state.roster.members:
                self._election.on_silence(now_ns, pose)
            else:
                self.counters["stale"] += 1
        elif source not in state.roster.members:
            self._election.merge(now_ns, part, source, join.epoch, (source,))
        elif self._election.catch_up(now_ns, part, join.epoch):
            return
        elif now_ns - part.schedule.commanded_ns >= self.rules.successor_patience_ns // 2:
            part.schedule.urgent = True

    # speaking

    def speak(self, now_ns: int, pose: Pose, trail: Sequence[tuple[float, float]]) -> None:
        """Everything that is due at this tick: commands, hand-overs, giving up, asking.

        pose: what followers are to form up on; trail: the way that this robot came as leader [m].
        """
        part = self.state.part
        if not isinstance(part, Leading) and self._gives_up(now_ns, part):
            self._election.on_silence(now_ns, pose)
            part = self.state.part
        if isinstance(part, Leading):
            self._speak_as_leader(now_ns, pose, trail, part)
        self._repeat_handover(now_ns)

    def _gives_up(self, now_ns: int, part: Following | Waiting | Joining) -> bool:
        """Whether the leader was silent for too long.

        Differs: the thesis waits T after the target is reached (4.3); one that cannot reach it would
        wait for ever, so leader_timeout ends every wait.
        """
        view, target_ns = part.leader, self._target_patience_ns
        patience_ns = part.patience_ns if isinstance(part, Waiting) else self._leader_patience_ns
        if target_ns and isinstance(part, Following) and view.silent_at_slot_ns(now_ns) >= target_ns:
            return True
        return now_ns - view.silent_since_ns >= patience_ns

    def _speak_as_leader(
        self, now_ns: int, pose: Pose, trail: Sequence[tuple[float, float]], part: Leading
    ) -> None:
        schedule = part.schedule
        due = now_ns >= schedule.due_ns
        if not due and not schedule.urgent:
            return
        part.told = pose
        lost = self._close_period(now_ns, part) if due else ()
        if self.state.part is not part:
            return
        if due:
            schedule.open_period(now_ns, self._period_ns)
        schedule.next_command(now_ns)
        kind = CommandKind.NARROW if self.state.narrow else CommandKind.NEXT
        if lost or part.lane:
            kind = CommandKind.LOST_FOLLOWER if lost else CommandKind.MAKE_ROOM
        command = self.state.command(part, kind, lost, tuple(trail) if self.rules.trail else ())
        self._outbox.send_to(part.ledger.followers, command, self._team.next_msdu_bytes)
        if self.rules.beacons:
            beacon = Beacon(command.roster, command.phase, command.narrow, pose)
            self._outbox.send(BROADCAST, beacon, BEACON_MSDU_BYTES)

    def _close_period(self, now_ns: int, part: Leading) -> tuple[int, ...]:
        """Give up who did not answer, or did not come to its slot; whom, sorted."""
        silent = part.ledger.close_period(self._team.lost_after)
        absent = self._end_setup(now_ns, part) if self.state.mode is Mode.SETUP else ()
        absent = tuple(i for i in absent if i not in silent)
        for reason, robots in ((LossReason.UNANSWERED, silent), (LossReason.NOT_IN_POSITION, absent)):
            if robots:
                self._outbox.note("lost_follower", robots=robots, reason=reason.value)
        lost = tuple(sorted(silent + absent))
        if lost:
            self._election.change_roster(now_ns, part, self.state.roster.without(lost), lost)
        return lost

    def _end_setup(self, now_ns: int, part: Leading) -> tuple[int, ...]:
        """Drive off when everyone is in position, or setup times out; who is lost then."""
        missing = part.ledger.not_in_position(self.state.roster.epoch)
        late = now_ns - part.schedule.since_ns >= nanoseconds(self._team.setup_timeout)
        if missing and not late:
            return ()
        self.state.form_up()
        return self.rules.lost_at_setup(missing)

    def _repeat_handover(self, now_ns: int) -> None:
        part = self.state.part
        handover = part.handover if isinstance(part, Waiting) else None
        if handover is None or handover.due_ns is None or now_ns < handover.due_ns:
            return
        handover.due_ns = now_ns + self._period_ns if self.rules.repeats_handover else None
        self._outbox.send_to(
            self.state.followers,
            handover.command,
            self._team.next_msdu_bytes,
            None if self.rules.repeats_handover else 0,
        )
