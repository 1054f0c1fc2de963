"""`onehop explain`: why one robot did what it did at one moment."""

from pathlib import Path

from onehop.analysis.explanation import explain as explain_moment
from onehop.analysis.explanation_text import explanation_text
from onehop.commands.logs import check_moment, open_with_warning, warn_of_flaws
from onehop.commands.output import emit_json
from onehop.contracts.printable import json_value, printable

LONGEST_LINE = 2000
"""Letters of a line: a broadcast to fifty robots has some hundreds."""


def explain(path: Path, robot: int, at_s: float, window_s: float, as_json: bool) -> int:
    """Print the explanation; returns the exit status."""
    check_moment("--at", at_s)
    check_moment("--window", window_s)
    log = open_with_warning(path)
    warn_of_flaws(path, log.flaws)
    found = explain_moment(log, robot, at_s, window_s)
    if as_json:
        emit_json(json_value(found.as_json()))
    else:
        print("\n".join(printable(line, LONGEST_LINE) for line in explanation_text(found)))
    return 0
