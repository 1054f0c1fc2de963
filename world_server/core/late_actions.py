"""Actions of slow robots: each takes effect some ticks after the one that it was computed for."""

from collections.abc import Mapping, Set

from msgspec.structs import replace

from onehop.contracts.messages import Action


class LateActions:
    """Keeps actions until their time has come."""

    def __init__(self) -> None:
        self._kept: dict[int, list[Action]] = {}

    def effective(
        self,
        actions: Mapping[int, Action],
        tick: int,
        delays: Mapping[int, int],
        stopped: Set[int],
    ) -> Mapping[int, Action]:
        """What takes effect at `tick`, given the actions that were computed for it.

        delays: of slow robots [ticks].
        Of several that are due the last one counts, with what all of them say. A robot that is slow no
        more has caught up at once; one that is stopped goes on where it was.
        """
        if not delays and not self._kept:
            return actions
        effective = {}
        for robot in sorted({*actions, *self._kept}):
            if robot in stopped:
                continue
            kept = self._kept.pop(robot, [])
            if robot in actions:
                kept.append(actions[robot])
            delay = delays.get(robot, 0)
            due = [action for action in kept if action.tick + delay <= tick]
            if due:
                effective[robot] = _all_in_one(due)
            if len(due) < len(kept):
                self._kept[robot] = kept[len(due) :]
        return effective

    def forget(self, robot: int) -> None:
        """The process of a robot is gone, with all that it has not said yet."""
        self._kept.pop(robot, None)


def _all_in_one(actions: list[Action]) -> Action:
    last = actions[-1]
    if len(actions) == 1:
        return last
    return replace(
        last,
        outbox=tuple(sent for action in actions for sent in action.outbox),
        notes=tuple(note for action in actions for note in action.notes),
    )
