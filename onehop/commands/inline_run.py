"""`onehop run --driver inline`: the whole mission in this process, with its log and its summary."""

import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from onehop.contracts.fault_section import fault_in_words
from onehop.contracts.messages import Action, Carriage
from onehop.contracts.operation import Progress, RobotProgress
from onehop.contracts.topics import robot_name
from onehop.drivers import inline
from onehop.mission.stops import Stopped, StopRequest
from onehop.programs.host import ProgramError
from onehop.scenario.bundle import Bundle
from onehop.wire.journal import Journal, WireMessage
from onehop.wire.log_writer import LogWriter
from onehop.wire.output_folder import LOG, REMEDY, explained
from onehop.wire.summary import summarize, write_summary
from world_server.core.world import World

SHOW_S = 0.2
"""Wall-clock time between two updates of the progress display."""


def run_inline(
    bundle: Bundle,
    folder: Path,
    record: bool,
    show: Callable[[Progress], None],
    tell: Callable[[str], None],
) -> dict[str, Any]:
    """Run a mission to its end, write its log and summary, and return the summary.

    Raises InputError when they cannot be written, Stopped after an orderly end on Ctrl-C, SIGTERM or
    SIGHUP.
    """
    path = folder / LOG
    log = _Log(path, bundle) if record else None
    with StopRequest() as stop, explained(path, REMEDY):
        journal = Journal(log.write if log else lambda _, __: None)
        watch = _Watch(stop, show, tell)
        started = time.monotonic()
        try:
            with redirect_stdout(sys.stderr):  # what programs print
                outcome = inline.run(bundle, journal, watch.look, watch.tell_of_failure)
        except Stopped:
            outcome = watch.world.aborted("stopped by the operator")
        wall_s = time.monotonic() - started
        summary = summarize(outcome, wall_s, journal.digest(), str(path) if record else None)
        if log is not None:
            log.close(summary)
        write_summary(folder, summary)
        stop.obey()
    return summary


class _Log:
    """The log, which begins with its first tick: what the world refuses leaves an older log alone."""

    def __init__(self, path: Path, bundle: Bundle) -> None:
        self._path = path
        self._bundle = bundle
        self._writer: LogWriter | None = None

    def write(self, tick: int, messages: list[WireMessage]) -> None:
        if self._writer is None:
            self._writer = LogWriter(self._path, self._bundle, "inline")
        self._writer.write(tick, messages)

    def close(self, summary: dict[str, Any]) -> None:
        if self._writer is not None:
            self._writer.close(summary)


class _Watch:
    """Shows the mission some times a second and tells of its faults.

    Ends it between two ticks when people ask for it.
    """

    world: World
    """That of the mission, from its first tick on."""

    def __init__(
        self, stop: StopRequest, show: Callable[[Progress], None], tell: Callable[[str], None]
    ) -> None:
        self._tell = tell
        self._stop = stop
        self._show = show
        self._next_show = 0.0

    def tell_of_failure(self, robot: int, failure: ProgramError) -> None:
        self._tell(f"the program of {robot_name(robot)} failed:\n{failure.account}")

    def look(self, world: World, actions: dict[int, Action], _: Carriage) -> None:
        self.world = world
        for fault in world.truth().faults:
            self._tell(f"{world.time_ns / 1e9:g} s: {fault_in_words(fault)}")
        now = time.monotonic()
        if now >= self._next_show:
            self._next_show = now + SHOW_S
            lines = tuple(
                RobotProgress(i, action.twist.v, action.status) for i, action in actions.items()
            )
            self._show(Progress(world.tick, world.time_ns, lines))
        self._stop.obey()
