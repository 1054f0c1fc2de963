"""A case in a process of its own, with limits: how it ended, and what it said."""

import os
import resource
import signal
import sys
import traceback
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

from onehop.contracts.errors import OnehopError

MEMORY_BYTES = 2 << 30
"""What a case may take [B]: of memory in all, and of addresses beyond those that the fuzzer has."""

CPU_S = 10
"""Processor time of a case at most [s]; a good input takes less than one."""

WALL_S = 60
"""The same by the wall clock [s], for a case that waits; long, since the machine may be busy."""

_ACCEPTED, _BROKEN, _REFUSED, _OUT_OF_MEMORY = 0, 1, 2, 3
"""What a case's process says with its exit status."""

_SHOWN = 3000
"""Characters of a case's last words that are kept."""


class Outcome(StrEnum):
    """How a case ended; the first two are as they should be."""

    ACCEPTED = "accepted"
    REFUSED = "refused"
    TRACEBACK = "traceback"
    HANG = "hang"
    MEMORY = "memory"
    KILLED = "killed"


class Ended(NamedTuple):
    """How a case ended, its last words, its processor time [s]."""

    outcome: Outcome
    words: str
    cpu_s: float


class Child:
    """A case that runs. work: raises OnehopError for what it refuses. account: file for its output."""

    def __init__(self, work: Callable[[], None], account: Path, cpu_s: int = CPU_S) -> None:
        self._account = account
        self._pid = os.fork()
        if self._pid == 0:
            _run_and_leave(work, account, cpu_s)

    def wait(self) -> Ended:
        """Wait for its end."""
        _, status, usage = os.wait4(self._pid, 0)
        words = self._account.read_text(errors="replace")[-_SHOWN:]
        outcome = _outcome(status)
        if usage.ru_maxrss * 1024 > MEMORY_BYTES:  # Linux counts it in KiB
            outcome = Outcome.MEMORY
        return Ended(outcome, words, usage.ru_utime + usage.ru_stime)


def _run_and_leave(work: Callable[[], None], account: Path, cpu_s: int) -> None:
    status = _BROKEN
    try:
        _limit(cpu_s)
        _write_to(account)
        work()
        status = _ACCEPTED
    except OnehopError as refusal:
        print(refusal, file=sys.stderr)
        status = _REFUSED if str(refusal).isprintable() else _BROKEN
    except MemoryError:
        traceback.print_exc()
        status = _OUT_OF_MEMORY
    except BaseException:  # whatever it is, it is what we look for
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def _limit(cpu_s: int) -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    memory = pages * resource.getpagesize() + MEMORY_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(WALL_S)


def _write_to(account: Path) -> None:
    output = os.open(account, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
    os.dup2(output, 1)
    os.dup2(output, 2)
    sys.stdout = open(1, "w", closefd=False, errors="backslashreplace")  # noqa: SIM115
    sys.stderr = open(2, "w", closefd=False, errors="backslashreplace")  # noqa: SIM115


def _outcome(status: int) -> Outcome:
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        return Outcome.HANG if number in (signal.SIGXCPU, signal.SIGALRM) else Outcome.KILLED
    return {
        _ACCEPTED: Outcome.ACCEPTED,
        _REFUSED: Outcome.REFUSED,
        _OUT_OF_MEMORY: Outcome.MEMORY,
    }.get(os.WEXITSTATUS(status), Outcome.TRACEBACK)
