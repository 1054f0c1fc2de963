"""Which action of a robot takes effect at a tick: of a slow robot, one of some ticks before.

An action for tick k of a robot that is d ticks late takes effect at tick k + d; of several that are due
the last one counts, with what all of them hand to the radio. A robot that is stopped does nothing, and
goes on where it was. Whoever leaves leaves nothing behind (docs/faults.md).
"""

from dataclasses import dataclass

from onehop.checking.snapshot import Snapshot
from onehop.contracts.geometry import Twist
from onehop.contracts.messages import Action, Transmission


@dataclass(frozen=True, slots=True)
class Effect:
    """What a robot does at a tick: its motors, and what it hands to its NIC."""

    incarnation: int
    twist: Twist
    speed: float
    remaining_distance: float
    outbox: tuple[Transmission, ...]


class Effects:
    """Keeps actions of slow robots until they are due."""

    def __init__(self) -> None:
        self._kept: dict[int, list[Action]] = {}

    def take(self, now: Snapshot) -> dict[int, Effect]:
        """What takes effect at this tick, by robot."""
        delays = {} if now.truth is None else {one.robot: one.delay_ticks for one in now.truth.slow}
        if not delays and not self._kept:
            return {robot: _all_in_one([action]) for robot, action in now.actions.items()}
        effects: dict[int, Effect] = {}
        kept, self._kept = self._kept, {}
        for robot, presence in now.present.items():
            waiting = [one for one in kept.get(robot, []) if one.incarnation == presence.incarnation]
            if robot in now.actions:
                waiting.append(now.actions[robot])
            due = [one for one in waiting if one.tick + delays.get(robot, 0) <= now.tick]
            if robot in now.stopped:
                due = []
            if due:
                effects[robot] = _all_in_one(due)
            if len(due) < len(waiting):
                self._kept[robot] = waiting[len(due) :]
        return effects


def _all_in_one(actions: list[Action]) -> Effect:
    last = actions[-1]
    outbox = last.outbox
    if len(actions) > 1:
        outbox = tuple(sent for action in actions for sent in action.outbox)
    return Effect(last.incarnation, last.twist, last.speed, last.remaining_distance, outbox)
