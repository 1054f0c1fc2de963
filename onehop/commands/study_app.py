"""The commands of `onehop study` and their options."""

from pathlib import Path
from typing import Annotated

from typer import Context, Option, Typer

from onehop.commands import numbers
from onehop.commands.app import AsJson, Settings, app, leave
from onehop.commands.many_app import Dask, FirstSeed, Jobs, Out
from onehop.commands.numbers import within

Seeds = Annotated[int, Option(help="Missions of each cell.", callback=within(numbers.SEEDS))]

THESIS = Path("scenarios") / "thesis"

study_app = Typer(
    help="Questions to many missions: tables with intervals, figures, one page.",
    rich_markup_mode=None,
)
app.add_typer(study_app, name="study")


@study_app.callback(invoke_without_command=True)
def _help(context: Context) -> None:
    if context.invoked_subcommand is None:
        print(context.get_help())
        leave(2)


@study_app.command()
def thesis(
    seeds: Seeds = 20,
    seed: FirstSeed = 1,
    scenarios: Annotated[
        Path, Option(metavar="DIR", help="Folder with map1.toml to map3.toml and what fails.")
    ] = THESIS,
    jobs: Jobs = None,
    dask: Dask = None,
    out: Out = None,
    settings: Settings = [],  # noqa: B006 - typer needs a list
    as_json: AsJson = False,
) -> None:
    """Chapter 4 of the thesis again: each claim confirmed, refuted or undecided, by an interval.

    Three maps, two routings, constant and variable k_rho, a delay of the followers; way-finding (4.1)
    and failing robots (4.3). The page thesis.html of --out has it all. Stopped or killed, the same
    command goes on. Exit status 1: a mission crashed.

    Example: onehop study thesis --seeds 20 --out runs/thesis
    """
    from onehop.commands import study as command

    how_many = command.HowMany(seeds, seed, jobs)
    leave(command.thesis(scenarios, settings, how_many, dask, out, as_json))
