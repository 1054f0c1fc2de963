"""What every process of a mission does at its start: options, identity, lifeline, the way to the bus."""

import argparse
import contextlib
import faulthandler
import gc
import os
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from onehop.contracts import topics
from onehop.contracts.errors import InputError, MissionError, OnehopError
from onehop.node import lifeline
from onehop.node.bus import ALIVE, Bus, open_certified_router, open_client, open_router
from onehop.node.identity import TLS, Certificate, Identity
from onehop.node.own_settings import keep_to_own_settings

DEFAULT_MISSION = "onehop"
"""Prefix of a mission's keys where nobody gives one: several hosts need not be told."""

PASSWORD_VARIABLE = "ONEHOP_PASSWORD"
"""Environment variable with a process's password; an argument would show in ps. What the process starts
does not inherit it."""

CREDENTIALS_VARIABLE = "ONEHOP_CREDENTIALS"
"""Environment variable of the world: all names and passwords, as name:password words."""

BRIEFING_TIMEOUT_S = 30.0
"""How long the world may take to answer the question for a briefing [s]."""

FIRST_TRY_MS = 10_000
"""How long a process that people have started looks for the bus before it says what is wrong [ms]."""

REUNION_S = 10.0
"""How long a process looks for the world when its session has been given up [s]: while it starts, when
it was stopped, and in real time when it was cut off; then a robot joins again, and knows nothing."""

WORLD_IS_GONE = 3
"""Exit status of a process that ends because the world has gone."""

PROGRAM_FAILED = 4
"""Exit status of a robot whose program has failed; its traceback is on stderr."""


def arguments(program: str, purpose: str) -> argparse.ArgumentParser:
    """The options that all processes of a mission share."""
    parser = argparse.ArgumentParser(prog=f"python -m {program}", description=purpose)
    parser.add_argument(
        "--mission", default=DEFAULT_MISSION, help="prefix of the mission's keys on the bus"
    )
    parser.add_argument("--lifeline", type=int, help=argparse.SUPPRESS)
    return parser


def add_connect(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--connect", required=True, metavar="ENDPOINT", help="the world's bus, e.g. tls/10.0.0.1:7447"
    )
    add_keys(parser)


def add_keys(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--keys", type=Path, metavar="DIR", help="folder of certificates (onehop keys): for tls/..."
    )


def start(options: argparse.Namespace) -> None:
    """Tie this process to its launcher, if it has one, and leave Ctrl-C to the launcher.

    On Linux the scheduler is told that this is no interactive program: a process that wakes up does not
    push the running one from its core, so every tick takes fewer switches (15 % more ticks a second).
    A crash in a library's machine code leaves a traceback too.
    """
    faulthandler.enable()
    keep_to_own_settings()
    if hasattr(os, "SCHED_BATCH"):
        with contextlib.suppress(PermissionError):  # a container may forbid it
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    if options.lifeline is not None:
        lifeline.hold(options.lifeline)
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def give_way() -> None:
    """Let this thread, and those that it will start, run when nothing else wants to (Linux: SCHED_IDLE).

    A mission in lock-step takes all of the processors, and each of its processes is waited for by all:
    what only looks at it must not hold up any. They have to be of one session for that, since Linux
    shares the processors among sessions first (sched(7), autogroup).
    """
    if hasattr(os, "SCHED_IDLE"):
        with contextlib.suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))


def be_on_time(is_ours: bool = True) -> None:
    """Let this process run as soon as it wakes up: it has a schedule.

    Where the system allows it (CAP_SYS_NICE, RLIMIT_RTPRIO) it goes before all that is not in real time
    (SCHED_RR, as ros2_control's controller manager asks for SCHED_FIFO), else by the usual scheduling.
    is_ours: it is none of anybody's programs, and goes before those. Threads that there are already are
    told one by one.
    """
    if hasattr(os, "SCHED_BATCH"):
        for thread in map(int, os.listdir("/proc/self/task")):
            for policy, priority in ((os.SCHED_OTHER, 0), (os.SCHED_RR, 2 if is_ours else 1)):
                with contextlib.suppress(OSError):  # ended meanwhile, or not allowed
                    os.sched_setscheduler(thread, policy, os.sched_param(priority))


def connect(options: argparse.Namespace, name: str) -> Bus:
    """Open this process's session with its own identity. Raises InputError or MissionError."""
    identity: Identity | None = os.environ.pop(PASSWORD_VARIABLE, None)
    if require_keys_for_tls(options.connect, options.keys):
        identity = certificate(options.keys, name)
    if options.lifeline is not None:
        return open_client(options.mission, options.connect, name, identity)
    with _ended_by_ctrl_c():
        try:
            return open_client(options.mission, options.connect, name, identity, FIRST_TRY_MS)
        except MissionError:
            from onehop.node.reachability import why_not  # with OpenSSL, which Zenoh does not need

            why = why_not(options.connect, identity)
            _say(f"{name}: no bus at {options.connect} yet: {why}\n")
        return open_client(options.mission, options.connect, name, identity)


@contextlib.contextmanager
def _ended_by_ctrl_c() -> Iterator[None]:
    """Let Ctrl-C end this process outright meanwhile: Zenoh does not look at Python's signals."""
    before = signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def host(options: argparse.Namespace, names: Iterable[str]) -> Bus:
    """Open the world's session, the router's or that of a router's client.

    names: who may come, if they have certificates.
    """
    if options.connect is not None:
        return connect(options, topics.WORLD)
    if require_keys_for_tls(options.listen, options.keys):
        own = certificate(options.keys, topics.WORLD)
        return open_certified_router(options.mission, options.listen, own, names)
    words = os.environ.pop(CREDENTIALS_VARIABLE, None)
    credentials = None if words is None else dict(word.split(":", 1) for word in words.split())
    return open_router(options.mission, options.listen, credentials)


def require_keys_for_tls(endpoint: str, keys: Path | None) -> bool:
    """Whether an endpoint is one for certificates. Raises InputError if there are none, or in vain."""
    if endpoint.startswith(TLS) != (keys is not None):
        wrong = "--keys is missing" if keys is None else f"--keys {keys} is for tls/..., and this is not"
        raise InputError(endpoint, wrong, "tls/HOST:PORT with --keys DIR, a folder made by onehop keys")
    return keys is not None


def certificate(keys: Path, name: str) -> Certificate:
    """A process's own certificate. Raises InputError when it is of no use."""
    from onehop.node.certificates import own_certificate  # a library of 50 ms that few missions need

    return own_certificate(keys, name)


def briefing(bus: Bus, name: str, announce: Callable[[], None] = lambda: None) -> bytes:
    """Ask the world for this process's briefing; the world may need a moment to be ready.

    announce: called before each question.
    """
    deadline = time.monotonic() + BRIEFING_TIMEOUT_S
    while time.monotonic() < deadline:
        announce()
        answer = bus.ask(topics.config(name), timeout_s=2.0)
        if answer is not None:
            return answer
        time.sleep(0.02)
    raise MissionError(f"{name}: the world gave no briefing within {BRIEFING_TIMEOUT_S:.0f} s")


def first_of(bus: Bus, within_s: float, *wanted: tuple[str, bytes]) -> tuple[str, bytes] | None:
    """The first of these that comes in time; what else is said is lost, and the world will ask again."""
    deadline = time.monotonic() + within_s
    while (received := bus.receive_by(deadline)) is not None:
        if received in wanted:
            return received
    return None


def finds_world(bus: Bus) -> bool:
    """Whether the world comes back in time."""
    return first_of(bus, REUNION_S, (topics.alive(topics.WORLD), ALIVE)) is not None


def calm_garbage_collector() -> None:
    """Keep what the start has built out of every later collection: it lives as long as the process."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 100)


def main(body: Callable[[], int]) -> None:
    """Run a process to its exit status; what a person can mend is one line on stderr, status 2.

    A bug, or a library's panic, is a traceback, status 1. Either way the process ends here, whatever
    threads it still has, and also when there is no room for its words.
    """
    try:
        status = body()
    except OnehopError as error:
        status = 2
        _say(f"{error}\n")
    except SystemExit:  # what was typed is wrong, and has been said
        raise
    except KeyboardInterrupt:
        status = 128 + signal.SIGINT
    except BaseException:
        status = 1
        _say(traceback.format_exc())
    os._exit(status)


def _say(words: str) -> None:
    with contextlib.suppress(OSError):
        sys.stderr.write(words)
        sys.stderr.flush()
