"""What happened to whom and when: presence, reigns, modes, faults. From tables, for figures and text."""

from dataclasses import dataclass

import numpy as np

from onehop.analysis.columns import Column
from onehop.analysis.tables import Table
from onehop.contracts.messages import LeadershipTerm
from onehop.contracts.sections import FaultSection


@dataclass(frozen=True, slots=True)
class LastSeen:
    """A robot that left the mission: when, where it was seen last [m], and why."""

    robot: int
    at_s: float
    x: float
    y: float
    why: str


@dataclass(frozen=True, slots=True)
class Span:
    """Something that lasted from start_s to end_s [s]."""

    start_s: float
    end_s: float
    what: str


def departures(poses: Table, left: Table) -> list[LastSeen]:
    """Everyone who left, in order of time."""
    found = []
    for robot, at_s, why in zip(left["robot"], left["time_s"], left["why"], strict=True):
        own = poses.where((poses["robot"] == robot) & (poses["time_s"] < at_s))
        if len(own):
            place = float(own["x"][-1]), float(own["y"][-1])
            found.append(LastSeen(int(robot), float(at_s), *place, str(why)))
    return found


def reigns(status: Table) -> list[LeadershipTerm]:
    """Every roster from the moment its leader began to act on it, in order of time.

    The same rule as the referee's (world_server/core/referee.py), so that a torn log has them too.
    """
    ruling = status.where(status["robot"] == status["leader"])
    found: list[LeadershipTerm] = []
    before: dict[int, tuple[int, int, tuple[int, ...], str]] = {}
    step = tick_step(status)
    for row in range(len(ruling)):
        robot, tick = int(ruling["robot"][row]), int(ruling["tick"][row])
        roster = int(ruling["epoch"][row]), ruling["members"][row], str(ruling["shape"][row])
        last = before.get(robot)
        before[robot] = (tick, *roster)
        if last is None or last[0] < tick - step or last[1:] != roster:
            found.append(LeadershipTerm(float(ruling["time_s"][row]), robot, *roster))
    return found


def main_line(status: Table) -> list[LeadershipTerm]:
    """Who led most of the team at each moment: one line of rosters even while the team is split.

    The largest roster that its leader acts on counts; of equal ones the one of the lowest leader id.
    """
    ruling = status.where(status["robot"] == status["leader"])
    size = np.array([len(members) for members in ruling["members"]], dtype=np.int64)
    order = np.lexsort((ruling["robot"], -size, ruling["tick"]))
    _, first = np.unique(ruling["tick"][order], return_index=True)
    found: list[LeadershipTerm] = []
    for row in order[first].tolist():
        reign = LeadershipTerm(
            float(ruling["time_s"][row]), int(ruling["robot"][row]), int(ruling["epoch"][row]),
            ruling["members"][row], str(ruling["shape"][row]),
        )  # fmt: skip
        if not found or _same_rule(found[-1]) != _same_rule(reign):
            found.append(reign)
    return found


def _same_rule(reign: LeadershipTerm) -> tuple[int, int, tuple[int, ...], str]:
    return reign.leader, reign.epoch, reign.members, reign.shape


def tick_step(table: Table) -> int:
    """Ticks between two rows of the same thing."""
    ticks = np.unique(table["tick"])
    return int(np.diff(ticks).min()) if len(ticks) > 1 else 1


def spans(time_s: Column, values: Column, gap_s: float, shortest_s: float = 0.0) -> list[Span]:
    """Stretches of equal value; a gap in time longer than gap_s ends one.

    shortest_s: briefer stretches are taken for a part of the one before them.
    """
    if not len(time_s):
        return []
    breaks = (values[1:] != values[:-1]) | (np.diff(time_s) > gap_s)
    starts = [0, *(np.flatnonzero(breaks) + 1).tolist()]
    ends = [*(row - 1 for row in starts[1:]), len(time_s) - 1]
    found: list[Span] = []
    for first, last in zip(starts, ends, strict=True):
        span = Span(float(time_s[first]), float(time_s[last]), str(values[first]))
        joined = found and span.start_s - found[-1].end_s <= gap_s
        if joined and (span.end_s - span.start_s < shortest_s or span.what == found[-1].what):
            found[-1] = Span(found[-1].start_s, span.end_s, found[-1].what)
        elif joined:
            found[-1] = Span(found[-1].start_s, span.start_s, found[-1].what)
            found.append(span)
        else:
            found.append(span)
    return found


def fault_spans(tables: dict[str, Table], period_s: float) -> list[Span]:
    """Holds, cuts and jams as they were in force, whoever caused them. Tables: poses, cuts, jams."""
    gap_s = 1.5 * period_s
    poses, cuts, jams = tables["poses"], tables["cuts"], tables["jams"]
    held = poses.where(poses["held"])
    found = []
    for robot in np.unique(held["robot"]).tolist():
        own = held.of(robot)
        found += spans(own["time_s"], np.full(len(own), f"hold {robot}"), gap_s)
    names = np.array([f"cut {_ids(a)}" for a in cuts["side_a"]], dtype=np.str_)
    found += _each(cuts["time_s"], names, gap_s)
    names = np.array(
        [
            f"jam at ({x:.0f}, {y:.0f}) m, {r:.0f} m wide"
            for x, y, r in zip(jams["x"], jams["y"], jams["radius"], strict=True)
        ],
        dtype=np.str_,
    )
    found += _each(jams["time_s"], names, gap_s)
    return sorted(found, key=lambda span: (span.start_s, span.what))


def _each(time_s: Column, names: Column, gap_s: float) -> list[Span]:
    found: list[Span] = []
    for name in np.unique(names):
        own = names == name
        found += spans(time_s[own], names[own], gap_s)
    return found


def _ids(robots: tuple[int, ...]) -> str:
    return " ".join(map(str, robots))


def describe_fault(fault: FaultSection) -> str:
    """A scripted fault in words, e.g. "kill 3", "jam within 8 m of (40, 40), 20 s"."""
    who = ", ".join(map(str, fault.robots))
    what = {
        "jam": f"jam within {fault.radius:g} m of ({fault.x:g}, {fault.y:g})",
        "cut": f"cut {who} from {', '.join(map(str, fault.others)) or 'the rest'}",
        "heal": f"heal {who or 'everything'}",
    }.get(fault.kind, f"{fault.kind} {who}")
    return what + (f", {fault.duration_s:g} s" if fault.duration_s else "")
