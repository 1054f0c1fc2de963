"""How every command opens a log: a torn one with one line of warning, and how it tells of flaws."""

import math
from collections.abc import Sequence
from pathlib import Path

from onehop.analysis.log import Log, open_log
from onehop.commands.output import say
from onehop.contracts.errors import InputError

_TOLD = 3
"""Flaws of a log that are told; a log that was cut up can have thousands."""


def open_with_warning(path: Path) -> Log:
    """Raises LogError when it is no log of ours."""
    log = open_log(path)
    if log.torn:
        say(
            f"warning: {path} is torn: its recorder was killed; going on with what is sound "
            "(onehop salvage makes a sound log of it)"
        )
    return log


def warn_of_flaws(path: Path, flaws: Sequence[str]) -> None:
    """One line that says in what a log is not what it should be, if there is anything."""
    if flaws:
        say(f"warning: {path}: {flaws_in_words(flaws)}")


def flaws_in_words(flaws: Sequence[str]) -> str:
    """The first flaws of a log, and how many more it has."""
    more = f"; and {len(flaws) - _TOLD} more flaws" if len(flaws) > _TOLD else ""
    return "; ".join(flaws[:_TOLD]) + more


def check_moment(option: str, time_s: float) -> None:
    """Raises InputError for a number that is no moment of a mission."""
    if not math.isfinite(time_s) or time_s < 0:
        raise InputError(f"{option} {time_s:g}", "is no moment of a mission", "seconds from its start")
