"""Events of a mission that faults may follow, from what the robots say of themselves."""

from collections.abc import Iterator
from typing import NamedTuple

from onehop.contracts.messages import Action


class MissionEvent(NamedTuple):
    """what: a FaultEvent (contracts/fault_section.py). robot: who did it."""

    what: str
    robot: int


class EventDetector:
    """Finds the events in the actions of robots, given in the order in which they take effect."""

    def __init__(self) -> None:
        self._leading: set[int] = set()

    def on_action(self, robot: int, action: Action) -> Iterator[MissionEvent]:
        """What a robot's action tells for the first time."""
        leads = action.status is not None and action.status.leader == robot
        if leads and robot not in self._leading:
            yield MissionEvent("leader elected", robot)
        (self._leading.add if leads else self._leading.discard)(robot)
        for note in action.notes:
            if note.kind in ("narrow", "arrived"):
                yield MissionEvent(note.kind, robot)
            elif note.kind == "mode" and note.data.get("on") == "formed":
                yield MissionEvent("formed", robot)

    def forget(self, robot: int) -> None:
        """The process of a robot is gone."""
        self._leading.discard(robot)
