"""The commands of `onehop study` and their options."""

import math
from pathlib import Path
from typing import Annotated

from typer import Argument, Context, Option, Typer

from onehop.commands import numbers
from onehop.commands.app import AsJson, Settings, app, leave
from onehop.commands.many_app import Dask, FirstSeed, Jobs, Out
from onehop.commands.numbers import within
from onehop.contracts.errors import InputError

Seeds = Annotated[int, Option(help="Missions of each cell.", callback=within(numbers.SEEDS))]

Figures = Annotated[
    bool, Option("--figures/--no-figures", help="Draw figures and write the page, or tell tables alone.")
]

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
    figures: Figures = True,
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

    how_many = command.HowMany(seeds, seed, jobs, figures)
    leave(command.thesis(scenarios, settings, how_many, dask, out, as_json))


@study_app.command()
def policies(
    scenario: Annotated[Path, Argument(help="Scenario file (.toml) whose followers are held.")] = THESIS
    / "map1.toml",
    policies: Annotated[
        str, Option(metavar="A,B,...", help="Gain policies; the first is what others are held against.")
    ] = "constant,throughput",
    k_rho_min: Annotated[
        str, Option("--k-rho-min", metavar="A,B,...", help="Gains [1/s].")
    ] = "0.1,0.2,0.3,0.5,1",
    hold: Annotated[
        str, Option(metavar="A,B,...", help="For how long followers are held [s].")
    ] = "5,10,15,20",
    seeds: Seeds = 20,
    seed: FirstSeed = 1,
    jobs: Jobs = None,
    dask: Dask = None,
    out: Out = None,
    figures: Figures = True,
    settings: Settings = [],  # noqa: B006
    as_json: AsJson = False,
) -> None:
    """Where a gain policy matters: k_rho_min by length of a delay, as heat maps with the frontier.

    The page policies.html of --out has it all. Stopped or killed, the same command goes on. Exit status
    1: a mission crashed.

    Example: onehop study policies --seeds 10 --hold 5,10,20 --out runs/policies
    """
    from onehop.commands import study as command
    from onehop.study.phase.grid import Grid

    gains, holds = _numbers("--k-rho-min", k_rho_min), _numbers("--hold", hold)
    grid = Grid(scenario, settings, gains, holds, tuple(policies.split(",")))
    how_many = command.HowMany(seeds, seed, jobs, figures)
    leave(command.policies(grid, how_many, dask, out, as_json))


def _numbers(option: str, text: str) -> tuple[float, ...]:
    """Numbers between commas, each above 0. Raises InputError."""
    try:
        values = tuple(float(piece) for piece in text.split(","))
    except ValueError:
        values = ()
    if not values or not all(0.0 < value < math.inf for value in values):
        raise InputError(f"{option} {text}", "no list of numbers above 0", "e.g. 0.1,0.3")
    return values
