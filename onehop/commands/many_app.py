"""The commands of `onehop` that run many missions, and their options."""

from pathlib import Path
from typing import Annotated, Literal

from typer import Argument, Option

from onehop.commands import numbers
from onehop.commands.app import AsJson, Settings, app, leave
from onehop.commands.numbers import within

Jobs = Annotated[
    int | None, Option(help="Worker processes (default: one a core).", callback=within(numbers.JOBS))
]
Dask = Annotated[
    str | None, Option(metavar="ADDRESS", help="Use the workers of a dask.distributed scheduler.")
]
Out = Annotated[
    Path | None, Option(help="Folder for results; with one that has some, go on from there.")
]
FirstSeed = Annotated[int, Option(help="First seed.", callback=within(numbers.SEED))]
ShareAsProcesses = Annotated[
    float,
    Option(
        metavar="SHARE",
        help="Share of the missions that run as processes, too.",
        callback=within(numbers.SHARE),
    ),
]


@app.command()
def chaos(
    scenario: Annotated[Path, Argument(help="Scenario file (.toml) whose map and settings are varied.")],
    runs: Annotated[
        int, Option(help="Missions to draw, one a seed.", callback=within(numbers.RUNS))
    ] = 200,
    seed: FirstSeed = 1,
    jobs: Jobs = None,
    processes: ShareAsProcesses = 0.0,
    twice_every: Annotated[
        int,
        Option(
            "--twice-every",
            help="Run every so many-th mission twice: the same bytes? 0: none.",
            callback=within(numbers.RUNS),
        ),
    ] = 20,
    dask: Dask = None,
    out: Out = None,
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


@app.command()
def sweep(
    scenario: Annotated[Path, Argument(help="Scenario file (.toml) whose keys are varied.")],
    over: Annotated[
        list[str],
        Option(metavar="KEY.PATH=A,B,C", help="Values of a key, as TOML (repeatable)."),
    ] = [],  # noqa: B006 - typer needs a list
    seeds: Annotated[
        int, Option(help="Missions of each combination.", callback=within(numbers.SEEDS))
    ] = 20,
    seed: FirstSeed = 1,
    jobs: Jobs = None,
    processes: ShareAsProcesses = 0.0,
    dask: Dask = None,
    out: Out = None,
    keep: Annotated[
        Literal["none", "failures", "all"],
        Option(help="Which logs are kept. failures: not arrived, or without some of the team."),
    ] = "none",
    settings: Settings = [],  # noqa: B006
    as_json: AsJson = False,
) -> None:
    """Run every combination of some keys, each with the same seeds: means, intervals, differences.

    A row for each mission is in missions.parquet of --out. Stopped or killed, the same command goes on.
    Exit status 1: a mission crashed, or as processes left other bytes.

    Example: onehop sweep scenarios/map1.toml --over gains.k_rho_min=0.1,1 --seeds 20 --out runs/gains
    """
    from onehop.commands import sweep as command

    how_many = command.HowMany(seeds, seed, jobs, processes)
    leave(command.sweep(scenario, settings, over, how_many, dask, out, keep, as_json))
