"""The command `onehop` in the process of the test: what a person gets to see, without a new Python."""

import contextlib
import io
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from onehop.cli import main

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Signals that the command takes over, and a test gets back."""


def onehop(*arguments: object, cwd: Path | None = None) -> "subprocess.CompletedProcess[str]":
    """Run the command in a folder. Limits of the shell and the environment want a process of its own."""
    words = ["onehop", *map(str, arguments)]
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(cwd or Path.cwd()),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        _typed(words),
    ):
        try:
            main()
        except SystemExit as left:
            status = int(left.code or 0)
    return subprocess.CompletedProcess(words, status, out.getvalue(), err.getvalue())


@contextlib.contextmanager
def _typed(words: list[str]) -> Iterator[None]:
    """Let the command find these words, and give back what it takes over."""
    argv, handlers = sys.argv, {number: signal.getsignal(number) for number in ENDING}
    sys.argv = words
    try:
        yield
    finally:
        sys.argv = argv
        for number, handler in handlers.items():
            signal.signal(number, handler)
