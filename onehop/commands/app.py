"""The commands of `onehop` and their options; those on logs are in log_app.py.

Each command's module is imported when it is called, so that `onehop --help` answers at once.
"""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from typer import Argument, Option

from onehop.commands import numbers
from onehop.commands.numbers import within
from onehop.commands.optional_address import LIVE, OptionalAddress
from onehop.ros2 import DEFAULT_ROUTER

app = typer.Typer(
    name="onehop",
    help="Robot teams held together by radio: run, re-execute and explain missions.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Driver(StrEnum):
    PROCESSES = "processes"
    INLINE = "inline"


class RosDistro(StrEnum):
    HUMBLE = "humble"
    JAZZY = "jazzy"


class Clock(StrEnum):
    LOCKSTEP = "lockstep"
    REALTIME = "realtime"


class Preset(StrEnum):
    THESIS = "thesis"
    PHYSICAL = "physical"
    INDOOR = "indoor"


class Router(StrEnum):
    WORLD = "world"
    EXTERNAL = "external"


class FastFading(StrEnum):
    NONE = "none"
    RAYLEIGH = "rayleigh"
    RICIAN = "rician"


Settings = Annotated[
    list[str],
    Option("--set", metavar="KEY.PATH=VALUE", help="Change a key of the scenario (repeatable)."),
]
AsJson = Annotated[
    bool, Option("--json", help="Print one JSON object on stdout and nothing else there.")
]

Browser = Annotated[
    bool, Option("--browser/--no-browser", help="Open the page, if there is a screen to open it on.")
]


def leave(status: int) -> NoReturn:
    raise typer.Exit(status)


@app.callback(invoke_without_command=True)
def _help(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        print(context.get_help())
        leave(2)


@app.command(cls=OptionalAddress)
def run(
    scenario: Annotated[Path, Argument(help="Scenario file (.toml).")],
    driver: Annotated[Driver, Option(help="One process each, or all in one.")] = Driver.PROCESSES,
    clock: Annotated[
        Clock | None, Option(help="Everyone waits for everyone in a tick, or nobody for anybody.")
    ] = None,
    speed: Annotated[
        float | None,
        Option(help="Simulated seconds a second: real time.", callback=within(numbers.SPEED)),
    ] = None,
    seed: Annotated[
        int | None, Option(help="Seed of everything random.", callback=within(numbers.SEED))
    ] = None,
    map_file: Annotated[
        Path | None, Option("--map", help="Another map: .toml, ROS .yaml or MovingAI .map.")
    ] = None,
    start: Annotated[str | None, Option(metavar="X,Y", help="Where the team starts [m].")] = None,
    goal: Annotated[str | None, Option(metavar="X,Y", help="Where the team goes [m].")] = None,
    settings: Settings = [],  # noqa: B006 - typer needs a list
    program: Annotated[
        str | None,
        Option(metavar="MODULE:CLASS", help="Program of all robots without one of their own."),
    ] = None,
    out: Annotated[Path | None, Option(help="Folder for log, summary and figure.")] = None,
    bus: Annotated[
        str | None, Option(metavar="tls/HOST:PORT", help="Where the world listens for other hosts.")
    ] = None,
    keys: Annotated[Path | None, Option(metavar="DIR", help="Certificates, of onehop keys.")] = None,
    remote: Annotated[
        str, Option(metavar="3,4[,radio]", help="Who is started on other hosts, and waited for.")
    ] = "",
    mission: Annotated[str, Option(help="Prefix of its keys on a bus that others reach.")] = "onehop",
    wait_s: Annotated[
        float, Option("--wait", help="How long for other hosts [s].", callback=within(numbers.WAIT))
    ] = 300.0,
    router: Annotated[
        Router, Option(help="Of --bus: the world, or one that runs there (zenohd).")
    ] = Router.WORLD,
    record: Annotated[bool, Option("--record/--no-record", help="Write the log.")] = True,
    with_view: Annotated[
        bool, Option("--view/--no-view", help="Add to the log what Foxglove and Rerun show.")
    ] = True,
    with_figure: Annotated[
        bool, Option("--figure/--no-figure", help="Draw the mission, in trajectory.png.")
    ] = True,
    as_json: AsJson = False,
    live: Annotated[
        str | None,
        Option(
            LIVE,
            metavar="[HOST:PORT]",
            help="Watch it, and lay hands on it, in a browser (docs/live.md).",
        ),
    ] = None,
    browser: Browser = True,
    ros2: Annotated[
        bool, Option("--ros2", help="Let ROS 2 nodes see it, by rmw_zenoh (docs/ros.md).")
    ] = False,
    ros_router: Annotated[
        str, Option(metavar="ENDPOINT", help="Router of the ROS 2 nodes.")
    ] = DEFAULT_ROUTER,
    ros_domain: Annotated[
        int, Option(envvar="ROS_DOMAIN_ID", help="Their domain.", callback=within(numbers.ROS_DOMAIN))
    ] = 0,
    ros_distro: Annotated[RosDistro, Option(help="Theirs; later ones are as jazzy.")] = RosDistro.JAZZY,
) -> None:
    """Run a mission: every robot a process on the bus, recorded.

    Ctrl-C, SIGTERM and SIGHUP end it in order, with its log and summary: exit status 130, 143, 129.

    Example: onehop run scenarios/map1.toml --seed 7 --set team.size=4
    """
    from onehop.commands import run as command
    from onehop.commands.ros2 import Ros2

    settings = [*settings, *command.clock_settings(None if clock is None else clock.value, speed)]
    places = (map_file, start, goal, out)
    wanted = (record, record and with_view, record and with_figure, as_json)
    hosts = command.Hosts(bus, keys, remote, mission, wait_s, router.value)
    nodes = Ros2(ros_router, ros_domain, ros_distro.value) if ros2 else None
    given = command.run(
        scenario, driver.value, settings, seed, *places, *wanted, program, hosts,
        live=live, browser=browser, ros2=nodes,
    )  # fmt: skip
    leave(given)


@app.command()
def fault(
    kind: Annotated[
        str,
        Argument(
            help="kill, stop, continue, restart, hold, kidnap, blind, slow, cut, corrupt, jam or heal."
        ),
    ],
    robots: Annotated[str, Argument(help="Which robots, e.g. 3 or 1,4.")] = "",
    duration_s: Annotated[
        float | None, Option("--for", help="How long [s, simulated]; by default until healed.")
    ] = None,
    mission: Annotated[
        Path | None, Option(help="Output folder of the mission (default: the one that runs).")
    ] = None,
    others: Annotated[str, Option(help="Cut from these robots (default: from all the rest).")] = "",
    direction: Annotated[str | None, Option(help="Of a cut: both, from or to.")] = None,
    x: Annotated[float | None, Option(help="Where: kidnap, jam [m].")] = None,
    y: Annotated[float | None, Option(help="Where: kidnap, jam [m].")] = None,
    heading_deg: Annotated[
        float | None, Option("--heading", help="Of a kidnapped robot [degrees].")
    ] = None,
    radius: Annotated[float | None, Option(help="Of a jammed disc [m].")] = None,
    noise_dbm: Annotated[float | None, Option("--noise", help="Of a jam, at receivers [dBm].")] = None,
    probability: Annotated[float | None, Option(help="Share of payloads corrupted.")] = None,
    delay_ticks: Annotated[
        int | None, Option("--delay", help="How late a slow robot acts [ticks].")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Do something bad to a mission that runs: it takes effect with the next tick, and is in its log.

    Example: onehop fault kill 3
    """
    from onehop.commands import fault as command

    given = {
        "duration_s": duration_s,
        "direction": direction,
        "x": x,
        "y": y,
        "heading_deg": heading_deg,
        "radius": radius,
        "noise_dbm": noise_dbm,
        "probability": probability,
        "delay_ticks": delay_ticks,
    }
    leave(command.fault(kind, robots, others, mission, given, as_json))


@app.command()
def elect(
    ids: Annotated[str, Argument(help="Robot ids, e.g. 1,2,4,5.")],
    narrow: Annotated[bool, Option("--narrow", help="In a narrow passage.")] = False,
    spacing: Annotated[
        float, Option(help="Distance between neighbours [m].", callback=within(numbers.SPACING))
    ] = 4.0,
    as_json: AsJson = False,
) -> None:
    """Leader, shape and slots of a team.

    Example: onehop elect 1,2,4,5
    """
    from onehop.commands import elect as command

    leave(command.elect(ids, narrow, spacing, as_json))


@app.command()
def link(
    distance: Annotated[
        str, Option(metavar="A,B,C", help="Distances [m].")
    ] = "1,5,8,10,12,15,20,25,30,40",
    preset: Annotated[Preset, Option(help="Propagation.")] = Preset.THESIS,
    fast_fading: Annotated[FastFading, Option(help="Of many paths, place by place.")] = FastFading.NONE,
    rate: Annotated[float, Option(help="1, 2, 5.5 or 11 Mb/s.")] = 1.0,
    msdu: Annotated[int, Option(help="Payload of a frame [B].", callback=within(numbers.MSDU))] = 800,
    seed: Annotated[int, Option(help="Seed of fading and backoff.", callback=within(numbers.SEED))] = 1,
    seconds: Annotated[
        float,
        Option(help="Simulated time measured at each distance.", callback=within(numbers.MEASURED)),
    ] = 20.0,
    as_json: AsJson = False,
) -> None:
    """Link budget over distance: SNR, error rates, throughput, and how much places differ.

    Example: onehop link --distance 5,10,20 --preset indoor
    """
    from onehop.commands import link as command

    leave(command.link(distance, preset.value, fast_fading.value, rate, msdu, seed, seconds, as_json))


@app.command()
def saturate(
    stations: Annotated[
        int, Option(help="Stations that always have a message.", callback=within(numbers.STATIONS))
    ] = 6,
    rts: Annotated[bool, Option("--rts/--basic", help="With or without RTS/CTS.")] = True,
    rate: Annotated[float, Option(help="1, 2, 5.5 or 11 Mb/s.")] = 1.0,
    msdu: Annotated[int, Option(help="Payload of a frame [B].", callback=within(numbers.MSDU))] = 800,
    seed: Annotated[int, Option(help="Seed of the backoff.", callback=within(numbers.SEED))] = 1,
    seconds: Annotated[float, Option(help="Simulated time.", callback=within(numbers.MEASURED))] = 20.0,
    as_json: AsJson = False,
) -> None:
    """Throughput of saturated stations in one cell, beside Bianchi's formula.

    Example: onehop saturate --stations 10 --basic
    """
    from onehop.commands import link as command

    leave(command.saturate(stations, rts, rate, msdu, seed, seconds, as_json))


@app.command()
def plan(
    map_file: Annotated[Path, Argument(metavar="MAP", help=".toml, ROS .yaml or MovingAI .map.")],
    start: Annotated[str | None, Option(metavar="X,Y", help="Where it starts [m].")] = None,
    goal: Annotated[str | None, Option(metavar="X,Y", help="Where it goes [m].")] = None,
    planner: Annotated[
        str | None, Option(help="How it finds its way: a name as of planner.kind (onehop plugins).")
    ] = None,
    seed: Annotated[
        int | None, Option(help="Seed of its samples.", callback=within(numbers.SEED))
    ] = None,
    cell: Annotated[
        float | None, Option(help="Metres a cell of a MovingAI grid.", callback=within(numbers.CELL))
    ] = None,
    settings: Settings = [],  # noqa: B006
    figure: Annotated[
        Path | None, Option(help="Draw map, samples, road maps and path (.png, .svg or .pdf).")
    ] = None,
    path: Annotated[
        Path | None, Option(help="Write the way as planner.path of a scenario (.toml).")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """One leader alone finds its way in a map that it does not know.

    Example: onehop plan scenarios/map1.toml --planner escape --figure plan.png
    """
    from onehop.commands import plan as command

    leave(command.plan(map_file, start, goal, planner, seed, cell, settings, figure, path, as_json))


@app.command()
def doctor(as_json: AsJson = False) -> None:
    """Is everything here that a run needs? What is missing, and how to get it.

    Example: onehop doctor
    """
    from onehop.commands import doctor as command

    leave(command.doctor(as_json))
