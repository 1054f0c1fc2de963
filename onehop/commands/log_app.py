"""The commands of `onehop` that read a mission's log, and their options."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from onehop.commands import numbers
from onehop.commands.app import AsJson, Browser, Settings, app, leave
from onehop.commands.numbers import within


class Format(StrEnum):
    ROS2 = "ros2"
    CSV = "csv"
    PARQUET = "parquet"


class Film(StrEnum):
    GIF = "gif"
    MP4 = "mp4"


@app.command()
def replay(
    log: Annotated[Path, Argument(help="A mission's log (.mcap).")],
    robot: Annotated[int | None, Option(help="Only this robot.", callback=within(numbers.ROBOT))] = None,
    first_s: Annotated[
        float | None,
        Option("--from", help="Compare from this time on [s].", callback=within(numbers.MISSION_TIME)),
    ] = None,
    last_s: Annotated[
        float | None,
        Option("--to", help="Stop at this time [s].", callback=within(numbers.MISSION_TIME)),
    ] = None,
    settings: Settings = [],  # noqa: B006
    as_json: AsJson = False,
) -> None:
    """Re-execute a log and compare every output with the recorded one.

    Exit status 1 too when nothing was compared, or not all that was said in the mission.
    With --robot and --set: where that robot would first have acted otherwise.

    Example: onehop replay runs/demo/mission.mcap --robot 3
    """
    from onehop.commands import replay as command

    leave(command.replay(log, robot, first_s, last_s, settings, as_json))


@app.command()
def check(
    log: Annotated[Path, Argument(help="A mission's log (.mcap).")],
    only: Annotated[
        list[str],
        Option("--only", metavar="ID", help="Only this invariant (repeatable): docs/checking.md."),
    ] = [],  # noqa: B006
    as_json: AsJson = False,
) -> None:
    """Test from the log alone that every promise held: leaders, epochs, radio, faults, contacts.

    Exit status 1 when an invariant is broken.

    Example: onehop check runs/demo/mission.mcap
    """
    from onehop.commands import check as command

    leave(command.check(log, only, as_json))


@app.command()
def report(
    log: Annotated[Path, Argument(help="A mission's log (.mcap).")],
    out: Annotated[
        Path | None, Option(help="Folder for page and figures (default: beside the log).")
    ] = None,
    film: Annotated[Film | None, Option(help="Make a film of the mission, too.")] = None,
    as_json: AsJson = False,
) -> None:
    """Show a mission on one self-contained page, with every figure as PNG and SVG.

    Example: onehop report runs/demo/mission.mcap --film gif
    """
    from onehop.commands import report as command

    leave(command.report(log, out, film.value if film else None, as_json))


@app.command()
def explain(
    log: Annotated[Path, Argument(help="A mission's log (.mcap).")],
    robot: Annotated[int, Option(help="Which robot.", callback=within(numbers.ROBOT))],
    at_s: Annotated[
        float,
        Option("--at", help="At which simulated time [s].", callback=within(numbers.MISSION_TIME)),
    ],
    window_s: Annotated[
        float,
        Option(
            "--window",
            help="Tell messages of this long before it [s].",
            callback=within(numbers.MISSION_TIME),
        ),
    ] = 6.0,
    as_json: AsJson = False,
) -> None:
    """Why a robot did what it did: its mode, what it heard and missed, its k_rho, its error.

    Example: onehop explain runs/demo/mission.mcap --robot 5 --at 63.5
    """
    from onehop.commands import explain as command

    leave(command.explain(log, robot, at_s, window_s, as_json))


@app.command()
def live(
    logs: Annotated[list[Path], Argument(metavar="LOG [LOG]", help="A log, or two side by side.")],
    address: Annotated[
        str, Option("--at", metavar="HOST:PORT", help="Where to serve it (default: a free port here).")
    ] = "",
    browser: Browser = True,
) -> None:
    """The live page on a log: play it, jump from event to event, ask why. Ctrl-C ends it.

    Example: onehop live runs/demo/mission.mcap
    """
    from onehop.commands import live as command

    leave(command.live(logs, address, browser))


@app.command()
def diff(
    a: Annotated[Path, Argument(help="One log.")],
    b: Annotated[Path, Argument(help="Another log.")],
    as_json: AsJson = False,
) -> None:
    """The first difference of two logs: tick, topic, field, both values.

    Example: onehop diff runs/a/mission.mcap runs/b/mission.mcap
    """
    from onehop.commands import diff as command

    leave(command.diff(a, b, as_json))


@app.command()
def salvage(
    torn: Annotated[Path, Argument(help="A log whose recorder was killed, or that is damaged.")],
    out: Annotated[Path, Option("-o", "--out", metavar="LOG", help="The sound log to write.")],
    as_json: AsJson = False,
) -> None:
    """Make a sound log of a torn or damaged one: every whole tick, and what was lost.

    Example: onehop salvage runs/demo/mission.mcap -o saved.mcap
    """
    from onehop.commands import salvage as command

    leave(command.salvage(torn, out, as_json))


@app.command()
def view(
    log: Annotated[Path, Argument(help="A mission's log (.mcap).")],
    out: Annotated[
        Path | None, Option("-o", "--out", metavar="LOG", help="Write here, not into the log itself.")
    ] = None,
    open_viewer: Annotated[bool, Option("--open", help="Start Rerun on it, if installed.")] = False,
    as_json: AsJson = False,
) -> None:
    """Add what Foxglove and Rerun can show: poses, scans, map, links, events.

    Example: onehop view runs/demo/mission.mcap --open
    """
    from onehop.commands import view as command

    leave(command.view(log, out, open_viewer, as_json))


@app.command()
def export(
    log: Annotated[Path, Argument(help="A mission's log (.mcap).")],
    to: Annotated[Format, Option(help="A rosbag2 folder, or the tables of the log as files.")],
    out: Annotated[Path, Option("-o", "--out", help="The new folder.")],
    as_json: AsJson = False,
) -> None:
    """Write a log for other tools: `ros2 bag`, rviz2, PlotJuggler, Foxglove; spreadsheets, data frames.

    No ROS is needed for it (pip install 'onehop[ros2]').

    Example: onehop export runs/demo/mission.mcap --to ros2 -o runs/demo/bag
    """
    from onehop.commands import export as command

    leave(command.export(log, to.value, out, as_json))
