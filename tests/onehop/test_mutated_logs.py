"""Whatever a file is: no traceback, no hang, bounded memory, and no success over what was not read."""

import os
import resource
import signal
import sys
import traceback
from collections.abc import Callable
from functools import partial
from pathlib import Path
from random import Random

import pytest

from onehop import cli
from onehop.analysis import open_log
from onehop.analysis.columns import TABLES
from onehop.contracts.errors import OnehopError
from tests.onehop.log_forms import CHUNK_DAMAGES, FORMS, mutated, ticks_of, with_extreme, write_form
from tests.onehop.scenes import field, log_of

CASES = int(os.environ.get("ONEHOP_MUTATED_LOGS", "300"))
SEED = int(os.environ.get("ONEHOP_MUTATED_SEED", "1"))

MEMORY_BYTES = 1 << 30
"""What a case may take beyond what the test itself has [B]."""

CASE_S = 60
"""Processor time of a case at most [s]."""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "mission.mcap"
    faults = "faults=[{kind='kill', at_s=0.5, robots=[2]}, {kind='hold', at_s=0.2, robots=[1]}]"
    settings = ("clock.limit_s=1.5", "team.next_period=0.2", "team.leader_timeout=0.4", faults)
    log_of(field(path.parent, *settings), path)
    return path


def _mutant(recorded: Path, path: Path, random: Random) -> None:
    """One of four kinds: damaged bytes, damaged chunks, forged messages, several of them."""
    form = random.choice([*FORMS.values()])
    ticks = ticks_of(recorded)
    if random.random() < 0.5:
        for _ in range(random.choice((1, 1, 5, 40))):
            tick, messages = random.choice(ticks)
            at = random.randrange(len(messages))
            key, data = messages[at]
            ticks[tick][1][at] = key, with_extreme(data, random)
        write_form(recorded, path, form, ticks)
        return
    write_form(recorded, path, form, ticks)
    data = path.read_bytes()
    if form.chunked and random.random() < 0.3:
        data = random.choice([*CHUNK_DAMAGES.values()])(data, random, path)
    else:
        data = mutated(data, random, path)
    path.write_bytes(data)


def _everything(path: Path, recorded: Path, folder: Path, random: Random) -> None:
    """Every way to read a log."""
    commands: list[list[object]] = [
        ["replay", path],
        ["replay", path, "--robot", 3, "--json", "--from", 0.5],
        ["explain", path, "--robot", random.choice((1, 2, 3, 4)), "--at", 0.9],
        ["explain", path, "--robot", random.choice((1, 2, 3, 4)), "--at", 1.2, "--json"],
        ["diff", path, recorded],
        ["diff", recorded, path, "--json"],
        ["salvage", path, "-o", folder / "saved.mcap"],
        ["view", path, "-o", folder / "view.mcap", "--json"],
    ]
    if random.random() < 0.2:
        commands.append(["report", path, "--out", folder / "report"])
    for command in commands:
        _call(*command)
    for saved in (folder / "saved.mcap", folder / "view.mcap"):
        if saved.exists():
            _call("diff", saved, recorded)
    try:
        log = open_log(path)
        for name in TABLES:
            log.table(name, start_s=0.4, end_s=0.8)
    except OnehopError:
        return


def _call(*arguments: object) -> None:
    sys.argv = ["onehop", *map(str, arguments)]
    try:
        cli.main()
    except SystemExit as left:
        if left.code not in (0, 1, 2):
            raise


def _in_a_fork(work: Callable[[], None], account: Path) -> str:
    """What went wrong in a process of its own with limits, "" if nothing did."""
    child = os.fork()
    if child == 0:
        status = 1
        try:
            pages = int(Path("/proc/self/statm").read_text().split()[0])
            limit = pages * resource.getpagesize() + MEMORY_BYTES
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
            resource.setrlimit(resource.RLIMIT_CPU, (CASE_S, CASE_S))
            output = os.open(account, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(output, 1)
            os.dup2(output, 2)
            sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115
            sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115
            work()
            status = 0
        except BaseException:
            traceback.print_exc()
            sys.stderr.flush()
        finally:
            os._exit(status)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return f"killed by {signal.Signals(os.WTERMSIG(status)).name}\n{account.read_text()[-500:]}"
    return "" if status == 0 else account.read_text(errors="replace")[-3000:]


@pytest.mark.slow
@pytest.mark.parametrize("batch", range(10))
def test_a_mutated_log_is_read_or_refused(recorded: Path, tmp_path: Path, batch: int) -> None:
    broken = {}
    for case in range(batch, CASES, 10):
        random = Random(f"{SEED} {case}")
        folder = tmp_path / str(case)
        folder.mkdir()
        path = folder / "mutant.mcap"
        _mutant(recorded, path, random)
        read = partial(_everything, path, recorded, folder, random)
        why = _in_a_fork(read, folder / "account")
        if why:
            broken[case] = why
    assert not broken, "\n".join(f"case {case}: {why}" for case, why in broken.items())
