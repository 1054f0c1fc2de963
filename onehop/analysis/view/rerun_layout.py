"""A layout for Rerun: the team from above, its links over time, and what it reports."""

from pathlib import Path
from typing import Any

from onehop.analysis.log import Log
from onehop.contracts.topics import robot_name


def write_layout(log: Log, recording: Path) -> Path | None:
    """Write recording.rbl beside a recording; None when rerun-sdk is not installed.

    Rerun applies a layout only to the application of the same id, and takes the stem of an MCAP file
    for that id.
    """
    try:
        import rerun.blueprint as rrb
    except ImportError:
        return None
    path = recording.with_suffix(".rbl")
    _blueprint(rrb, log).save(recording.stem, path)
    return path


def _blueprint(rrb: Any, log: Log) -> Any:
    names = [robot_name(robot) for robot in log.robots]
    plots = [
        rrb.TimeSeriesView(
            name=title, origin="/", contents=[f"/{name}/link/**:{field}" for name in names]
        )
        for title, field in (("throughput", "throughput_bps"), ("SNR", "snr_db"))
    ]
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Spatial3DView(name="the team", origin="/"),
                rrb.TextLogView(name="events", origin="/events"),
                row_shares=[3, 1],
            ),
            rrb.Vertical(*plots),
            column_shares=[3, 2],
        ),
        collapse_panels=True,
    )
