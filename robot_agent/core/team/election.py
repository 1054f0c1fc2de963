"""How the roster of a robot changes: giving up, electing, merging, asking to be taken in (thesis 3.3.5).

The thesis elects without a message: whoever has the same list comes to the same leader. What the two
profiles do otherwise is in rules.py.
"""

from onehop.contracts.geometry import Pose
from onehop.contracts.messages import BROADCAST
from onehop.contracts.sections import TeamSection
from onehop.contracts.serial_numbers import following, newer
from onehop.contracts.units import nanoseconds
from robot_agent.core.team.join_probation import JoinProbation
from robot_agent.core.team.modes import ModeEvent
from robot_agent.core.team.outbox import Outbox
from robot_agent.core.team.part import Handover, Joining, Leading
from robot_agent.core.team.roster import Roster
from robot_agent.core.team.rules import Rules
from robot_agent.core.team.state import TeamState
from robot_agent.core.team.team_messages import CommandKind, Join

ACK_MSDU_BYTES = 60
"""Size of an acknowledgement or Join on the air [B]: its payload plus the network headers; ours."""

HANDOVER_PERIODS = 2
"""Periods for which a hand-over is repeated before the new leader is given up."""

FOREVER_NS = 1 << 62


class Election:
    """Changes of one robot's roster, and what is said about them."""

    def __init__(
        self, team: TeamSection, rules: Rules, state: TeamState, outbox: Outbox, now_ns: int
    ) -> None:
        self._rules = rules
        self._state = state
        self._outbox = outbox
        self._period_ns = nanoseconds(team.next_period)
        self._probation = JoinProbation()
        self._asked_ns = now_ns - self._period_ns

    def merge(
        self, now_ns: int, part: Leading, source: int, epoch: int, members: tuple[int, ...]
    ) -> None:
        """A leader met a stranger: take it and those it speaks for in, once it is known well enough."""
        mine = self._state.roster
        if self._probation.meet(source, now_ns // self._period_ns):
            merged = mine.merged(epoch, members)
            joined = tuple(i for i in merged.members if i not in mine.members)
            self._outbox.note("joined", robots=joined, epoch=merged.epoch)
            self.change_roster(now_ns, part, merged, ())

    def catch_up(self, now_ns: int, part: Leading, epoch: int) -> bool:
        """A member knows of a newer epoch: go on with the same roster above it; whether that was so."""
        if not newer(epoch, self._state.roster.epoch):
            return False
        self.change_roster(now_ns, part, self._state.roster.merged(epoch, ()), ())
        return True

    def change_roster(self, now_ns: int, part: Leading, roster: Roster, lost: tuple[int, ...]) -> None:
        """A leader puts a new roster in force, and gives way if that has another leader.

        One that nobody ever answered is no leader but an orphan (thesis 3.8.1).
        """
        state = self._state
        self._probation.give_up(lost)
        self._outbox.note("roster", epoch=roster.epoch, members=roster.members, lost=lost)
        if len(roster.members) == 1 and self._rules.orphan_stops and not part.ledger.heard:
            state.become_waiting(now_ns, FOREVER_NS, ModeEvent.ORPHANED)
        elif roster.leader == state.robot:
            state.keep_leading(part, roster)
            part.schedule.urgent = True
        else:
            self._give_way(now_ns, part, roster, lost)

    def _give_way(self, now_ns: int, part: Leading, roster: Roster, lost: tuple[int, ...]) -> None:
        """Hand the team over to the leader of this roster."""
        state = self._state
        state.adopt(roster)
        command = state.command(part, CommandKind.LOST_FOLLOWER, lost, ())
        patience_ns = HANDOVER_PERIODS * self._period_ns
        handover = Handover(command, now_ns)
        state.become_waiting(now_ns, patience_ns, ModeEvent.GAVE_WAY, handover)

    def on_silence(self, now_ns: int, pose: Pose) -> None:
        """Lost_Leader: the leader, or one elected in its place, was silent for too long (thesis 3.3.5).

        Each is given up in turn; who is left alone goes on so, or stops (thesis 3.8.1, `orphan`).
        In profile `team` the robot also calls: a leader that still lives takes it in again, and who
        missed the same leader elects at the same time.
        """
        state, silent = self._state, self._state.roster.leader
        rest = Roster(following(state.roster.epoch), (state.robot,))
        if not isinstance(state.part, Joining):
            self._outbox.note("lost_leader", leader=silent)
            self._probation.give_up((silent,))
            rest = state.roster.without((silent,))
        if len(rest.members) == 1 and self._rules.orphan_stops:
            state.become_waiting(now_ns, FOREVER_NS, ModeEvent.ORPHANED)
            return
        if rest.leader == self._state.robot:
            state.become_leader(now_ns, pose, rest)
            return
        state.adopt(rest)
        state.become_waiting(now_ns, self._rules.successor_patience_ns, ModeEvent.LEADER_SILENT)
        if self._rules.calls:
            self._outbox.send(BROADCAST, Join(state.roster.epoch, pose), ACK_MSDU_BYTES)

    def ask(self, now_ns: int, pose: Pose, leader: int) -> None:
        """Ask a leader to be taken in, at most twice a period."""
        if now_ns - self._asked_ns >= self._period_ns // 2:
            self._asked_ns = now_ns
            self._outbox.send(leader, Join(self._state.roster.epoch, pose), ACK_MSDU_BYTES)
