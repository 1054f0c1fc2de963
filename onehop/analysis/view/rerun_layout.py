"""A layout for Rerun: the team from above, its links over time, and what it reports."""

from importlib.util import find_spec
from pathlib import Path
from typing import Any

from onehop.analysis.log import Log
from onehop.analysis.palette import rgb, robot_colours
from onehop.contracts.topics import robot_name
from onehop.maps.map_file import load_map

EYE_HEIGHT = 1.15
"""Height from which the map is seen, as a share of its longer side; straight down, y upwards."""

PLOTS = (
    ("throughput [bit/s]", "throughput_bps"),
    ("SNR [dB]", "snr_db"),
    ("error to slot [m]", "error_m"),
)
"""Title and field of onehop.Link."""


def write_layout(log: Log, recording: Path) -> Path | None:
    """Write recording.rbl beside a recording; None when rerun-sdk is not installed.

    Rerun applies a layout only to the application of the same id, and takes the stem of an MCAP file
    for that id.
    """
    if find_spec("rerun") is None:
        return None
    path = recording.with_suffix(".rbl")
    _blueprint(log).save(recording.stem, path)
    return path


def _blueprint(log: Log) -> Any:
    import rerun.blueprint as rrb

    xmin, ymin, xmax, ymax = load_map(log.scenario.map, log.bundle.files).bounds
    middle = ((xmin + xmax) / 2, (ymin + ymax) / 2)
    eye = rrb.EyeControls3D(
        position=(*middle, EYE_HEIGHT * max(xmax - xmin, ymax - ymin)), look_target=(*middle, 0.0),
        eye_up=(0.0, 1.0, 0.0),
    )  # fmt: skip
    team = rrb.Spatial3DView(
        name="the team", origin="/", background=[255, 255, 255], eye_controls=eye, line_grid=False
    )
    events = rrb.TextLogView(name="events", origin="/events")
    plots = [_plot(log, title, field) for title, field in PLOTS]
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(team, events, row_shares=[3, 1]),
            rrb.Vertical(*plots),
            column_shares=[3, 2],
        ),
        collapse_panels=True,
    )


def _plot(log: Log, title: str, field: str) -> Any:
    """One field of every robot's link; our own message has to be mapped to a line."""
    import rerun as rr
    import rerun.blueprint as rrb

    overrides: dict[Any, Any] = {}
    for robot, colour in robot_colours(log.robots).items():
        mapping = rrb.encodings.VisualizerComponentMapping(
            target="Scalars:scalars", source_kind=rrb.encodings.ComponentSourceKind.SourceComponent,
            source_component="onehop.Link:message", selector=f".{field}",
        )  # fmt: skip
        line = rr.SeriesLines(colors=[round(255 * part) for part in rgb(colour)], names=[f"{robot}"])
        overrides[f"/{robot_name(robot)}/link"] = line.visualizer(mappings=[mapping])
    return rrb.TimeSeriesView(name=title, origin="/", contents=list(overrides), overrides=overrides)
