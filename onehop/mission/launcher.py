"""Run one mission as processes: start them, watch over them, end them, write the summary."""

import time
import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onehop.contracts import topics
from onehop.contracts.errors import MissionError
from onehop.contracts.messages import Death, Progress
from onehop.mission.operator import Ending, OperatorSession, ending_by_death
from onehop.mission.processes import ProcessGroup, free_endpoint
from onehop.node.bus import Bus, open_client
from onehop.wire.summary import summarize, write_summary

START_ATTEMPTS = 5
"""Tries when another program takes the free port between the search for it and its use."""

CONNECT_TRY_MS = 500
"""How long one attempt to reach the world may take: between two the children are looked at."""

CONNECT_S = 60.0
"""How long the world may take to open the bus [s]."""

LEAVE_S = 2.0
"""How long the children may take to leave by themselves after a mission that was not broken off [s]."""


@dataclass(frozen=True, slots=True)
class LaunchPlan:
    """What to run. world_arguments: scenario and options, as `python -m world_server` takes them."""

    world_arguments: tuple[str, ...]
    robots: tuple[int, ...]
    out: Path
    record: bool

    @property
    def log(self) -> str | None:
        """Where the log will be, if there will be one."""
        return str(self.out / "mission.mcap") if self.record else None


def run(
    plan: LaunchPlan, show: Callable[[Progress], None], tell: Callable[[str], None] = lambda _: None
) -> dict[str, Any]:
    """Run a mission to its end, write its summary and return it.

    show: takes progress, some times a second. tell: takes lines for people, when something went wrong.
    Raises MissionError when it cannot be run, KeyboardInterrupt after an orderly end on Ctrl-C.
    """
    for _ in range(START_ATTEMPTS):
        mission = f"onehop-{uuid.uuid4().hex[:8]}"
        endpoint = free_endpoint()
        with ProcessGroup(endpoint, mission, plan.robots, plan.out / "stderr") as group:
            ending = _run_once(plan, group, mission, endpoint, show, tell)
            if ending is None:
                continue
            summary = summarize(ending.outcome, ending.wall_s, ending.digest, plan.log, group.processes)
            write_summary(plan.out, summary)
            if ending.interrupted:
                raise KeyboardInterrupt
            return summary
    raise MissionError(f"no free port on loopback found in {START_ATTEMPTS} attempts")


def _run_once(
    plan: LaunchPlan,
    group: ProcessGroup,
    mission: str,
    endpoint: str,
    show: Callable[[Progress], None],
    tell: Callable[[str], None],
) -> Ending | None:
    """One attempt; None when the port was taken in between."""
    group.start_world(plan.world_arguments)
    group.start_radio()
    group.start_recorder(plan.out, plan.record)
    for i in plan.robots:
        group.start_robot(i)
    bus = _connect(group, mission, endpoint)
    if isinstance(bus, Death):
        if "Address already in use" in bus.account:
            return None
        return ending_by_death(group, bus.name, 0)
    with bus:
        ending = OperatorSession(group, bus, show, tell).until_end()
        group.end(0.0 if ending.outcome.outcome == "aborted" else LEAVE_S)  # while the router can answer
    if group.said_something:
        tell(f"what the processes said on stderr is in {plan.out / 'stderr'}")
    return ending


def _connect(group: ProcessGroup, mission: str, endpoint: str) -> Bus | Death:
    """The operator's session as soon as the world listens, or the death of a child before that."""
    deadline = time.monotonic() + CONNECT_S
    while time.monotonic() < deadline:
        try:
            return open_client(
                mission, endpoint, topics.OPERATOR, group.operator_password, CONNECT_TRY_MS
            )
        except MissionError:
            deaths = group.deaths()
            if deaths:
                return deaths[0]
    raise MissionError(f"the world process has not opened the bus within {CONNECT_S:g} s")


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
