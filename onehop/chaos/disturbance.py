"""What is broken in a mission, and since when it has been quiet: from the truths of its log."""

from onehop.checking.snapshot import Snapshot
from onehop.contracts.messages import Presence, Truth
from onehop.contracts.sections import Point

RECOVERY_S = 3.0
"""How long after its end a fault may still be the reason of a contact: a robot that drove blind, late or
was put elsewhere has to see and to turn first [s]."""


class Disturbance:
    """Watches a mission tick by tick.

    quiet_since: first tick from which on nothing begins or ends to be broken. present: who is there now.
    whole: of these, who runs and is neither held, blind nor slow, nor cut off or fed with garbage.
    graves: places of those who left, until they are back [m]. arrived_at: last tick at which a leader
    said that it had reached the goal, -1 if none has.
    """

    def __init__(self) -> None:
        self.quiet_since = 0
        self.present: tuple[Presence, ...] = ()
        self.whole: set[int] = set()
        self.graves: dict[int, Point] = {}
        self.arrived_at = -1
        self._lost_in_space: dict[int, list[int]] = {}
        self._state: object = None

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        truth = now.truth
        if truth is None:
            return
        here = {one.robot for one in truth.present}
        for one in self.present:
            if one.robot not in here:
                self.graves[one.robot] = one.pose.x, one.pose.y
        for robot in here & self.graves.keys():
            del self.graves[robot]
        self.present = truth.present
        broken = _broken(truth)
        self.whole = here - broken
        state = (
            broken, truth.jams, truth.cuts, truth.corruptions,
            tuple((one.robot, one.incarnation) for one in truth.present),
        )  # fmt: skip
        if state != self._state or truth.faults:
            self._state, self.quiet_since = state, now.tick
        if any(note.kind == "arrived" for action in now.actions.values() for note in action.notes):
            self.arrived_at = now.tick
        for robot in _lost_in_space(truth):
            self._lost_in_space.setdefault(robot, []).append(now.tick)

    def knew_its_way(self, robot: int, tick: int, recovery_ticks: float) -> bool:
        """Whether a robot has seen where it drives for so many ticks, up to this one."""
        ticks = self._lost_in_space.get(robot, [])
        return not any(0 <= tick - blind <= recovery_ticks for blind in ticks)


def _broken(truth: Truth) -> frozenset[int]:
    """Robots that something is wrong with; of a cut those of its smaller side."""
    cut = [min(one.side_a, one.side_b, key=len) for one in truth.cuts]
    corrupted = [one.robots for one in truth.corruptions]
    return frozenset(
        [
            *truth.stopped, *truth.blind,
            *(one.robot for one in truth.slow),
            *(one.robot for one in truth.present if one.held),
            *(robot for robots in (*cut, *corrupted) for robot in robots),
        ]
    )  # fmt: skip


def _lost_in_space(truth: Truth) -> set[int]:
    """Who drives without seeing, later than it sees, or is not where it was."""
    kidnapped = (robot for one in truth.faults if one.kind == "kidnap" for robot in one.robots)
    return {*truth.blind, *(one.robot for one in truth.slow), *kidnapped}
