"""Why one robot did what it did at one moment, from the log alone.

Its status and notes, the messages to it and from it with their delivery status, and the faults in force
around it. Nothing is simulated.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from onehop.analysis.log import Log
from onehop.analysis.message_traces import MessageTrace, join
from onehop.analysis.payloads import summary_of
from onehop.analysis.tables import Table
from onehop.analysis.timeline import departures
from onehop.contracts.errors import InputError
from onehop.contracts.messages import Truth
from onehop.contracts.sections import GainsSection, TeamSection
from robot_agent.core.team.team_messages import Command

WINDOW_S = 6.0
"""Messages and events of this long before the moment are listed [s]: three periods of Next."""


@dataclass(frozen=True, slots=True)
class Since:
    """A value, and since when it has been so [s]."""

    value: Any
    since_s: float


@dataclass(frozen=True, slots=True)
class Explanation:
    """One robot at one moment. left: when and why it left, if it is not there at at_s.

    Of a robot without a team mode, roster and k_rho are None, and status is empty. values: what its
    program shows. mode_change: the note of the last change of mode {mode, was, on}, None at the start.
    next_s: arrival of the last command from its leader, None when there was none. traces: messages to it
    and from it in the window, in order. status, pose: last row of the tables `status` and `poses` as
    plain values.
    """

    robot: int
    asked_s: float
    at_s: float
    tick: int
    left: dict[str, Any] | None
    mode: Since | None
    mode_change: dict[str, Any] | None
    roster: Since | None
    k_rho: Since | None
    status: dict[str, Any]
    values: dict[str, float]
    pose: dict[str, Any]
    next_s: float | None
    traces: tuple[MessageTrace, ...]
    events: tuple[dict[str, Any], ...]
    faults: tuple[str, ...]
    gains: GainsSection
    team: TeamSection

    def as_json(self) -> dict[str, Any]:
        """Everything as plain values; lost messages have no arrival."""
        return {
            "robot": self.robot,
            "at_s": self.at_s,
            "tick": self.tick,
            "present": self.left is None,
            "left": self.left,
            **self._team_json(),
            "values": self.values,
            "pose": self.pose,
            "last_next_s": self.next_s,
            "messages": [_message_json(trace) for trace in self.traces],
            "events": list(self.events),
            "faults": list(self.faults),
        }

    def _team_json(self) -> dict[str, Any]:
        if self.mode is None or self.roster is None or self.k_rho is None:
            return dict.fromkeys(("mode", "roster", "k_rho", "error", "status"))
        status = {**self.status, "members": list(self.status["members"])}
        return {
            "mode": {**asdict(self.mode), "change": self.mode_change},
            "roster": asdict(self.roster),
            "k_rho": asdict(self.k_rho),
            "error": status["error"],
            "status": status,
        }


def _message_json(trace: MessageTrace) -> dict[str, Any]:
    plain = asdict(trace)
    del plain["message"]
    plain["says"] = summary_of(trace.message)
    plain["path"] = list(trace.path)
    plain["arrival_s"] = None if math.isnan(trace.arrival_s) else trace.arrival_s
    return plain


def explain(log: Log, robot: int, at_s: float, window_s: float = WINDOW_S) -> Explanation:
    """Raises InputError for a robot that is not in the team or a moment outside the log."""
    if robot not in log.robots:
        raise InputError(
            f"--robot {robot}", "is not in the team", f"one of {', '.join(map(str, log.robots))}"
        )
    tables = log.tables("status", "values", "notes", robots=[robot], end_s=at_s)
    ground = log.tables("poses", "departures", "verdicts", "transmit_requests", end_s=at_s)
    status, values = tables["status"], tables["values"]
    has_team = len(status) > 0
    acted = status if has_team else _acted(log, robot, at_s)
    if at_s < 0 or not len(acted):
        raise InputError(f"--at {at_s:g}", "the robot has not acted by then", "a later time [s]")
    tick, last_s = int(acted["tick"][-1]), float(acted["time_s"][-1])
    left = _left(ground, robot, tick)
    seen_s = last_s if left else _last_seen_s(ground, robot, last_s)
    if left is None and at_s > seen_s + 2 * log.period_ns / 1e9:
        raise InputError(f"--at {at_s:g}", "the log ends before that", f"at most {seen_s:g} s")
    own = [
        trace
        for trace in join(ground["verdicts"], ground["transmit_requests"], log.period_ns)
        if robot in (trace.receiver, trace.source)
    ]
    changes = [data for kind, data in _notes(tables["notes"]) if kind == "mode"]
    return Explanation(
        robot=robot,
        asked_s=at_s,
        at_s=last_s,
        tick=tick,
        left=left,
        mode=_since(status, "mode") if has_team else None,
        mode_change=changes[-1] if changes else None,
        roster=_roster_since(status) if has_team else None,
        k_rho=_since(status, "k_rho") if has_team else None,
        status=_row(status),
        values=dict(values.where(values["tick"] == tick).rows("name", "value")),
        pose=_row(_until(ground["poses"].of(robot), tick)),
        next_s=_last_command(own, robot, int(status["leader"][-1])) if has_team else None,
        traces=tuple(trace for trace in own if trace.settled_s > last_s - window_s),
        events=_events(tables["notes"], last_s - window_s),
        faults=tuple(_faults(log, robot, seen_s)),
        gains=log.scenario.gains,
        team=log.scenario.team,
    )


def _acted(log: Log, robot: int, at_s: float) -> Table:
    """The ticks in which a robot without a team has acted."""
    period_s = log.period_ns / 1e9
    ticks = np.array([tick for tick, _ in log.actions(robot, 0.0, at_s)], dtype=np.int64)
    return Table({"tick": ticks, "time_s": ticks * period_s})


def _until(table: Table, tick: int) -> Table:
    return table.where(table["tick"] <= tick)


def _last_seen_s(ground: dict[str, Table], robot: int, last_s: float) -> float:
    """When a robot was there last [s]: later than it acted last if it is stopped."""
    times = ground["poses"].of(robot)["time_s"]
    return max(last_s, float(times[-1])) if len(times) else last_s


def _left(ground: dict[str, Table], robot: int, tick: int) -> dict[str, Any] | None:
    gone = [d for d in departures(ground["poses"], ground["departures"]) if d.robot == robot]
    present = ground["poses"].of(robot)["tick"]
    if not gone or (len(present) and present[-1] > tick + 1):  # a robot is fenced for what it lacks
        return None
    return {"at_s": gone[-1].at_s, "why": gone[-1].why}


def _notes(notes: Table) -> list[tuple[str, dict[str, Any]]]:
    return list(zip(notes["kind"].tolist(), notes["data"], strict=True))


def _since(status: Table, name: str) -> Since:
    column = status[name]
    other = np.flatnonzero(column[:-1] != column[-1])
    row = int(other[-1]) + 1 if len(other) else 0
    return Since(column[-1].item(), float(status["time_s"][row]))


def _roster_since(status: Table) -> Since:
    keys = list(zip(status["epoch"].tolist(), status["members"], status["shape"].tolist(), strict=True))
    row = len(keys) - 1
    while row > 0 and keys[row - 1] == keys[-1]:
        row -= 1
    epoch, members, shape = keys[-1]
    roster = {
        "leader": int(status["leader"][-1]), "epoch": epoch, "members": list(members), "shape": shape,
    }  # fmt: skip
    return Since(roster, float(status["time_s"][row]))


def _row(table: Table) -> dict[str, Any]:
    if not len(table):
        return {}
    return {
        name: column[-1] if column.dtype == object else column[-1].item()
        for name, column in table.items()
    }


def _last_command(own: list[MessageTrace], robot: int, leader: int) -> float | None:
    arrivals = [
        trace.arrival_s
        for trace in own
        if trace.delivered
        and trace.receiver == robot
        and trace.source == leader
        and isinstance(trace.message, Command)
    ]
    return max(arrivals, default=None)


def _events(notes: Table, start_s: float) -> tuple[dict[str, Any], ...]:
    return tuple(
        {**data, "at_s": time_s, "kind": kind}
        for time_s, (kind, data) in zip(notes["time_s"].tolist(), _notes(notes), strict=True)
        if time_s > start_s
    )


_ONE_WAY = {True: ": they hear nothing of it", False: ": it hears nothing of them"}
"""By whether a robot is on the side that does not get through."""


def _faults(log: Log, robot: int, at_s: float) -> list[str]:
    truth: Truth | None = next((truth for _, truth in log.truths(at_s, at_s)), None)
    if truth is None:
        return []
    words = []
    for presence in truth.present:
        if presence.robot == robot:
            if presence.held:
                words.append("it is held: it stands still whatever it commands")
            if robot in truth.stopped:
                words.append("its process is stopped: it computes nothing, and what it is sent waits")
            if robot in truth.blind:
                words.append("it is blind: its laser sees nothing")
            words += [
                f"it is slow: what it does takes effect {one.delay_ticks} ticks late"
                for one in truth.slow
                if one.robot == robot
            ]
            words += [
                f"{100.0 * one.probability:g} % of the messages to it are corrupted"
                for one in truth.corruptions
                if robot in one.robots
            ]
            words += [
                f"jammed: inside {jam.radius:g} m of ({jam.x:g}, {jam.y:g})"
                for jam in truth.jams
                if math.hypot(presence.pose.x - jam.x, presence.pose.y - jam.y) <= jam.radius
            ]
    for cut in truth.cuts:
        for mine, other in ((cut.side_a, cut.side_b), (cut.side_b, cut.side_a)):
            if robot in mine:
                cut_off = f"cut off from {', '.join(map(str, other))}"
                words.append(cut_off + (_ONE_WAY[mine is cut.side_a] if cut.one_way else ""))
    return words
