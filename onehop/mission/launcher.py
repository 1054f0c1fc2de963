"""Run one mission as processes: start them, watch over them, end them, write the summary."""

import contextlib
import math
import os
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onehop.contracts import topics
from onehop.contracts.errors import InputError, MissionError
from onehop.contracts.operation import Pace, Progress
from onehop.mission.operator import LOST_WORD, STOPPED, Ending, OperatorSession, aborted, ending_by_death
from onehop.mission.placement import Placement
from onehop.mission.processes import ProcessGroup, on_loopback
from onehop.mission.rendezvous import Rendezvous, entrance, published
from onehop.mission.stops import StopRequest
from onehop.node.bus import CONNECT_TIMEOUT_MS, LEASE_MS, Bus, open_client
from onehop.scenario.bundle import Bundle
from onehop.wire.codec import encode
from onehop.wire.output_folder import LOG
from onehop.wire.summary import read_summary, summarize, write_summary

START_ATTEMPTS = 5
"""Tries when another program takes the free port between the search for it and its use."""

CONNECT_TRY_MS = 500
"""How long one attempt to reach the world may take: between two the children are looked at."""

CONNECT_S = CONNECT_TIMEOUT_MS / 1000.0
"""How long the world may take to open the bus [s]: as long as its clients wait for it."""

STOPPED_S = LEASE_MS / 1000.0
"""How long the world may be stopped before its bus is there [s]: as long as afterwards."""

LEAVE_S = 2.0
"""How long the children may take to leave by themselves after a mission that was not broken off [s]."""


@dataclass(frozen=True, slots=True)
class LaunchPlan:
    """What to run. world_arguments: scenario and options, as `python -m world_server` takes them.

    out: the folder of its output, held by the descriptor `claim` (output_folder.claimed).
    programs: where robots look for programs that are not installed, and where commands are started.
    commands: of robots that are processes of somebody else's making. bases: of robots with a real base,
    what starts its driver here, if anything. placement: where its processes run; None: all here, on a
    bus of its own on loopback.
    """

    world_arguments: tuple[str, ...]
    robots: tuple[int, ...]
    out: Path
    claim: int
    record: bool
    programs: str
    commands: dict[int, tuple[str, ...]]
    bases: dict[int, tuple[str, ...]]
    placement: Placement | None = None


@dataclass(frozen=True, slots=True)
class Running:
    """A mission that runs, for who wants to lay hands on it.

    way_in: for its faults. set_pace: how fast it goes; any thread may call it, also after the end.
    """

    way_in: Rendezvous
    set_pace: Callable[[Pace], None]


Attendance = Callable[[Running], AbstractContextManager[None]]
"""What is entered as soon as a mission runs, and left at its end."""


def nobody(_: Running) -> AbstractContextManager[None]:
    """The attendance of a mission on which nobody lays hands."""
    return contextlib.nullcontext()


def plan(
    bundle: Bundle,
    world_arguments: tuple[str, ...],
    out: Path,
    claim: int,
    record: bool,
    placement: Placement | None = None,
) -> LaunchPlan:
    """How to run a mission; see LaunchPlan."""
    scenario = bundle.scenario
    robots, commands, bases = scenario.team.robots, scenario.commands, scenario.bases
    folder = bundle.folder
    return LaunchPlan(world_arguments, robots, out, claim, record, folder, commands, bases, placement)


def run(
    plan: LaunchPlan,
    show: Callable[[Progress], None],
    tell: Callable[[str], None] = lambda _: None,
    attend: Attendance = nobody,
) -> dict[str, Any]:
    """Run a mission to its end, write its summary and return it.

    show: takes progress, some times a second. tell: takes lines for people, when something went wrong.
    attend: entered while the mission runs.
    Raises MissionError or InputError when it cannot be run, Stopped after an orderly end on Ctrl-C,
    SIGTERM or SIGHUP.
    """
    with StopRequest() as stop:
        summary = _Launch(plan, stop, show, tell, attend).summary()
        try:
            write_summary(plan.out, summary)
        except InputError:
            tell(f"{summary['outcome']}: {summary['reason']}")
            raise
        stop.obey()
    return summary


class _Launch:
    """One mission as processes, tried until it has a port of its own."""

    def __init__(
        self,
        plan: LaunchPlan,
        stop: StopRequest,
        show: Callable[[Progress], None],
        tell: Callable[[str], None],
        attend: Attendance,
    ) -> None:
        self._plan = plan
        self._stop = stop
        self._show = show
        self._tell = tell
        self._attend = attend
        self._log = plan.out / LOG
        self._log_before = _written_ns(self._log)

    def summary(self) -> dict[str, Any]:
        """Run it; its summary, complete."""
        plan = self._plan
        for _ in range(START_ATTEMPTS):
            placement = plan.placement or on_loopback()
            words = plan.out / "stderr"
            team = plan.robots, words, plan.programs, plan.commands, plan.bases
            with ProcessGroup(placement, *team) as group:
                ending = self._run_once(group, placement)
            if ending is not None:
                return self._summary_of(ending, group)
            if plan.placement is not None:
                raise InputError(f"--bus {placement.listen}", "somebody listens there", "another port")
        raise MissionError(f"no free port on loopback found in {START_ATTEMPTS} attempts")

    def _summary_of(self, ending: Ending, group: ProcessGroup) -> dict[str, Any]:
        """What the operator's session has heard; where it missed the end, what the recorder has left."""
        left = read_summary(self._plan.out) if ending.digest is None else None
        if left is not None:
            return {**left, "processes": [process._asdict() for process in group.processes]}
        log = str(self._log) if _written_ns(self._log) != self._log_before else None
        return summarize(
            ending.outcome, ending.wall_s, ending.digest, log, group.processes, ending.punctuality
        )

    def _run_once(self, group: ProcessGroup, placement: Placement) -> Ending | None:
        """One attempt; None when the port was taken in between."""
        group.start_world(self._plan.world_arguments)
        if group.is_here(topics.RADIO):
            group.start_radio()
        group.start_recorder(self._plan.out, self._plan.record, self._plan.claim)
        for i in self._plan.robots:
            if group.is_here(topics.robot_name(i)):
                group.start_robot(i)
        for i in self._plan.bases:
            if group.is_here(topics.base_name(i)):
                group.start_base(i)
        bus = self._connect(group, placement)
        if not isinstance(bus, Bus):
            return bus
        if placement.remote:
            self._tell(placement.invitation())
        way_in = entrance(placement, group.identity(topics.INJECTOR), os.getpid())
        running = Running(way_in, lambda pace: bus.tell_self(topics.PACE, encode(pace)))
        with bus, published(self._plan.out, way_in), self._attend(running):
            people = (self._stop, self._show, self._tell)
            session = OperatorSession(group, bus, *people, placement.remote, placement.external)
            ending = session.until_end()
            leave_s = 0.0 if ending.outcome.outcome == "aborted" else LEAVE_S
            group.end(leave_s)  # while the router can answer
        if group.said_something:
            self._tell(f"what the processes said on stderr is in {self._plan.out / 'stderr'}")
        return ending

    def _connect(self, group: ProcessGroup, placement: Placement) -> Bus | Ending | None:
        """The operator's session as soon as the world listens, or the end of the mission before that.

        None when somebody else listens there.
        """
        identity = group.identity(topics.OPERATOR)
        mission, endpoint = placement.mission, placement.connect
        deadline = time.monotonic() + CONNECT_S
        stopped_from = math.inf
        while True:
            now = time.monotonic()
            stopped_from = min(stopped_from, now) if group.is_stopped(topics.WORLD) else math.inf
            if self._stop.number is not None:
                return aborted(STOPPED, 0)
            if now - stopped_from > STOPPED_S:
                return aborted("the world process has been stopped, and was not continued", 0)
            for death in group.deaths():
                if "Address already in use" in death.account:
                    return None
                return ending_by_death(group, death.name, 0)
            if group.exit_status(topics.WORLD) is not None:
                return aborted(LOST_WORD, 0)
            with contextlib.suppress(MissionError):
                return open_client(mission, endpoint, topics.OPERATOR, identity, CONNECT_TRY_MS)
            if now > deadline:
                raise MissionError(f"the world process has not opened the bus within {CONNECT_S:g} s")


def _written_ns(path: Path) -> int | None:
    """When a file was written last [ns], None if there is none."""
    return path.stat().st_mtime_ns if path.exists() else None


def world_arguments(
    scenario: Path,
    settings: Sequence[str],
    seed: int | None,
    map_file: Path | None,
    start: str | None,
    goal: str | None,
) -> tuple[str, ...]:
    """The command line of the world server that runs a scenario with these changes."""
    arguments = [str(scenario)]
    for setting in settings:
        arguments += ["--set", setting]
    for option, value in (("seed", seed), ("map", map_file), ("start", start), ("goal", goal)):
        if value is not None:
            arguments.append(f"--{option}={value}")
    return tuple(arguments)
