"""Runs cases of every kind, some at a time, and tells how they ended."""

import importlib
import os
import shutil
from collections import deque
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from random import Random
from typing import NamedTuple

from tests.fuzz import maps, scenarios
from tests.fuzz.commands import ACCOUNT, Kind
from tests.fuzz.logs import Logs, record
from tests.fuzz.messages import Messages
from tests.fuzz.sandbox import Child, Ended, Outcome

SHARES = {"scenario": 3, "map": 3, "log": 1, "message": 3}
"""Of how many cases in ten a kind is; a log takes ten times as long as any other."""

COMMANDS = ("run", "plan", "replay", "explain", "diff", "salvage", "view", "report", "check")
"""Whose modules are loaded once, before any case."""

GOOD = (Outcome.ACCEPTED, Outcome.REFUSED)


class Result(NamedTuple):
    """How one case ended. number: of the case within its kind."""

    kind: str
    number: int
    ended: Ended
    folder: Path


class Fuzzer:
    """Cases from a seed. folder: keeps the inputs of those that went wrong."""

    def __init__(self, folder: Path, seed: int) -> None:
        self._folder, self._seed = folder, seed
        recorded = folder / "recorded.mcap"
        record(recorded)
        maps.load_kernels(folder)
        for name in COMMANDS:
            importlib.import_module(f"onehop.commands.{name}")
        logs, messages = Logs(recorded), Messages(recorded)
        self._kinds = {
            "scenario": Kind(scenarios.make, scenarios.read),
            "map": Kind(maps.make, maps.read),
            "log": Kind(logs.make, logs.read),
            "message": Kind(messages.make, messages.read),
        }

    def run(self, kind: str, numbers: range, jobs: int = 1) -> Iterator[Result]:
        """The cases of these numbers of a kind, jobs at a time."""
        waiting = deque(numbers)
        running: deque[tuple[int, Path, Child]] = deque()
        while waiting or running:
            while waiting and len(running) < jobs:
                number = waiting.popleft()
                folder = self._folder / f"{kind}-{number}"
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir()
                case = partial(self._case, self._kinds[kind], Random(f"{self._seed} {kind} {number}"))
                running.append((number, folder, Child(partial(case, folder), folder / ACCOUNT)))
            number, folder, child = running.popleft()
            ended = child.wait()
            if ended.outcome in GOOD:
                shutil.rmtree(folder)
            yield Result(kind, number, ended, folder)

    @staticmethod
    def _case(kind: Kind, random: Random, folder: Path) -> None:
        kind.make(folder, random)
        kind.read(folder)


def jobs_of_this_machine() -> int:
    """Cases at a time: one for each processor."""
    return len(os.sched_getaffinity(0))
