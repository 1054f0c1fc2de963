"""`onehop report`: a mission on one page, its figures, and a film if wanted."""

from pathlib import Path
from typing import Any

from onehop.analysis.report.page import write_report
from onehop.commands.logs import open_with_warning, warn_of_flaws
from onehop.commands.output import emit_json


def report(path: Path, out: Path | None, film: str | None, as_json: bool) -> int:
    """Write everything into a folder, by default `report` beside the log; returns the exit status."""
    log = open_with_warning(path)
    folder = out or path.parent / "report"
    page, figures, flaws = write_report(log, folder)
    written: dict[str, Any] = {"report": str(page), "figures": [str(figure) for figure in figures]}
    written["flaws"] = flaws
    if film is not None:
        from onehop.analysis.film import write_film

        moving = folder / f"mission.{film}"
        write_film(log, moving)
        written["film"] = str(moving)
    if as_json:
        emit_json(written)
    else:
        print(f"report   {page}")
        print(f"figures  {', '.join(figure.name for figure in figures)} (and .svg)")
        if film is not None:
            print(f"film     {written['film']}")
    warn_of_flaws(path, flaws)
    return 1 if flaws else 0
