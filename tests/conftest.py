"""What all tests share."""

import signal
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("untimed", settings.default, deadline=None)
settings.load_profile("untimed")
"""No test is timed: how long an example takes says how busy the machine is."""


def pytest_configure() -> None:
    """Let child processes hear signals that the tests themselves are to ignore.

    A script's background job ignores SIGINT and one under nohup SIGHUP, and its children would too; a
    signal that is handled, if only by doing nothing, is as usual in them.
    """
    for number in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, lambda *_: None)


TESTS = Path(__file__).parent

LONGEST = (
    "live/test_tutorial.py", "live/test_chaos.py", "live/test_ends.py", "live/test_deaths.py",
    "live/test_verify.py", "live/test_realtime.py", "live/test_programs.py",
    "live/test_other_languages.py", "live/test_several_hosts.py", "live/test_sweep.py",
    "onehop/study/test_study_command.py", "onehop/drivers/test_same_bits.py",
    "agent/test_thesis_missions.py", "agent/test_missions.py", "onehop/study/test_sweep_command.py",
    "onehop/chaos/test_campaign.py", "agent/planning/test_laser_and_period.py", "fuzz/test_fuzz.py",
)  # fmt: skip
"""Files of the stages `slow` and `live` that begin first: the last one is left to one worker."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files that take longest first; pytest-xdist keeps to it if it is told (Makefile)."""
    ranks = {TESTS / name: rank for rank, name in enumerate(LONGEST)}
    assert all(path.exists() for path in ranks)
    items.sort(key=lambda item: ranks.get(item.path, len(LONGEST)))
