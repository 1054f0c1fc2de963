"""One function over many items, on all cores of this machine or on a Dask cluster, as results come.

A worker that dies takes nothing else along: what was in flight is tried again, one at a time, and the
item at which a worker dies again has crashed. No worker outlives who asked for it.
"""

import importlib
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from itertools import islice
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection
from typing import Any, Generic, TypeAlias, TypeVar

from onehop.contracts.errors import InputError

T = TypeVar("T")
R = TypeVar("R")

CONNECT_S = 10
"""How long a scheduler may take to answer [s]."""

AHEAD = 2
"""Items that are handed out for each worker: one that it works on, and its next."""


@dataclass(frozen=True, slots=True)
class Crash:
    """What an item has in the place of a result, and why."""

    why: str


@dataclass(frozen=True, slots=True)
class Done(Generic[T, R]):
    """An item and what came of it."""

    item: T
    result: R | Crash


Run: TypeAlias = Callable[[Callable[[Any], Any], Iterable[Any]], Iterator[Done[Any, Any]]]
"""Does work on items by some workers."""


def workers(jobs: int | None, dask: str | None) -> Run:
    """Those of the scheduler at the address `dask`, or `jobs` processes here, by default one a core."""
    if dask is not None:
        return lambda work, items: on_dask(work, items, dask)
    count = jobs or len(os.sched_getaffinity(0))
    return lambda work, items: on_cores(work, items, count)


def on_cores(work: Callable[[T], R], items: Iterable[T], jobs: int) -> Iterator[Done[T, R]]:
    """Results in the order in which they come. work: a function of a module, which workers import."""
    waiting, again = iter(items), deque[T]()
    while not (yield from _until_a_worker_dies(work, waiting, again, jobs)):
        pass


def _until_a_worker_dies(
    work: Callable[[T], R], waiting: Iterator[T], again: "deque[T]", jobs: int
) -> Generator[Done[T, R], None, bool]:
    """Work with one set of processes; whether everything is done.

    again: what was in flight when others died. It is tried first, and alone.
    """
    end, lifeline = Pipe(duplex=False)
    pool = ProcessPoolExecutor(jobs, get_context("spawn"), _settle, (end,))
    flying: dict[Future[R], T] = {}
    try:
        while True:  # a second try is alone: nothing flies before it, and it is waited for at once
            is_second_try = bool(again)
            room = AHEAD * jobs - len(flying)
            for item in [again.popleft()] if again else islice(waiting, room):
                flying[pool.submit(work, item)] = item
            if not flying:
                return True
            lost: list[T] = []
            for future in wait(flying, return_when=FIRST_COMPLETED).done:
                item, error = flying.pop(future), future.exception()
                if isinstance(error, BrokenProcessPool):
                    lost.append(item)
                else:
                    yield Done(item, _crash(error) if error is not None else future.result())
            if lost and is_second_try:
                yield Done(lost[0], Crash("its process died"))
                return False
            if lost:
                again.extend([*lost, *flying.values()])
                return False
    finally:
        lifeline.close()
        end.close()
        pool.shutdown(cancel_futures=True)


def _settle(lifeline: Connection) -> None:
    """A worker leaves Ctrl-C to who started it, and ends with it, whatever ends that."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_at_end, args=(lifeline,), name="lifeline", daemon=True).start()


def _leave_at_end(lifeline: Connection) -> None:
    try:
        lifeline.recv_bytes()
    except (EOFError, OSError):
        os._exit(1)


def on_dask(work: Callable[[T], R], items: Iterable[T], address: str) -> Iterator[Done[T, R]]:
    """The same on the workers of a dask.distributed scheduler. Raises InputError if there are none."""
    distributed = _distributed(address)
    try:
        client: Any = distributed.Client(address, timeout=CONNECT_S)
    except (OSError, ValueError) as refused:
        remedy = "the address of a scheduler that runs, e.g. tcp://127.0.0.1:8786"
        raise InputError(f"--dask {address}", str(refused).splitlines()[0], remedy) from None
    with client:
        threads = list(client.nthreads().values())
        if not threads or max(threads) > 1:
            what = "no worker" if not threads else f"workers of {max(threads)} threads"
            remedy = "start workers of one thread each: dask worker ADDRESS --nthreads 1"
            raise InputError(f"--dask {address}", what, remedy)
        waiting = iter(items)
        flying: dict[Any, T] = {}
        running = distributed.as_completed()
        for item in islice(waiting, AHEAD * len(threads)):
            flying[_submitted(client, running, work, item)] = item
        for future in running:
            item, error = flying.pop(future), future.exception()
            for following in islice(waiting, 1):
                flying[_submitted(client, running, work, following)] = following
            yield Done(item, future.result() if error is None else _crash(error))


def _submitted(client: Any, running: Any, work: Callable[[T], R], item: T) -> Any:
    future = client.submit(work, item, pure=False)
    running.add(future)
    return future


def _distributed(address: str) -> Any:
    try:
        return importlib.import_module("distributed")
    except ImportError:
        remedy = "install it: pip install 'onehop[dask]'"
        raise InputError(f"--dask {address}", "dask.distributed is not installed", remedy) from None


def _crash(error: BaseException) -> Crash:
    return Crash(f"{type(error).__name__}: {error}")
