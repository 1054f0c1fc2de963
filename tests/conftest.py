"""What all tests share."""

import signal

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
