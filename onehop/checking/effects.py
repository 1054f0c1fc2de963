"""Which action of a robot takes effect at a tick: of a slow robot, one of some ticks before.

An action for tick k of a robot that is d ticks late takes effect at tick k + d; of several that are due
the last one counts, with what all of them hand to the radio. A robot that is stopped does nothing, and
goes on where it was. Whoever leaves leaves nothing behind (docs/faults.md). In real time a robot that
says nothing goes on with its last command for clock.hold_s, and hands over nothing (docs/realtime.md).
"""

from dataclasses import dataclass

from msgspec.structs import replace

from onehop.checking.snapshot import Snapshot
from onehop.contracts.geometry import Twist
from onehop.contracts.messages import Action, Transmission
from onehop.contracts.sections import ClockSection


@dataclass(frozen=True, slots=True)
class Effect:
    """What a robot does at a tick: its motors, and what it hands to its NIC."""

    incarnation: int
    twist: Twist
    speed: float
    remaining_distance: float
    outbox: tuple[Transmission, ...]


class Effects:
    """Keeps actions of slow robots until they are due, and of silent ones as long as they hold."""

    def __init__(self, clock: ClockSection) -> None:
        self._kept: dict[int, list[Action]] = {}
        self._hold_ticks = round(1000 * clock.hold_s / clock.period_ms) if clock.is_realtime else 0
        self._commands: dict[int, tuple[int, Action]] = {}

    def take(self, now: Snapshot) -> dict[int, Effect]:
        """What takes effect at this tick, by robot."""
        actions = {**self._held(now), **now.actions}
        delays = {} if now.truth is None else {one.robot: one.delay_ticks for one in now.truth.slow}
        if not delays and not self._kept:
            return {robot: _all_in_one([action]) for robot, action in actions.items()}
        effects: dict[int, Effect] = {}
        kept, self._kept = self._kept, {}
        for robot, presence in now.present.items():
            waiting = [one for one in kept.get(robot, []) if one.incarnation == presence.incarnation]
            if robot in actions:
                waiting.append(actions[robot])
            due = [one for one in waiting if one.tick + delays.get(robot, 0) <= now.tick]
            if robot in now.stopped:
                due = []
            if due:
                effects[robot] = _all_in_one(due)
            if len(due) < len(waiting):
                self._kept[robot] = waiting[len(due) :]
        return effects

    def _held(self, now: Snapshot) -> dict[int, Action]:
        """Commands that go on at this tick, of robots that say nothing."""
        if not self._hold_ticks:
            return {}
        held = {}
        for presence in now.running():
            robot = presence.robot
            if robot in now.actions:
                self._commands[robot] = now.tick, now.actions[robot]
                continue
            since, command = self._commands.get(robot, (-1, None))
            if command is None or now.tick > since + self._hold_ticks:
                continue
            if command.incarnation == presence.incarnation:
                held[robot] = replace(command, tick=now.tick, outbox=())
        return held


def _all_in_one(actions: list[Action]) -> Effect:
    last = actions[-1]
    outbox = last.outbox
    if len(actions) > 1:
        outbox = tuple(sent for action in actions for sent in action.outbox)
    return Effect(last.incarnation, last.twist, last.speed, last.remaining_distance, outbox)
