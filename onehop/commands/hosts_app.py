"""The commands of `onehop` for missions on several hosts and in containers, and their options."""

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from onehop.commands import numbers
from onehop.commands.app import AsJson, app, leave
from onehop.commands.numbers import within
from onehop.node.startup import DEFAULT_MISSION


@app.command()
def keys(
    folder: Annotated[Path, Argument(metavar="DIR", help="Folder of the authority and certificates.")],
    robots: Annotated[
        int | None, Option(help="For robots 1 to N.", metavar="N", callback=within(numbers.ROBOTS))
    ] = None,
    scenario: Annotated[Path | None, Option(help="For the robots of this scenario (.toml).")] = None,
    host: Annotated[
        list[str], Option(metavar="NAME_OR_IP", help="Where the world can be reached (repeatable).")
    ] = [],  # noqa: B006 - typer needs a list
    days: Annotated[
        int, Option(help="How long certificates are good.", callback=within(numbers.DAYS))
    ] = 365,
    mission: Annotated[str, Option(help="Prefix of the mission's keys on the bus.")] = DEFAULT_MISSION,
    missing: Annotated[
        bool, Option("--missing", help="Add what is not there or has expired; keep the rest.")
    ] = False,
    reissue: Annotated[
        list[str], Option(metavar="NAME", help="Make this one anew, e.g. robot-3 (repeatable).")
    ] = [],  # noqa: B006
    as_json: AsJson = False,
) -> None:
    """An authority of your own, with a certificate for every process: missions on several hosts.

    Example: onehop keys keys --scenario scenarios/map1.toml --host 10.0.0.1
    """
    from onehop.commands import keys as command

    leave(command.keys(folder, robots, scenario, host, days, mission, missing, reissue, as_json))


@app.command()
def compose(
    scenario: Annotated[Path, Argument(help="Scenario file (.toml).")],
    out: Annotated[
        Path | None, Option("-o", "--out", metavar="FILE", help="Where to write it (default: print it).")
    ] = None,
) -> None:
    """The compose file of a mission: a container for each process, certificates made at the first start.

    Example: onehop compose scenarios/map1.toml -o compose.yaml
    """
    from onehop.commands import compose as command

    leave(command.compose(scenario, out))
