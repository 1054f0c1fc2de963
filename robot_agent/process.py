"""The shell of one robot: hear its observation and inbox of a tick, step its program, put the action.

In lock-step both come as one message, the percept of a tick; in real time each by itself, when it is
there (latest_data.py). A robot knows by what it is sent in which of them it takes part. Which program
that is says its briefing. One that fails says so to the world, and on stderr in full.
"""

import os
import signal
import sys

from onehop.contracts import topics
from onehop.contracts.briefings import Briefing
from onehop.contracts.messages import Inbox, Observation, percept
from onehop.node import startup
from onehop.node.bus import ALIVE, GONE, Bus
from onehop.programs.find import search_in
from onehop.programs.host import Host, ProgramError
from onehop.wire.batch import unpack_tick
from onehop.wire.codec import decode
from robot_agent.latest_data import LatestData
from robot_agent.watchdog import Watchdog


def main() -> int:
    parser = startup.arguments("robot_agent", "One robot of a mission.")
    startup.add_connect(parser)
    parser.add_argument("--id", type=int, required=True, help="id of the robot, from 1")
    parser.add_argument("--programs", default="", metavar="DIR", help="where to look for its program")
    options = parser.parse_args()
    startup.start(options)
    name = topics.robot_name(options.id)
    with startup.connect(options, name) as bus:
        bus.watch(topics.WORLD)
        arrival = bus.publisher(topics.by(name, topics.ARRIVAL))
        search_in(options.programs)
        while True:
            briefing = decode(Briefing, startup.briefing(bus, name, lambda: arrival(b"")))
            host = Host(briefing)
            startup.calm_garbage_collector()
            status = _serve(bus, host, name, briefing.silence_s)
            if status is not None:
                return status
            bus.withdraw()


WAKE_S = 1.0
"""How long a robot that was cut off, and has found the world, waits to hear that it is still in the
mission [s]: all have lost the bus, with its router. Else it joins again, as one that knows nothing."""


def _serve(bus: Bus, host: Host, name: str, silence_s: float) -> int | None:
    """Take part; the exit status, or None if this robot was cut off and may join again."""
    put = bus.publisher(topics.by(name, topics.OUT))
    put_awake = bus.publisher(topics.by(name, topics.AWAKE))
    put_failure = bus.publisher(topics.by(name, topics.FAILED))

    def fail(failure: ProgramError) -> int:
        print(failure.account, file=sys.stderr, flush=True)
        put_failure(failure.reason.encode())
        return startup.PROGRAM_FAILED

    watchdog = Watchdog(silence_s, lambda failure: os._exit(fail(failure)))
    latest = LatestData(host, bus.publisher(topics.by(name, topics.ACTED)))
    bus.announce(name)
    is_excused = True  # for having been away: it starts, or was told that it would be stopped
    while True:
        received = bus.poll() if latest.can_step else bus.receive()
        if received is None:
            try:
                with watchdog.watching():
                    latest.step()
            except ProgramError as failure:
                return fail(failure)
            is_excused = False
            continue
        what, data = received
        if what == topics.PERCEPT:
            _, ((_, seen), (_, heard)) = unpack_tick(data)
            now = percept(decode(Observation, seen), decode(Inbox, heard))
            try:
                with watchdog.watching():
                    put(host.step(now))
            except ProgramError as failure:
                return fail(failure)
            is_excused = False
        elif what == topics.OBSERVATION:
            if not latest.is_used:
                startup.be_on_time(is_ours=False)
            latest.on_observation(data)
        elif what == topics.HEARD:
            latest.on_heard(data)
        elif what in (topics.STOP, topics.WAKE):
            is_excused = True
            put_awake(b"")
        elif what == topics.KILL:
            os.kill(os.getpid(), signal.SIGKILL)
        elif what == topics.END:
            return 0
        elif (what, data) == (topics.alive(topics.WORLD), GONE):
            there, wake = (topics.alive(topics.WORLD), ALIVE), (topics.WAKE, b"")
            found = None
            if is_excused or latest.is_used:
                found = startup.first_of(bus, startup.REUNION_S, there, wake)
            if found is None:
                return startup.WORLD_IS_GONE
            if not (is_excused or found == wake or startup.first_of(bus, WAKE_S, wake)):
                return None
            latest.say_again()
