"""What happened to whom and when: departures, leaders, modes, faults; for figures and text."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np
from msgspec.structs import replace

from onehop.analysis.columns import Column
from onehop.analysis.tables import Table
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.leadership import LeadershipHistory
from onehop.contracts.messages import LeadershipTerm


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
    for robot, at_s, why in left.rows("robot", "time_s", "why"):
        own = poses.where((poses["robot"] == robot) & (poses["time_s"] < at_s))
        if len(own):
            place = float(own["x"][-1]), float(own["y"][-1])
            found.append(LastSeen(robot, at_s, *place, why))
    return found


class Leadership(NamedTuple):
    """Who led when.

    terms: every leadership term, as the referee has them. main: of those, who led most of the team at
    each moment: one line even while the team is split (of equal ones the lowest leader id counts).
    """

    terms: list[LeadershipTerm]
    main: list[LeadershipTerm]


class LeadershipLine:
    """The same, tick by tick.

    What a robot says in tick k takes effect at the beginning of tick k + 1, unless it has left by then.
    """

    def __init__(self, period_ns: int) -> None:
        self._period_ns = period_ns
        self._history = LeadershipHistory()
        self.main: list[LeadershipTerm] = []

    @property
    def terms(self) -> list[LeadershipTerm]:
        return self._history.terms

    def on_departure(self, robot: int) -> None:
        """A robot leaves the mission with the next tick, or has left it before."""
        self._history.on_departure(robot)

    def on_tick(self, tick: int, said: Iterable[Sequence[Any]]) -> None:
        """What robots say of themselves in a tick: robot, leader, epoch, members, shape.

        Of those alone who are there in the next tick too.
        """
        now_s = (tick + 1) * self._period_ns / 1e9
        for robot, leader, epoch, members, shape in said:
            self._history.on_status(now_s, robot, leader, epoch, members, shape)
        _follow_main(self.main, self._history, now_s)


def leadership(status: Table, left: Table, period_ns: int) -> Leadership:
    """From the tables `status` and `departures`, sound or torn."""
    line = LeadershipLine(period_ns)
    leaving = list(left.rows("tick", "robot"))
    statuses = status.rows("tick", "robot", "leader", "epoch", "members", "shape")
    for tick, rows in groupby(statuses, key=itemgetter(0)):
        gone = set()
        while leaving and leaving[0][0] <= tick + 1:
            at, robot = leaving.pop(0)
            line.on_departure(robot)
            if at == tick + 1:
                gone.add(robot)
        line.on_tick(tick, [said for _, *said in rows if said[0] not in gone])
    return Leadership(line.terms, line.main)


def _follow_main(main: list[LeadershipTerm], history: LeadershipHistory, now_s: float) -> None:
    """Add the term of whoever leads most robots now, if it is another one than before."""
    largest = min(
        history.acting.values(), key=lambda term: (-len(term.members), term.leader), default=None
    )
    if largest is not None:
        current = replace(largest, at_s=now_s)
        if not main or replace(main[-1], at_s=now_s) != current:
            main.append(current)


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
    """What lasted, as it was in force, whoever caused it.

    Tables: poses, cuts, jams, corruptions, impaired.
    """
    gap_s = 1.5 * period_s
    poses, cuts, jams = tables["poses"], tables["cuts"], tables["jams"]
    held = poses.where(poses["held"])
    found = _each(held["time_s"], _names(f"hold {robot}" for robot in held["robot"]), gap_s)
    impaired = tables["impaired"]
    names = _names(f"{_KIND[how]} {robot}" for robot, how in impaired.rows("robot", "how"))
    found += _each(impaired["time_s"], names, gap_s)
    corruptions = tables["corruptions"]
    names = _names(f"corrupt {_ids(robots)}" for robots in corruptions["robots"])
    found += _each(corruptions["time_s"], names, gap_s)
    names = _names(
        f"cut {_ids(a)}" + (f" one way to {_ids(b)}" if one_way else "")
        for a, b, one_way in cuts.rows("side_a", "side_b", "one_way")
    )
    found += _each(cuts["time_s"], names, gap_s)
    names = _names(
        f"jam at ({x:.0f}, {y:.0f}) m, {r:.0f} m wide" for x, y, r in jams.rows("x", "y", "radius")
    )
    found += _each(jams["time_s"], names, gap_s)
    return sorted(found, key=lambda span: (span.start_s, span.what))


_KIND = {"stopped": "stop", "blind": "blind", "slow": "slow"}
"""Kind of fault that makes a robot what it is."""


def _names(names: Iterable[str]) -> Column:
    return np.array(list(names), dtype=np.str_)


def _each(time_s: Column, names: Column, gap_s: float) -> list[Span]:
    found: list[Span] = []
    for name in np.unique(names):
        own = names == name
        found += spans(time_s[own], names[own], gap_s)
    return found


def _ids(robots: tuple[int, ...]) -> str:
    return " ".join(map(str, robots))


def begun_faults(faults: Table) -> list[FaultSection]:
    """The faults of a mission when they began, by script or by hand, from the table `faults`."""
    keys = [key for key in faults if key not in ("tick", "time_s")]
    return [FaultSection(**dict(zip(keys, values, strict=True))) for values in faults.rows(*keys)]
