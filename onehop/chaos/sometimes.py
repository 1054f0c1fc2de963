"""What should happen in some mission of a campaign: what never does has not been tried by it."""

from collections import Counter
from collections.abc import Iterator, Mapping

from onehop.checking.snapshot import Snapshot
from onehop.contracts.fault_section import KINDS
from onehop.contracts.messages import Action, DeliveryStatus, Truth
from onehop.contracts.team import Mode, Shape, Status

_NOTES = {
    "elected": "a robot is elected leader",
    "yielded": "a leader gives way to a better one",
    "joined": "a leader takes robots in",
    "lost_follower": "a leader gives a follower up",
    "lost_leader": "a follower gives its leader up",
    "narrow": "a leader orders a column for a passage",
    "wide": "a team leaves its column",
    "garbled": "a garbled message is found out",
    "no_way": "a leader finds no way",
    "arrived": "a leader reaches the goal",
}

_HURRY = "a follower hurries for want of throughput"
_TWO = "two act as leaders at once"
_THREE = "three act as leaders at once"
_RELAYED = "a message is relayed"
_LEADERLESS = "nobody acts as leader"
_DIED_LEADING = "a leader dies"
_DIED_ELECTED = "a leader dies within a Next period of its election"
_DIED_COLUMN = "a leader dies in a column"
_FAULT_IN_SETUP = "a fault begins during setup"

_LOST = {
    status: f"a message is lost: {status.value}" for status in DeliveryStatus if status != "delivered"
}
_MODES = {mode: f"a robot is in mode {mode.value}" for mode in Mode}
_SHAPES = {shape: f"a team drives as {shape.value}" for shape in Shape}
_FAULTS = {kind: f"a fault of kind {kind} begins" for kind in KINDS}

SOMETIMES: tuple[str, ...] = (
    *_NOTES.values(), _TWO, _THREE, _LEADERLESS, _DIED_LEADING, _DIED_ELECTED, _DIED_COLUMN,
    _FAULT_IN_SETUP, _HURRY, _RELAYED, *_LOST.values(), *_MODES.values(),
    *_SHAPES.values(), *_FAULTS.values(),
)  # fmt: skip
"""Everything that is looked for."""

_SOON_TICKS = 40
"""A Next period of 2 s, in ticks of 50 ms: what the name of its property says, nearly."""


class Sometimes:
    """Watches a mission tick by tick. seen: how often each happened."""

    def __init__(self) -> None:
        self.seen: Counter[str] = Counter()
        self._elected: dict[int, int] = {}
        self._before: dict[int, Status] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        if now.truth is not None:
            self.seen.update(self._of_truth(now, now.truth))
        statuses = _statuses(now.actions)
        for robot, action in now.actions.items():
            self.seen.update(self._of_notes(now.tick, robot, action))
        for robot, status in statuses.items():
            self.seen.update(self._of_status(robot, status))
        leaders = sum(status.leader == robot for robot, status in statuses.items())
        self.seen[_LEADERLESS] += bool(statuses) and not leaders
        self.seen[_TWO] += leaders == 2
        self.seen[_THREE] += leaders >= 3
        if now.record is not None:
            for verdict in now.record.verdicts:
                if verdict.status in _LOST:
                    self.seen[_LOST[verdict.status]] += 1
                elif len(verdict.path) > 2:
                    self.seen[_RELAYED] += 1
        self._before = statuses

    def _of_truth(self, now: Snapshot, truth: Truth) -> Iterator[str]:
        setup = any(status.mode is Mode.SETUP for status in self._before.values())
        for fault in truth.faults:
            yield _FAULTS[fault.kind]
            if setup:
                yield _FAULT_IN_SETUP
        for gone in truth.departures:
            status = self._before.get(gone.robot)
            if status is None or status.leader != gone.robot:
                continue
            yield _DIED_LEADING
            if now.tick - self._elected.get(gone.robot, -_SOON_TICKS) < _SOON_TICKS:
                yield _DIED_ELECTED
            if status.shape is Shape.COLUMN and len(status.members) > 2:
                yield _DIED_COLUMN

    def _of_status(self, robot: int, status: Status) -> Iterator[str]:
        before = self._before.get(robot)
        if before is None or before.mode is not status.mode:
            yield _MODES[status.mode]
        if before is None or before.shape is not status.shape:
            yield _SHAPES[status.shape]
        if 0.0 <= status.throughput_bps < status.threshold_bps:
            yield _HURRY

    def _of_notes(self, tick: int, robot: int, action: Action) -> Iterator[str]:
        for note in action.notes:
            if note.kind in _NOTES:
                yield _NOTES[note.kind]
            if note.kind == "elected":
                self._elected[robot] = tick


def _statuses(actions: Mapping[int, Action]) -> dict[int, Status]:
    """What robots say of their teams, of those that have one."""
    return {robot: action.status for robot, action in actions.items() if action.status is not None}
