"""The process of the world: it holds map, clock and bus, and runs the mission from start to farewell."""

import argparse
import signal
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from onehop.contracts import topics
from onehop.contracts.arrays import FloatArray
from onehop.contracts.operation import End
from onehop.maps.map_file import load_map
from onehop.node import startup
from onehop.node.bus import Bus
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.wire.codec import encode
from world_server.briefings import Briefings
from world_server.clocks import Parts, lock_step, real_time
from world_server.core.world import World
from world_server.mailbox import Mailbox, MissionBrokenError
from world_server.roll_call import ACCOUNT_S, RollCall

START_S = 60.0
"""How long the start of all processes may take [s], if nothing else is said."""

RECORDER_AWAY_S = 10.0
"""How long the recorder may be cut off in real time [s]: the world keeps what it is to write."""

FAREWELL_S = 30.0
"""How long the world stays, as the router of the bus, for those who have yet to finish [s]."""


def main() -> int:
    options = _options()
    startup.start(options)
    bundle = scenario_file.load(
        options.scenario,
        options.set,
        options.seed,
        options.map,
        scenario_file.point(options.start, "--start"),
        scenario_file.point(options.goal, "--goal"),
    )
    walls = load_map(bundle.scenario.map, bundle.files)
    with scenario_file.in_file(options.scenario):
        world = World(bundle.scenario, walls)
    if not world.bases:  # nobody knows yet where these are
        world.observe()  # compiles or loads the laser kernel before anyone waits for it
    with startup.host(options, topics.clients(bundle.scenario.team.robots, world.bases)) as bus:
        _host(bus, bundle, world, walls.segments, options.driver, options.start_s)
    return 0


def _options() -> argparse.Namespace:
    parser = startup.arguments("world_server", "Map, motion and clock of a mission; its bus router.")
    parser.add_argument("scenario", type=Path, help="scenario file (.toml)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change a key")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--map", type=Path)
    parser.add_argument("--start", metavar="X,Y")
    parser.add_argument("--goal", metavar="X,Y")
    router = parser.add_mutually_exclusive_group(required=True)
    router.add_argument("--listen", metavar="ENDPOINT", help="be the router, e.g. at tcp/127.0.0.1:7447")
    router.add_argument("--connect", metavar="ENDPOINT", help="be the client of one, e.g. tls/base:7447")
    startup.add_keys(parser)
    parser.add_argument(
        "--start-s", type=float, default=START_S, metavar="S", help="how long to wait for the others [s]"
    )
    parser.add_argument("--driver", default="processes", help="what the log calls this way of running")
    return parser.parse_args()


def _host(
    bus: Bus, bundle: Bundle, world: World, walls: FloatArray, driver: str, start_s: float
) -> None:
    """Run the mission from the first process's arrival to the last one's farewell."""
    robots, clock = bundle.scenario.team.robots, bundle.scenario.clock
    mail = Mailbox(bus)
    roll = RollCall(
        mail,
        robots,
        recorder_away_s=RECORDER_AWAY_S if clock.is_realtime else ACCOUNT_S,
        bases=world.bases,
        radio_may_be_away=clock.is_realtime,
        router_may_go=clock.is_realtime and not bus.is_router,
    )
    briefings = Briefings(bundle, walls, driver, roll.incarnation)
    open_briefings = partial(bus.answering, topics.config("*"), briefings.answer)
    make = real_time if clock.is_realtime else lock_step
    mission = make(Parts(bus, mail, roll, world, bundle.scenario, open_briefings))
    recording = mission.recording
    tell_the_end = _farewell(bus, roll)
    _heed_stops(bus, mail)
    mail.read(topics.RECORDER, topics.FAILED, lambda why: mail.break_off(why.decode(errors="replace")))
    bus.watch("*")
    bus.announce(topics.WORLD)
    started = time.monotonic()
    try:
        with open_briefings():
            roll.gather(roll.everyone, start_s)
        startup.calm_garbage_collector()
        started = time.monotonic()
        outcome = mission.run()
    except MissionBrokenError as broken:
        outcome = mission.broken_off(broken.reason)
    wall_s = time.monotonic() - started
    recording.hand_over()
    mail.close_mission()
    roll.wait_for_nobody()
    tell_the_end(End(outcome, recording.last_tick, wall_s, mission.punctuality))
    mail.wait(lambda: roll.present.isdisjoint(roll.everyone), FAREWELL_S)


def _heed_stops(bus: Bus, mail: Mailbox) -> None:
    """Let the operator end the mission, and SIGTERM too: this process tells itself then."""
    for name in (topics.OPERATOR, topics.WORLD):
        mail.read(name, topics.CONTROL, lambda _: mail.break_off("stopped by the operator"))
    signal.signal(signal.SIGTERM, lambda *_: bus.tell_self(topics.CONTROL))


def _farewell(bus: Bus, roll: RollCall) -> Callable[[End], None]:
    """What tells recorder and operator how the mission ended, and everyone that it has.

    It is made at the start: a router's client has to learn of those who hear it before it says anything.
    """
    names = (topics.OPERATOR, *roll.everyone)
    puts = {name: bus.publisher(topics.to(name, topics.END)) for name in names}

    def tell(end: End) -> None:
        for name in (topics.RECORDER, topics.OPERATOR):
            puts[name](encode(end))
        for name in roll.everyone:
            if name != topics.RECORDER:
                puts[name](b"")

    return tell
