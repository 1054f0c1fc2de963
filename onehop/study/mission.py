"""One mission of a study: what a worker is told to do, and the row that comes of it."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from onehop.campaign.lines import Row
from onehop.campaign.process_mission import run_as_processes
from onehop.contracts.errors import MissionError
from onehop.contracts.messages import Outcome
from onehop.drivers import inline
from onehop.scenario.bundle import Bundle
from onehop.study.grid import KeyValue
from onehop.study.measures import Course
from onehop.wire.journal import Journal, WireMessage
from onehop.wire.log_writer import LogWriter
from onehop.wire.summary import summarize

Keep = Literal["none", "failures", "all"]
"""Whose logs are kept. A failure is a mission that did not arrive, or not with the whole team."""

SAME, DIFFERS, FAILED = "same", "differs", "failed"
"""What a mission that ran as processes besides came to; FAILED is followed by why."""


@dataclass(frozen=True, slots=True)
class MissionOrder:
    """One mission to run. name: of its row. values: of the keys that are varied.

    log: where its log is written, if it is kept. as_processes: run it as processes besides.
    """

    name: str
    values: dict[str, KeyValue]
    bundle: Bundle
    keep: Keep
    log: Path
    as_processes: bool


def run_mission(order: MissionOrder) -> Row:
    """Run a mission and measure it."""
    bundle = order.bundle
    log = None if order.keep == "none" else _Log(order.log, bundle)
    journal = Journal(log.write if log is not None else lambda _, __: None)
    course = Course(bundle)
    outcome = inline.run(bundle, journal, course.watch)
    digest = journal.digest()
    kept = order.keep == "all" or outcome.outcome != "arrived" or bool(outcome.lost)
    if log is not None:
        log.close(outcome, digest, kept)
    return {
        "name": order.name,
        "values": order.values,
        "seed": bundle.scenario.seed,
        "outcome": outcome.outcome,
        "reason": outcome.reason,
        "arrived": len(outcome.arrived),
        "lost": len(outcome.lost),
        "lost_robots": " ".join(str(one.robot) for one in outcome.lost),
        "shape": outcome.leaders[-1].shape if outcome.leaders else None,
        "ticks": outcome.ticks,
        "sim_s": outcome.sim_s,
        **course.measures(),
        "collisions": outcome.collisions,
        "digest": digest,
        "as_processes": _as_processes(bundle, digest) if order.as_processes else None,
        "log": order.log.name if log is not None and kept else None,
    }


class _Log:
    """A log that is taken back if nobody wants to keep it."""

    def __init__(self, path: Path, bundle: Bundle) -> None:
        self._path = path
        self._draft = path.with_name(path.name + ".part")
        self._writer = LogWriter(self._draft, bundle, "inline")

    def write(self, tick: int, messages: list[WireMessage]) -> None:
        self._writer.write(tick, messages)

    def close(self, outcome: Outcome, digest: str, keep: bool) -> None:
        self._writer.close(summarize(outcome, 0.0, digest, str(self._path)))
        if keep:
            self._draft.replace(self._path)
        else:
            self._draft.unlink()


def _as_processes(bundle: Bundle, digest: str) -> str:
    """Whether the same mission as processes leaves the same bytes, or why it failed."""
    with tempfile.TemporaryDirectory(prefix="onehop-study-") as folder:
        try:
            summary: dict[str, Any] = run_as_processes(bundle, Path(folder))
        except MissionError as error:
            return f"{FAILED}: {error}"
    return SAME if summary["digest"] == digest else DIFFERS
