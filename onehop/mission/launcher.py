"""Run one mission as processes: start them, watch them, carry out what the world asks, end them."""

import json
import shutil
import signal
import tempfile
import time
import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onehop.contracts import topics
from onehop.contracts.errors import MissionError
from onehop.contracts.messages import End, Outcome, Progress
from onehop.mission.processes import ProcessGroup, free_endpoint
from onehop.node.bus import Bus, open_client
from onehop.wire.codec import decode
from onehop.wire.summary import summarize

START_ATTEMPTS = 5
"""Tries when another program takes the free port between the search for it and its use."""

CONNECT_TRY_MS = 500
POLL_S = 0.1
RESULT_S = 30.0
LEAVE_S = 10.0


@dataclass(frozen=True, slots=True)
class LaunchPlan:
    """What to run. world_arguments: scenario and options, as `python -m world_server` takes them."""

    world_arguments: tuple[str, ...]
    robots: tuple[int, ...]
    out: Path
    record: bool


def run(order: LaunchPlan, show: Callable[[Progress], None]) -> dict[str, Any]:
    """Run a mission to its end and return its summary. show: called some times a second.

    Raises MissionError when it cannot be started, KeyboardInterrupt after an orderly end on Ctrl-C.
    """
    folder = Path(tempfile.mkdtemp(prefix="onehop-"))
    try:
        for _ in range(START_ATTEMPTS):
            mission = f"onehop-{uuid.uuid4().hex[:8]}"
            endpoint = free_endpoint()
            with ProcessGroup(endpoint, mission, order.robots, folder) as family:
                summary = _run_once(order, family, mission, endpoint, show)
                if summary is not None:
                    return summary
        raise MissionError(f"no free port on loopback found in {START_ATTEMPTS} attempts")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _run_once(
    order: LaunchPlan,
    family: ProcessGroup,
    mission: str,
    endpoint: str,
    show: Callable[[Progress], None],
) -> dict[str, Any] | None:
    """One attempt; None when the port was taken in between."""
    family.start_world(order.world_arguments)
    family.start_radio()
    family.start_recorder(order.out, order.record)
    for i in order.robots:
        family.start_robot(i)
    bus = _connect(family, mission, endpoint)
    if bus is None:
        return None
    with bus:
        return _Watch(order, family, bus, show).until_end()


def _connect(family: ProcessGroup, mission: str, endpoint: str) -> Bus | None:
    """The operator's session, as soon as the world listens; None when the port was taken in between."""
    while True:
        try:
            return open_client(
                mission, endpoint, topics.OPERATOR, family.operator_password, CONNECT_TRY_MS
            )
        except MissionError:
            if family.died(topics.WORLD):
                words = family.last_words(topics.WORLD)
                if "Address already in use" in words:
                    return None
                raise MissionError(words) from None


class _Watch:
    """The operator's seat of one running mission."""

    def __init__(
        self, order: LaunchPlan, family: ProcessGroup, bus: Bus, show: Callable[[Progress], None]
    ) -> None:
        self._order = order
        self._family = family
        self._bus = bus
        self._show = show
        self._tick = 0
        self._end: End | None = None
        self._result: dict[str, Any] | None = None
        self._interrupted = False
        self._control = bus.publisher(topics.by(topics.OPERATOR, topics.CONTROL))

    def until_end(self) -> dict[str, Any]:
        previous = {
            number: signal.signal(number, self._on_signal) for number in (signal.SIGINT, signal.SIGTERM)
        }
        try:
            self._watch()
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)
        self._family.await_end(LEAVE_S if self._end is not None else 0.0)
        if self._interrupted:
            raise KeyboardInterrupt
        return self._summary()

    def _on_signal(self, *_: object) -> None:
        self._interrupted = True
        self._control(b"stop")

    def _watch(self) -> None:
        waited_s = 0.0
        while self._result is None:
            received = self._bus.receive_by(time.monotonic() + POLL_S)
            if received is not None:
                self._take(*received)
                continue
            if self._family.died(topics.WORLD):
                return
            if self._end is not None:
                waited_s += POLL_S
                if self._family.died(topics.RECORDER) or waited_s > RESULT_S:
                    return

    def _take(self, what: str, data: bytes) -> None:
        if what == topics.PROGRESS:
            progress = decode(Progress, data)
            self._tick = progress.tick
            self._show(progress)
        elif what == topics.RESTART:
            self._family.start_robot(int(data))
        elif what == topics.END:
            self._end = decode(End, data)
        elif what == topics.RESULT:
            self._result = json.loads(data)

    def _summary(self) -> dict[str, Any]:
        processes = self._family.processes
        log = str(self._order.out / "mission.mcap") if self._order.record else None
        if self._result is not None:
            summary = {**self._result, "processes": [process._asdict() for process in processes]}
        elif self._end is not None:
            summary = summarize(self._end.outcome, self._end.wall_s, None, log, processes)
        else:
            outcome = Outcome("aborted", self._last_words(), (), (), (), self._tick, 0.0, 0)
            summary = summarize(outcome, 0.0, None, log, processes)
        self._order.out.mkdir(parents=True, exist_ok=True)
        (self._order.out / "summary.json").write_text(json.dumps(summary, indent=1) + "\n")
        return summary

    def _last_words(self) -> str:
        code = self._family.children[topics.WORLD].returncode
        if code is not None and code < 0:
            return f"the world process died ({signal.Signals(-code).name})"
        words = self._family.last_words(topics.WORLD)
        if code == 2:
            raise MissionError(words)
        return f"the world process died: {words}"


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
