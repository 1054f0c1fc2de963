"""One mission of chaos: run in this process, judged from its log, and what came of it as a row."""

import signal
import sys
import threading
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onehop.chaos.arrival import why_it_should_have
from onehop.chaos.disturbance import RECOVERY_S, Disturbance
from onehop.chaos.properties import ARRIVAL, CRASH, HANG
from onehop.chaos.sometimes import Sometimes
from onehop.checking import judge
from onehop.checking.findings import Violation
from onehop.checking.invariants import COMPLETE, INVARIANTS, NO_COLLISION
from onehop.drivers import inline
from onehop.scenario.bundle import Bundle
from onehop.wire.journal import Journal, WireMessage
from onehop.wire.log_reader import LoggedTick
from onehop.wire.log_writer import LogWriter
from onehop.wire.summary import summarize

HANG_S = 600.0
"""Wall-clock time after which a mission hangs [s]: the longest takes a hundredth of it."""

ALL = sys.maxsize
"""Violations that are looked at: behind many that are excused there may be one that is not."""


@dataclass(frozen=True, slots=True)
class Failure:
    """A property that did not hold. tick: of the first time, -1 where there is none."""

    property: str
    tick: int
    robots: tuple[int, ...]
    what: str


@dataclass(frozen=True, slots=True)
class Trial:
    """What came of one mission.

    summary: as `onehop run` prints it, None if there is none. failures: one for each property that did
    not hold, the first time. checked, seen: how often each invariant was judged, and each thing that
    should sometimes happen did.
    """

    summary: dict[str, Any] | None
    failures: tuple[Failure, ...]
    checked: dict[str, int]
    seen: dict[str, int]

    def broken(self) -> set[str]:
        """Names of the properties that did not hold."""
        return {failure.property for failure in self.failures}


class Recording:
    """The messages of a mission that is run in this process, as its log would have them."""

    torn = False

    def __init__(self, bundle: Bundle) -> None:
        self.bundle = bundle
        self.summary: dict[str, Any] | None = None
        self._ticks: list[LoggedTick] = []

    def add(self, tick: int, messages: list[WireMessage]) -> None:
        """One more tick, in canonical order."""
        self._ticks.append(LoggedTick(tick, messages))

    def ticks(self) -> Iterator[LoggedTick]:
        """Every tick."""
        return iter(self._ticks)

    def write(self, path: Path) -> None:
        """Write the log."""
        log = LogWriter(path, self.bundle, "inline")
        for tick in self._ticks:
            log.write(tick.tick, tick.messages)
        log.close(self.summary)


def tried(bundle: Bundle, only: str | None = None, log: Path | None = None) -> Trial:
    """Run a mission and judge it, by everything or by one property only.

    log: where its log is written, if it is wanted and the mission comes to its end.
    """
    recording = Recording(bundle)
    try:
        with _limited(HANG_S):
            _run(recording)
    except _HangError:
        what = f"it still runs after {HANG_S:g} s"
        return Trial(None, (Failure(HANG, -1, (), what),), {}, {})
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        what = f"{type(error).__name__} in {Path(where.filename).name}:{where.lineno}: {error}"
        return Trial(None, (Failure(CRASH, -1, (), what),), {}, {})
    if log is not None:
        recording.write(log)
    return _judged(recording, only)


def _run(recording: Recording) -> None:
    journal = Journal(recording.add)
    started = time.monotonic()
    outcome = inline.run(recording.bundle, journal)
    recording.summary = summarize(outcome, time.monotonic() - started, journal.digest(), None)


def _judged(recording: Recording, only: str | None) -> Trial:
    bundle, summary = recording.bundle, recording.summary
    assert summary is not None
    end, seen = Disturbance(), Sometimes()
    invariants = () if only is None else (only if only in INVARIANTS else COMPLETE,)
    report = judge(recording, invariants, (end, seen), ALL)
    recovery = RECOVERY_S * 1e9 / bundle.scenario.clock.period_ns
    failures: dict[str, Failure] = {}
    for one in report.violations:
        if not _is_excused(one, end, recovery):
            failures.setdefault(one.invariant, Failure(one.invariant, one.tick, one.robots, one.what))
    why = why_it_should_have(bundle, summary, end)
    if why is not None:
        failures[ARRIVAL] = Failure(ARRIVAL, summary["ticks"] - 1, tuple(sorted(end.whole)), why)
    return Trial(summary, tuple(failures.values()), report.checked, dict(seen.seen))


def _is_excused(violation: Violation, end: Disturbance, recovery: float) -> bool:
    """Whether it is a contact of a robot that could not know where it drove, or has only just seen."""
    return violation.invariant == NO_COLLISION and not all(
        end.knew_its_way(robot, violation.tick, recovery) for robot in violation.robots
    )


class _HangError(Exception):
    """A mission does not end."""


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """Raise _HangError in the block after some seconds; only main threads can be interrupted."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def give_up(*_: object) -> None:
        raise _HangError

    before = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
