"""`onehop view`: add to a log what Foxglove and Rerun can show."""

import shutil
import subprocess
from pathlib import Path
from typing import Any

from onehop.analysis.view.layer import write_view
from onehop.analysis.view.rerun_layout import write_layout
from onehop.commands.logs import open_with_warning, warn_of_flaws
from onehop.commands.output import emit_json, say
from onehop.contracts.errors import InputError


def view(path: Path, out: Path | None, open_viewer: bool, as_json: bool) -> int:
    """Write the viewer layer, into the log itself by default; returns the exit status."""
    log = open_with_warning(path)
    target = out or path
    if out is None and (log.torn or log.flaws):
        why = "is torn" if log.torn else log.flaws[0]
        raise InputError(str(path), f"{why}: it is not overwritten", "name a new file with -o")
    viewer = shutil.which("rerun")
    if open_viewer and viewer is None:
        raise InputError("--open", "Rerun is not installed", "pip install 'onehop[rerun]'")
    counts, flaws = write_view(log, target)
    layout = write_layout(log, target)
    if as_json:
        written: dict[str, Any] = {"log": str(target), "topics": counts}
        emit_json({**written, "layout": None if layout is None else str(layout)})
    else:
        print(f"log     {target}: {sum(counts.values())} viewer messages on {len(counts)} topics")
        print(f"layout  {layout or 'none (pip install onehop[rerun] for one)'}")
        print("open    it in Foxglove, or: rerun " + " ".join(map(str, filter(None, (target, layout)))))
    if open_viewer and viewer is not None:
        say("starting Rerun")
        subprocess.Popen([viewer, str(target), *([str(layout)] if layout else [])])
    warn_of_flaws(path, flaws)
    return 1 if flaws else 0
