"""Whatever comes from outside is accepted or refused in one line: no traceback, hang or flood."""

import os
import signal
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from onehop.contracts.errors import OnehopError
from tests.fuzz.fuzzer import GOOD, Fuzzer, jobs_of_this_machine
from tests.fuzz.sandbox import MEMORY_BYTES, Child, Outcome

CASES = {"scenario": 40, "map": 30, "message": 40, "log": 30}
SEED = 1


@pytest.fixture(scope="module")
def fuzzer(tmp_path_factory: pytest.TempPathFactory) -> Fuzzer:
    return Fuzzer(tmp_path_factory.mktemp("fuzz"), SEED)


@pytest.mark.slow
@pytest.mark.parametrize("kind", CASES)
def test_every_mutated_input_is_accepted_or_refused_in_one_line(fuzzer: Fuzzer, kind: str) -> None:
    cases = range(CASES[kind])
    results = list(fuzzer.run(kind, cases, jobs_of_this_machine()))
    wrong = [result for result in results if result.ended.outcome not in GOOD]
    assert not wrong, "\n".join(f"{r.kind} {r.number}: {r.ended.outcome} {r.ended.words}" for r in wrong)
    counts = Counter(result.ended.outcome for result in results)
    assert min(counts[outcome] for outcome in GOOD) >= len(cases) // 10


def _refuse() -> None:
    raise OnehopError("no")


def _refuse_in_two_lines() -> None:
    raise OnehopError("no\nno")


def _fail() -> None:
    raise KeyError("x")


def _take_memory() -> None:
    bytearray(2 * MEMORY_BYTES)


def _loop() -> None:
    while True:
        pass


def _die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize(
    ("work", "outcome"),
    [
        (time.process_time, Outcome.ACCEPTED),
        (_refuse, Outcome.REFUSED),
        (_refuse_in_two_lines, Outcome.TRACEBACK),
        (_fail, Outcome.TRACEBACK),
        (_take_memory, Outcome.MEMORY),
        (_loop, Outcome.HANG),
        (_die, Outcome.KILLED),
    ],
    ids=lambda value: getattr(value, "__name__", str(value)),
)
def test_the_sandbox_tells_each_end_from_the_others(
    work: Callable[[], None], outcome: Outcome, tmp_path: Path
) -> None:
    assert Child(work, tmp_path / "account", cpu_s=1).wait().outcome is outcome
