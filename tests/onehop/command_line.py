"""The command `onehop` in tests: in their own process, without a new Python, or in one of its own."""

import contextlib
import io
import os
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


def in_shell(
    *arguments: str | Path, cwd: Path | None = None, shell: str = "true", **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run the command in a process of its own. shell: what a shell does before it, such as `ulimit`."""
    return subprocess.run(
        [
            "bash",
            "-c",
            f'{shell}; exec "$@"',
            "bash",
            sys.executable,
            "-m",
            "onehop",
            *map(str, arguments),
        ],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        cwd=cwd,
        env={**os.environ, **environment},
    )


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
