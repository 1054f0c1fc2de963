"""`onehop explain`: why one robot did what it did at one moment."""

from pathlib import Path

from onehop.analysis.explanation import explain as explain_moment
from onehop.analysis.explanation_text import explanation_text
from onehop.commands.logs import open_with_warning
from onehop.commands.output import emit_json


def explain(path: Path, robot: int, at_s: float, window_s: float, as_json: bool) -> int:
    """Print the explanation; returns the exit status."""
    found = explain_moment(open_with_warning(path), robot, at_s, window_s)
    if as_json:
        emit_json(found.as_json())
    else:
        print("\n".join(explanation_text(found)))
    return 0
