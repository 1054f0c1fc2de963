"""How every command opens a log: a torn one with one line of warning, up to where it is sound."""

from pathlib import Path

from onehop.analysis.log import Log, open_log
from onehop.commands.output import say


def open_with_warning(path: Path) -> Log:
    """Raises LogError when it is no log of ours."""
    log = open_log(path)
    if log.torn:
        say(
            f"warning: {path} is torn: its recorder was killed; going on with what is sound "
            "(onehop salvage makes a sound log of it)"
        )
    return log
