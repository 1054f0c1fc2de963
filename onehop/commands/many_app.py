"""The commands of `onehop` that run many missions, and their options."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from onehop.commands import numbers
from onehop.commands.app import AsJson, Settings, app, leave
from onehop.commands.numbers import within


@app.command()
def chaos(
    scenario: Annotated[Path, Argument(help="Scenario file (.toml) whose map and settings are varied.")],
    runs: Annotated[
        int, Option(help="Missions to draw, one a seed.", callback=within(numbers.RUNS))
    ] = 200,
    seed: Annotated[int, Option(help="First seed.", callback=within(numbers.SEED))] = 1,
    jobs: Annotated[
        int | None, Option(help="Worker processes (default: one a core).", callback=within(numbers.JOBS))
    ] = None,
    processes: Annotated[
        float,
        Option(
            metavar="SHARE",
            help="Share of the missions that run as processes, too.",
            callback=within(numbers.SHARE),
        ),
    ] = 0.0,
    twice_every: Annotated[
        int,
        Option(
            "--twice-every",
            help="Run every so many-th mission twice: the same bytes? 0: none.",
            callback=within(numbers.RUNS),
        ),
    ] = 20,
    dask: Annotated[
        str | None, Option(metavar="ADDRESS", help="Use the workers of a dask.distributed scheduler.")
    ] = None,
    out: Annotated[
        Path | None, Option(help="Folder for results; with one that has some, go on from there.")
    ] = None,
    corpus: Annotated[
        Path | None, Option(help="Folder of scenario files that are tried first, as they are.")
    ] = None,
    as_is: Annotated[bool, Option("--as-is", help="Try the scenario itself, and draw nothing.")] = False,
    budget: Annotated[
        bool,
        Option(
            "--budget/--no-budget",
            help="Only faults that the team is to survive, or any: then nothing is asked to happen.",
        ),
    ] = True,
    until_found: Annotated[
        bool, Option("--until-found", help="End with the first mission that breaks something.")
    ] = False,
    shrink_runs: Annotated[
        int,
        Option(
            "--shrink-runs",
            help="Missions to make one failure small, at most; 0: leave them as they are.",
            callback=within(numbers.RUNS),
        ),
    ] = 400,
    settings: Settings = [],  # noqa: B006 - typer needs a list
    as_json: AsJson = False,
) -> None:
    """Look for the mission that breaks a promise: random teams, maps and faults, each log judged.

    A failure is made small and written as a scenario file that repeats it. Exit status 1: something that
    must never happen did; 3: only something that must happen did not; 4: a program failed; 5: the same
    mission left other bytes.

    Example: onehop chaos scenarios/map1.toml --runs 2000 --processes 0.05 --out runs/chaos
    """
    from onehop.commands import chaos as command

    how_many = command.HowMany(runs, seed, jobs, processes, twice_every, until_found, shrink_runs)
    leave(command.chaos(scenario, settings, how_many, dask, out, corpus, as_is, budget, as_json))
