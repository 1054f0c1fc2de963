"""`median`, `shape` and `epochs`: what every robot says of its roster, and what leaders command."""

from dataclasses import dataclass

from onehop.checking.findings import Exhibit, Findings
from onehop.checking.invariants import EPOCHS, MEDIAN, SHAPE
from onehop.checking.payloads import HANDOVER, Order, order_in
from onehop.checking.rosters import Roster, is_newer, shape_for
from onehop.checking.snapshot import Snapshot
from onehop.contracts import topics
from onehop.contracts.messages import Action
from onehop.contracts.sections import TeamSection
from onehop.contracts.team import Mode, Status
from onehop.contracts.units import nanoseconds

STALE_PERIODS = 2
"""A message that was under way for more Next periods than this is not obeyed (docs/modes.md)."""


@dataclass(slots=True)
class _Memory:
    """What is known of one process. heard: it has heard the leader of its roster since it obeys it.

    narrow: whether it leads in column; None where that cannot be known.
    """

    incarnation: int
    status: Status
    heard: bool = False
    narrow: bool | None = None


class Team:
    """Judges rosters, robot by robot."""

    def __init__(self, findings: Findings, team: TeamSection) -> None:
        self._findings = findings
        self._has_epoch_rules = team.profile == "team"
        self._stale_ns = STALE_PERIODS * nanoseconds(team.next_period)
        self._memory: dict[int, _Memory] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        before, self._memory = self._memory, {}
        if now.follows:
            self._memory = {robot: before[robot] for robot in now.stopped if robot in before}
        for robot, action in now.actions.items():
            if action.status is None:
                continue
            known = before.get(robot) if now.follows else None
            if known is not None and known.incarnation != action.incarnation:
                known = None
            orders = self._orders_heard(now, robot)
            self._judge_median(now, robot, action, action.status)
            self._judge_epoch(now, robot, action.status, known, orders)
            narrow = self._judge_shape(now, robot, action, action.status, known, orders)
            heard = self._has_heard(action.status, known, orders)
            self._memory[robot] = _Memory(action.incarnation, action.status, heard, narrow)

    def _orders_heard(self, now: Snapshot, robot: int) -> list[tuple[int, Order]]:
        """Source and content of the commands and beacons that reach a robot, in order of arrival."""
        inbox = now.inboxes.get(robot)
        if inbox is None or not inbox.receptions:
            return []
        return [
            (one.source, order)
            for one in inbox.receptions
            if inbox.time_ns - one.service_start_ns <= self._stale_ns
            and (order := order_in(one.payload)) is not None
        ]

    @staticmethod
    def _has_heard(status: Status, known: _Memory | None, orders: list[tuple[int, Order]]) -> bool:
        mine = Roster(status.epoch, status.members)
        if known is not None and known.heard and mine == (known.status.epoch, known.status.members):
            return True
        return any(source == status.leader and order.roster == mine for source, order in orders)

    # median

    def _judge_median(self, now: Snapshot, robot: int, action: Action, status: Status) -> None:
        if status.mode is not Mode.JOINING:  # who joins has no roster, and stays near any leader
            self._findings.count(MEDIAN)
            leader = Roster(status.epoch, status.members).leader
            if status.leader != leader:
                what = f"robot {robot} obeys robot {status.leader}; the median of its team is {leader}"
                self._findings.report_state(MEDIAN, now.tick, (robot,), what, now.status_of(robot))
        for order in _orders_given(action):
            self._findings.count(MEDIAN)
            leader, members = order.roster.leader, order.roster.members
            is_handover = order.word == HANDOVER and robot in members
            if robot != leader and not is_handover:
                what = f"robot {robot} commands a team whose median is robot {leader}"
                said = now.exhibit(topics.out(robot), str(order))
                self._findings.report(MEDIAN, now.tick, (robot,), what, said)

    # shape

    def _judge_shape(
        self,
        now: Snapshot,
        robot: int,
        action: Action,
        status: Status,
        known: _Memory | None,
        orders: list[tuple[int, Order]],
    ) -> bool | None:
        """Whether the robot leads in column, as far as that can be known."""
        self._findings.count(SHAPE)
        size = len(status.members)
        narrow: bool | None = None
        if status.leader == robot:
            narrow = self._narrow_of_leader(robot, action, status.members, known)
        else:
            for source, order in orders:
                if source == status.leader and order.roster == (status.epoch, status.members):
                    narrow = order.narrow
        open_shape, column = shape_for(size, False), shape_for(size, True)
        allowed = {open_shape, column} if narrow is None else {column if narrow else open_shape}
        if status.shape not in allowed:
            asked = " or ".join(sorted(shape.value for shape in allowed))
            what = f"robot {robot} drives as {status.shape.value}; {size} robots are to drive as {asked}"
            evidence = [now.status_of(robot), *_as_exhibits(now, robot, orders)]
            self._findings.report_state(SHAPE, now.tick, (robot,), what, *evidence)
        if size <= 2:
            return None  # a team that has no other shape says nothing of the passage
        return status.shape is column if narrow is None else narrow

    @staticmethod
    def _narrow_of_leader(
        robot: int, action: Action, members: tuple[int, ...], known: _Memory | None
    ) -> bool | None:
        """A new leader leads in the open; after that its notes and its commands tell."""
        narrow = known.narrow if known is not None else None
        if known is not None and known.status.leader != robot:
            narrow = False
        for note in action.notes:
            if note.kind in ("narrow", "wide"):
                narrow = note.kind == "narrow"
        for order in _orders_given(action):
            if order.roster.members == members:
                narrow = order.narrow
        return narrow

    # epochs

    def _judge_epoch(
        self,
        now: Snapshot,
        robot: int,
        status: Status,
        known: _Memory | None,
        orders: list[tuple[int, Order]],
    ) -> None:
        for order in _orders_given(now.actions[robot]):
            if order.roster.members == status.members and order.roster.epoch != status.epoch:
                what = f"robot {robot} commands in epoch {order.roster.epoch}, and is in {status.epoch}"
                said = now.exhibit(topics.out(robot), str(order))
                self._findings.report(EPOCHS, now.tick, (robot,), what, said, now.status_of(robot))
        if known is None:
            return
        self._findings.count(EPOCHS)
        before, wrong = known.status, None
        if is_newer(before.epoch, status.epoch):
            wrong = f"the epoch of robot {robot} goes back from {before.epoch} to {status.epoch}"
        elif self._has_epoch_rules and status.epoch == before.epoch:
            wrong = self._wrong_change(robot, status, known, orders)
        if wrong is not None:
            evidence = [_exhibit_of(now.tick - 1, robot, before), now.status_of(robot)]
            evidence += _as_exhibits(now, robot, orders)
            self._findings.report(EPOCHS, now.tick, (robot,), wrong, *evidence)

    @staticmethod
    def _wrong_change(
        robot: int, status: Status, known: _Memory, orders: list[tuple[int, Order]]
    ) -> str | None:
        """Within one epoch a robot goes over to another roster only if it hears it, to a better one.

        Who hears that its leader has left it out joins any team, and keeps its own epoch if it is newer.
        """
        before = known.status
        if _same_team(before, status) or Mode.JOINING in (before.mode, status.mode):
            return None
        mine = Roster(status.epoch, status.members)
        is_left_out = any(
            source == before.leader and robot not in order.roster.members for source, order in orders
        )
        told = [order.roster for _, order in orders]
        if mine not in told and not (is_left_out and mine.members in [one.members for one in told]):
            return f"robot {robot} changes its roster within epoch {status.epoch} and was not told so"
        settled = (known.heard and not is_left_out) or before.leader == robot
        if settled and not mine.is_larger(Roster(before.epoch, before.members)):
            return f"robot {robot} leaves its roster for one that is not to be preferred"
        return None


def _orders_given(action: Action) -> list[Order]:
    """The commands and beacons that a robot hands to its NIC, each once."""
    if not action.outbox:
        return []
    payloads = dict.fromkeys(one.payload for one in action.outbox)
    return [order for payload in payloads if (order := order_in(payload)) is not None]


def _same_team(a: Status, b: Status) -> bool:
    return a.members == b.members


def _as_exhibits(now: Snapshot, robot: int, orders: list[tuple[int, Order]]) -> list[Exhibit]:
    return [now.exhibit(topics.rx(robot), f"from robot {source}: {order}") for source, order in orders]


def _exhibit_of(tick: int, robot: int, status: Status) -> Exhibit:
    says = f"epoch {status.epoch}, leader {status.leader} of {' '.join(map(str, status.members[:40]))}"
    return Exhibit(tick, topics.wire(topics.out(robot)), says)
