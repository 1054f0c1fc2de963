"""Workers: every item has a result or a reason, and no worker is left behind."""

import os
import signal
import subprocess
import sys
import time

import pytest

from onehop.campaign.workers import Crash, on_cores, on_dask
from onehop.contracts.errors import InputError
from tests.live.mission import gone
from tests.onehop.campaign import errands

pytestmark = pytest.mark.slow


def test_every_item_is_done_once() -> None:
    done = list(on_cores(errands.double, range(20), 2))
    assert sorted((one.item, one.result) for one in done) == [(n, 2 * n) for n in range(20)]


def test_work_that_raises_has_crashed_and_the_rest_goes_on() -> None:
    done = {one.item: one.result for one in on_cores(errands.fail_at_three, range(6), 2)}
    assert done == {0: 0, 1: 1, 2: 2, 3: Crash("ValueError: three"), 4: 4, 5: 5}


def test_a_worker_that_dies_takes_only_its_own_item_along() -> None:
    done = [(one.item, one.result) for one in on_cores(errands.die_at_three, range(8), 2)]
    assert sorted(done, key=lambda one: one[0]) == [
        (n, Crash("its process died") if n == 3 else n) for n in range(8)
    ]


def test_who_stops_asking_leaves_no_worker_behind() -> None:
    results = on_cores(errands.own_pid, [0.0, 60.0, 60.0], 2)
    pid = next(results).result
    results.close()  # type: ignore[attr-defined]
    assert gone([int(str(pid))])


@pytest.mark.live
def test_workers_end_with_who_is_killed() -> None:
    text = (
        "from onehop.campaign.workers import on_cores; from tests.onehop.campaign import errands\n"
        "if __name__ == '__main__':\n"
        "    for one in on_cores(errands.own_pid, [0.0, 60.0, 60.0], 1): print(one.result, flush=True)"
    )
    with subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        worker = int(parent.stdout.readline())
        os.kill(parent.pid, signal.SIGKILL)
        assert gone([worker])


def test_dask_does_the_same() -> None:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        done = list(on_dask(errands.fail_at_three, range(6), cluster.scheduler_address))
    expected = {n: n for n in range(6)} | {3: Crash("ValueError: three")}
    assert {one.item: one.result for one in done} == expected


def test_a_scheduler_that_is_not_there_is_one_line() -> None:
    pytest.importorskip("distributed")
    started = time.monotonic()
    with pytest.raises(InputError, match=r"--dask tcp://127\.0\.0\.1:1: "):
        list(on_dask(errands.double, range(2), "tcp://127.0.0.1:1"))
    assert time.monotonic() - started < 60.0
