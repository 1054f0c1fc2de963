"""The commands of `onehop` for people with a robot program of their own, and their options."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from onehop.commands import numbers
from onehop.commands.app import AsJson, Settings, app, leave
from onehop.commands.numbers import within


@app.command()
def new(
    folder: Annotated[Path, Argument(metavar="DIR", help="Folder that is not there yet, or empty.")],
    as_json: AsJson = False,
) -> None:
    """A small project with a robot program of your own: scenario, program, test.

    Example: onehop new my_robots
    """
    from onehop.commands import new as command

    leave(command.new(folder, as_json))


@app.command()
def verify(
    program: Annotated[str, Argument(help="package.module:Class, or a name of onehop plugins.")],
    missions: Annotated[
        int, Option(help="Small random missions to try it in.", callback=within(numbers.RUNS))
    ] = 3,
    seed: Annotated[int, Option(help="Seed of the first one.", callback=within(numbers.SEED))] = 1,
    settings: Settings = [],  # noqa: B006
    as_json: AsJson = False,
) -> None:
    """Is a program deterministic, and is it fast enough?

    Runs it twice in one process and once as processes, and executes its log again. Exit status 1 if
    anything differs, if it fails, or if its step takes longer than a tick (99th percentile).

    Example: onehop verify seeker:Seeker --set team.parameters.speed=2
    """
    from onehop.commands import verify as command

    leave(command.verify(program, missions, seed, settings, as_json))


@app.command()
def plugins(as_json: AsJson = False) -> None:
    """The robot programs that installed packages offer by name.

    Example: onehop plugins
    """
    from onehop.commands import plugins as command

    leave(command.plugins(as_json))
