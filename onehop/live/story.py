"""What has happened so far, taken in tick by tick: events in the report's words, charts, who left when.

The same for a log and for a mission that runs. Nothing is forgotten, so what is kept of a tick is
little: notes, faults, departures and contacts as they come, numbers of each robot twice a second.
"""

import math
from collections import deque
from collections.abc import Mapping
from typing import Any, NamedTuple

from onehop.analysis.report.narrative import NarrativeEvent, narrative
from onehop.analysis.timeline import LastSeen, LeadershipLine
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Action, DeliveryStatus, LeadershipTerm, RadioRecord, Truth
from onehop.contracts.program_section import BUILT_IN
from onehop.contracts.scenario import Scenario

SAMPLE_S = 0.5
"""Simulated time between two points of the charts [s]."""


CHARTS = 4
"""Numbers of each robot that are charted."""


RECENT_TICKS = 100
"""Ticks of which the lost messages are at hand: a page at the newest moment asks for no others."""

Lost = list[tuple[int, int, str]]
"""Messages that were lost in a tick: who held it last, who should have got it, why."""


def lost_in(record: RadioRecord) -> Lost:
    """The lost messages of a tick."""
    return [
        (one.path[-1] if one.path else one.source, one.receiver, one.status.value)
        for one in record.verdicts
        if one.status is not DeliveryStatus.DELIVERED
    ]


class Departure(NamedTuple):
    """A robot that left, where it stood [m], and why."""

    tick: int
    robot: int
    x: float
    y: float
    why: str


class Route(NamedTuple):
    """A way through the team by which a message came from the leader of a robot."""

    tick: int
    path: tuple[int, ...]


class Story:
    """One mission so far; `take` its ticks in order. It is what narrative.Narrated wants.

    samples: [tick, for each robot of the team None or x, y [m], throughput [kbit/s], SNR [dB],
    k_rho [1/s], error [m], each None if it has none]. routes: by robot, a new one whenever the way
    changes. names: of the values that take the places of the last four where the built-in team drives
    nobody; they come as programs show them first.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.summary: dict[str, Any] | None = None
        self.last_tick = -1
        self.noted: list[tuple[float, int, str, dict[str, Any]]] = []
        self.touched: list[tuple[float, int, int]] = []
        self.gone: list[LastSeen] = []
        self.departures: list[Departure] = []
        self.begun: list[FaultSection] = []
        self.samples: list[list[Any]] = []
        self.names: list[str] = []
        self._recent: deque[tuple[int, Lost]] = deque(maxlen=RECENT_TICKS)
        self._has_team = any(scenario.program_of(robot)[0] == BUILT_IN for robot in self.robots)
        self.routes: dict[int, list[Route]] = {robot: [] for robot in self.robots}
        self._period_s = scenario.clock.period_ns / 1e9
        self._stride = max(1, round(SAMPLE_S / self._period_s))
        self._line = LeadershipLine(scenario.clock.period_ns)
        self._said: list[tuple[Any, ...]] = []
        self._poses: dict[int, Pose] = {}
        self._snr: dict[int, float] = {}
        self._leaders: dict[int, int] = {}
        self._events: list[NarrativeEvent] = []
        self._told: tuple[int, ...] = ()

    @property
    def robots(self) -> tuple[int, ...]:
        return self.scenario.team.robots

    @property
    def end_s(self) -> float:
        return max(0, self.last_tick) * self._period_s

    @property
    def terms(self) -> list[LeadershipTerm]:
        return self._line.terms

    @property
    def main_terms(self) -> list[LeadershipTerm]:
        return self._line.main

    def take(self, truth: Truth, record: RadioRecord | None, actions: Mapping[int, Action]) -> None:
        """One tick. record: None in a log that ends within it."""
        self._take_departures(truth)
        leaving = {one.robot for one in truth.departures}
        self._line.on_tick(truth.tick - 1, [said for said in self._said if said[0] not in leaving])
        at_s = truth.tick * self._period_s
        self.begun += truth.faults
        self.touched += ((at_s, one.robot, one.other) for one in truth.contacts)
        self._poses = {one.robot: one.pose for one in truth.present}
        for robot, action in sorted(actions.items()):
            self.noted += ((at_s, robot, note.kind, note.data) for note in action.notes)
        self._said = [
            (robot, status.leader, status.epoch, status.members, str(status.shape))
            for robot, action in sorted(actions.items())
            if (status := action.status) is not None
        ]
        self._leaders = {said[0]: said[1] for said in self._said}
        if record is not None:
            self._take_radio(record)
        self.last_tick = truth.tick
        if truth.tick % self._stride == 0:
            self.samples.append([truth.tick, *(self._sample(robot, actions) for robot in self.robots)])

    def _take_departures(self, truth: Truth) -> None:
        at_s = truth.tick * self._period_s
        for one in truth.departures:
            self._line.on_departure(one.robot)
            pose = self._poses.get(one.robot)
            if pose is not None:
                self.gone.append(LastSeen(one.robot, at_s, pose.x, pose.y, one.why))
                self.departures.append(Departure(truth.tick, one.robot, pose.x, pose.y, one.why))

    def _take_radio(self, record: RadioRecord) -> None:
        self._recent.append((record.tick, lost_in(record)))
        for verdict in record.verdicts:
            if verdict.status is not DeliveryStatus.DELIVERED:
                continue
            receiver = verdict.receiver
            if self._leaders.get(receiver) == verdict.source and receiver in self.routes:
                self._snr[receiver] = verdict.snr_db
                routes = self.routes[receiver]
                path = (*verdict.path, receiver) if verdict.path[-1:] != (receiver,) else verdict.path
                if not routes or routes[-1].path != path:
                    routes.append(Route(record.tick, path))

    def _sample(self, robot: int, actions: Mapping[int, Action]) -> list[float | None] | None:
        pose = self._poses.get(robot)
        if pose is None:
            return None
        place = [round(pose.x, 2), round(pose.y, 2)]
        action = actions.get(robot)
        if action is not None and not self._has_team:
            return [*place, *self._values(action)]
        status = None if action is None else action.status
        if status is None:
            return [*place, None, None, None, None]
        if status.leader == robot:
            return [*place, None, None, round(status.k_rho, 3), None]
        snr = self._snr.get(robot)
        kbps = round(max(0.0, status.throughput_bps) / 1e3)
        shown = None if snr is None else round(snr, 1)
        return [*place, kbps, shown, round(status.k_rho, 3), round(status.error, 2)]

    def _values(self, action: Action) -> list[float | None]:
        """The first values that programs have shown, in the places of what a team shows."""
        self.names += [name for name in action.values if name not in self.names]
        shown = (action.values.get(name) for name in self.names[:CHARTS])
        values = [None if one is None or not math.isfinite(one) else round(one, 3) for one in shown]
        return values + [None] * (CHARTS - len(values))

    def events(self) -> list[NarrativeEvent]:
        """The report's narrative so far, in order of time."""
        state = (
            len(self.noted), len(self.touched), len(self.gone), len(self.begun), len(self.terms),
            len(self.main_terms), int(self.summary is not None),
        )  # fmt: skip
        if state != self._told:
            self._told, self._events = state, narrative(self)
        return self._events

    def recently_lost(self, first: int, last: int) -> Lost | None:
        """What was lost in the ticks first..last; None if that is not at hand any more."""
        recent = list(self._recent)
        if not recent or recent[0][0] > first or recent[-1][0] < last:
            return None
        return [lost for tick, in_tick in recent if first <= tick <= last for lost in in_tick]

    def gone_at(self, tick: int, present: set[int]) -> list[Departure]:
        """Who has left by a tick and is not there in it: the last departure of each."""
        last = {one.robot: one for one in self.departures if one.tick <= tick}
        return [one for robot, one in sorted(last.items()) if robot not in present]

    def route_at(self, robot: int, tick: int) -> tuple[int, ...]:
        """By which way its leader's messages came to a robot last; empty if none has."""
        earlier = [route.path for route in self.routes[robot] if route.tick <= tick]
        return earlier[-1] if earlier else ()
