"""The command `onehop`. Exit status: 0 did it, 1 ran and the answer is no, 2 could not run; after an
orderly end by a signal 128 and its number: 130 Ctrl-C, 143 SIGTERM, 129 SIGHUP.
"""

import io
import os
import signal
import sys
from typing import NoReturn

import typer

from onehop.commands import hosts_app, log_app, many_app, programs_app, study_app  # noqa: F401 - they add theirs
from onehop.commands.app import app
from onehop.contracts.errors import OnehopError
from onehop.contracts.printable import printable
from onehop.mission.stops import Stopped, raise_when_asked_to_end
from onehop.node.own_settings import keep_to_own_settings


def main() -> NoReturn:
    """Entry point: no traceback for what a person typed or a system refused, one line instead."""
    _settle_streams()
    keep_to_own_settings()
    raise_when_asked_to_end()
    try:
        status = typer.main.get_command(app).main(standalone_mode=False)
        sys.stdout.flush()
    except BaseException as error:
        told = _told(error)
        if told is None:
            raise
        line, status = told
        if line:
            print(f"onehop: {printable(line)}", file=sys.stderr)
    sys.exit(status)


def _settle_streams() -> None:
    """Open standard streams that the shell has closed, and let them print whatever a file is called."""
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115 - open until the end
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _told(error: BaseException) -> tuple[str, int] | None:
    """One line for people and the exit status; None for a mistake of ours, which is a traceback."""
    match error:
        case OnehopError():
            return str(error), 2
        case typer.TyperException():
            return f"{error.format_message()}; see onehop --help", 2
        case Stopped():
            return f"ended by {signal.Signals(error.number).name}", 128 + error.number
        case BrokenPipeError():  # who reads our output has had enough
            return "", 1
        case OSError():
            where = f"{os.fsdecode(error.filename)}: " if error.filename is not None else ""
            return f"{where}{error.strerror or error}", 2
    if type(error).__module__ == "pyo3_runtime":
        return f"a library failed: {error}", 2
    return None
