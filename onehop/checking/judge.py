"""Reads a log once, tick by tick, and asks every invariant of every tick; its memory is bounded."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from onehop.checking.bases import RealBases
from onehop.checking.completeness import Completeness, DigestCheck
from onehop.checking.fault_air import FaultyAir
from onehop.checking.fault_bit import FaultBit
from onehop.checking.findings import KEPT, Findings, Violation
from onehop.checking.invariants import (
    COMPLETE,
    EPOCHS,
    FAULT_BIT,
    IN_REAL_TIME,
    INVARIANTS,
    MEDIAN,
    MOTION,
    NO_COLLISION,
    NOT_IN_THESIS,
    ONE_LEADER,
    ONE_TEAM,
    OWN_VOICE,
    RADIO_INTEGRITY,
    RE_ELECTION,
    SHAPE,
    SILENCE,
    UNEXERCISED,
    WITH_ANOTHER_PROPAGATION,
    WITHOUT_TEAM,
)
from onehop.checking.leaders import Leadership
from onehop.checking.motion import Collisions, Motion
from onehop.checking.radio import RadioIntegrity
from onehop.checking.reach import is_known
from onehop.checking.snapshot import Snapshot, snapshot
from onehop.checking.team import Team
from onehop.checking.voice import Voices
from onehop.contracts.errors import LogError
from onehop.scenario.bundle import Bundle
from onehop.scenario.link_trace import link_trace
from onehop.wire.journal import WireMessage
from onehop.wire.log_reader import LoggedTick


@dataclass(frozen=True, slots=True)
class Report:
    """What was found in one log.

    ticks: that could be read. checked: how often each wanted invariant was judged. broken: how many
    violations each has, if any. violations: the first of each, in order of invariant and tick.
    unexercised: what was not judged, and why.
    """

    ticks: int
    checked: dict[str, int]
    broken: dict[str, int]
    violations: tuple[Violation, ...]
    unexercised: dict[str, str]

    @property
    def holds(self) -> bool:
        """Whether nothing was found that breaks an invariant."""
        return not self.violations


class Watcher(Protocol):
    """Sees a log tick by tick while it is judged."""

    def take(self, now: Snapshot) -> None:
        """One more tick."""


class Log(Protocol):
    """What is judged: a log file, or the messages of a mission that has just been run."""

    torn: bool
    summary: dict[str, Any] | None

    @property
    def bundle(self) -> Bundle:
        """What the mission was made from."""

    def ticks(self) -> Iterator[LoggedTick]:
        """Its messages, in canonical order. Raises LogError."""


def judge(
    log: Log, only: Iterable[str] = (), watchers: Iterable[Watcher] = (), kept: int = KEPT
) -> Report:
    """Test the invariants of a log, all or those named. A torn one is judged as far as it goes.

    watchers: see every tick that is judged, after its invariants. kept: violations of each invariant
    that are reported; the rest is counted.
    """
    scenario, summary = log.bundle.scenario, log.summary
    wanted = frozenset(only) or frozenset(INVARIANTS)
    findings = Findings(wanted, kept)
    in_real_time = scenario.clock.is_realtime
    asked = wanted.difference(IN_REAL_TIME) if in_real_time else wanted
    trace = link_trace(log.bundle, "the log's scenario")
    completeness = Completeness(findings, scenario.clock)
    digest = DigestCheck(findings)
    collisions = Collisions(findings, scenario)
    checks: list[Watcher] = [
        check
        for names, check in (
            ((COMPLETE,), completeness),
            ((OWN_VOICE, SILENCE), Voices(findings, scenario)),
            ((MEDIAN, SHAPE, EPOCHS), Team(findings, scenario.team)),
            ((ONE_LEADER, ONE_TEAM, RE_ELECTION), Leadership(findings, scenario, trace)),
            ((RADIO_INTEGRITY,), RadioIntegrity(findings, scenario.radio, scenario.clock)),
            ((FAULT_BIT,), FaultBit(findings, scenario)),
            ((FAULT_BIT,), FaultyAir(findings, scenario, trace)),
            ((NO_COLLISION,), collisions),
            ((MOTION,), Motion(findings, scenario)),
            ((MOTION, OWN_VOICE), RealBases(findings, scenario)),
        )
        if asked.intersection(names)
    ]
    checks += watchers
    reading = _Reading(log)
    for now, messages in reading.ticks():
        digest.take(now.tick, messages)
        for check in checks:
            check.take(now)
    if reading.error is not None:
        completeness.on_end_of_reading(reading.error)
    else:
        digest.finish(summary)
        completeness.finish(summary)
        is_whole = summary is not None and summary["ticks"] == reading.count
        collisions.finish(summary, is_whole)
    reasons = {**UNEXERCISED, **(NOT_IN_THESIS if scenario.team.profile == "thesis" else {})}
    if not is_known(scenario.radio):
        reasons |= WITH_ANOTHER_PROPAGATION
    if in_real_time:
        reasons |= IN_REAL_TIME
    if reading.count and not reading.has_team:
        reasons |= WITHOUT_TEAM
    return _report(findings, reasons, reading.count)


class _Reading:
    """Reads a log as far as it goes. count: ticks that were read. error: why it ended early, if it did.

    has_team: whether any robot has said anything of a team. The last tick before a tear, or before what
    cannot be read, is left out if it is not whole.
    """

    def __init__(self, log: Log) -> None:
        self._log = log
        scenario = log.bundle.scenario
        self._team = frozenset(scenario.team.robots)
        self._in_lock_step = not scenario.clock.is_realtime
        self.count = 0
        self.error: str | None = None
        self.has_team = False

    def ticks(self) -> Iterator[tuple[Snapshot, list[WireMessage]]]:
        """Every tick, decoded and as it was written."""
        last: tuple[Snapshot, list[WireMessage]] | None = None
        try:
            for logged in self._log.ticks():
                if last is not None:
                    self.count += 1
                    yield last
                follows = last is not None and logged.tick == last[0].tick + 1
                last = snapshot(logged, follows, self._team, self._in_lock_step), logged.messages
                self.has_team |= any(one.status is not None for one in last[0].actions.values())
        except LogError as error:
            self.error = error.problem
        if last is not None and (last[0].is_whole() or not (self._log.torn or self.error)):
            self.count += 1
            yield last


def _report(findings: Findings, reasons: Mapping[str, str], ticks: int) -> Report:
    names = [name for name in INVARIANTS if name in findings.wanted]
    order = {name: number for number, name in enumerate(names)}
    return Report(
        ticks=ticks,
        checked={name: findings.checked[name] for name in names},
        broken={name: findings.broken[name] for name in names if findings.broken[name]},
        violations=tuple(sorted(findings.violations, key=lambda one: (order[one.invariant], one.tick))),
        unexercised={
            name: reasons.get(name, "the log has no tick")
            for name in names
            if not findings.checked[name] and not findings.broken[name]
        },
    )
