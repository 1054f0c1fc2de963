"""How every command speaks: people on stderr and stdout, scripts through one JSON object on stdout."""

import json
import sys
from typing import Any

from rich.console import Console
from rich.table import Table

PIPE_WIDTH = 110


def emit_json(value: dict[str, Any]) -> None:
    """The one JSON object of `--json`."""
    print(json.dumps(value, indent=1))


def say(text: str) -> None:
    """A line for people that is no result: progress, warnings."""
    print(text, file=sys.stderr, flush=True)


def stdout() -> Console:
    """The console of results; wide enough for our tables where there is no terminal to measure."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else PIPE_WIDTH)


def table(title: str, *columns: str) -> Table:
    """An empty table, all columns but the first aligned to the right."""
    made = Table(title=title, title_justify="left", title_style="bold")
    for number, column in enumerate(columns):
        made.add_column(column, justify="right" if number else "left")
    return made
