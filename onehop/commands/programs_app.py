"""The commands of `onehop` for people with a robot program of their own, and their options."""

from pathlib import Path
from typing import Annotated

from typer import Argument

from onehop.commands.app import AsJson, app, leave


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
