"""`onehop export`: a log for the tools of others."""

from pathlib import Path

from onehop.analysis.ros2.bag import write_bag
from onehop.analysis.table_files import write_csv, write_parquet
from onehop.commands.logs import open_with_warning, warn_of_flaws
from onehop.commands.output import emit_json
from onehop.wire.audit import audit


def export(path: Path, to: str, out: Path, as_json: bool) -> int:
    """Write a log as a folder of another kind; returns the exit status."""
    log = open_with_warning(path)
    if to == "ros2":
        counts, flaws = write_bag(log, out)
        what = f"{sum(counts.values())} messages on {len(counts)} topics"
        use = f"ros2 bag info {out}"
    else:
        counts = (write_csv if to == "csv" else write_parquet)(log, out)
        flaws = audit(log.file)  # tables pass over what is missing
        what = f"{sum(counts.values())} rows in {len(counts)} tables"
        use = ""
    if as_json:
        emit_json({"folder": str(out), "counts": counts})
    else:
        print(f"folder  {out}: {what}")
        if use:
            print(f"open    it with {use}, PlotJuggler or Foxglove")
    warn_of_flaws(path, flaws)
    return 1 if flaws else 0
