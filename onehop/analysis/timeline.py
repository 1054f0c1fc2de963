"""What happened to whom and when: presence, reigns, faults. Read from tables, for figures and text."""

from dataclasses import dataclass

import numpy as np

from onehop.analysis.tables import Table
from onehop.contracts.messages import Reign
from onehop.contracts.scenario import FaultSection


@dataclass(frozen=True, slots=True)
class Departure:
    """A robot that left the mission: when, where it was seen last [m], and why."""

    robot: int
    at_s: float
    x: float
    y: float
    why: str


def departures(poses: Table, left: Table) -> list[Departure]:
    """Everyone who left, in order of time."""
    found = []
    for robot, at_s, why in zip(left["robot"], left["time_s"], left["why"], strict=True):
        own = poses.where((poses["robot"] == robot) & (poses["time_s"] < at_s))
        if len(own):
            place = float(own["x"][-1]), float(own["y"][-1])
            found.append(Departure(int(robot), float(at_s), *place, str(why)))
    return found


def reigns(status: Table) -> list[Reign]:
    """Every roster from the moment its leader began to act on it, in order of time.

    The same rule as the referee's (world_server/core/referee.py), so that a torn log has them too.
    """
    ruling = status.where(status["robot"] == status["leader"])
    found: list[Reign] = []
    before: dict[int, tuple[int, int, tuple[int, ...], str]] = {}
    step = int(np.min(np.diff(np.unique(status["tick"])))) if len(status) > 1 else 1
    for row in range(len(ruling)):
        robot, tick = int(ruling["robot"][row]), int(ruling["tick"][row])
        roster = int(ruling["epoch"][row]), ruling["members"][row], str(ruling["shape"][row])
        last = before.get(robot)
        before[robot] = (tick, *roster)
        if last is None or last[0] < tick - step or last[1:] != roster:
            found.append(Reign(float(ruling["time_s"][row]), robot, *roster))
    return found


def describe_fault(fault: FaultSection) -> str:
    """A scripted fault in words, e.g. "kill 3", "jam within 8 m of (40, 40), 20 s"."""
    who = ", ".join(map(str, fault.robots))
    what = {
        "jam": f"jam within {fault.radius:g} m of ({fault.x:g}, {fault.y:g})",
        "cut": f"cut {who} from {', '.join(map(str, fault.others)) or 'the rest'}",
        "heal": f"heal {who or 'everything'}",
    }.get(fault.kind, f"{fault.kind} {who}")
    return what + (f", {fault.duration_s:g} s" if fault.duration_s else "")
