"""The command line as a case calls it."""

import sys
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import NamedTuple

from onehop import cli
from onehop.contracts.errors import OnehopError

ACCOUNT = "account.txt"
"""File of a case's folder that holds what it said."""


class Kind(NamedTuple):
    """A kind of input. make: writes the input of a case into its folder. read: reads what is there.

    read raises OnehopError when it refuses the input.
    """

    make: Callable[[Path, Random], None]
    read: Callable[[Path], None]


def call(folder: Path, *arguments: object) -> None:
    """Run a command. Raises OnehopError with its line when it refuses its input with status 2.

    folder: of the case, with the file in which its output ends, where the line is looked for.
    """
    account = folder / ACCOUNT
    sys.argv = ["onehop", *map(str, arguments)]
    sys.stdout.flush()
    before = account.stat().st_size
    try:
        cli.main()
    except SystemExit as left:
        if left.code in (0, 1):
            return
        if left.code != 2:
            raise
    sys.stdout.flush()
    sys.stderr.flush()
    said = account.read_bytes()[before:].decode()
    line = said.removesuffix("\n").rpartition("\n")[2]
    if said.count("onehop: ") != 1 or not line.startswith("onehop: ") or not line.isprintable():
        raise AssertionError(f"refused, but not in one line at the end: {said[-500:]!r}")
    raise OnehopError(line)
