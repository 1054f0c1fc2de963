"""The shell of one robot: hear its observation and inbox of a tick, step the core, put the action."""

import os
import signal
import time

from onehop.contracts import topics
from onehop.contracts.briefings import Briefing
from onehop.contracts.messages import Inbox, Observation, percept
from onehop.node import startup
from onehop.node.bus import ALIVE, GONE, Bus
from onehop.wire.batch import unpack_tick
from onehop.wire.codec import decode, encode
from robot_agent.core.robot import Robot


def main() -> int:
    parser = startup.arguments("robot_agent", "One robot of a mission.")
    startup.add_connect(parser)
    parser.add_argument("--id", type=int, required=True, help="id of the robot, from 1")
    options = parser.parse_args()
    startup.start(options)
    name = topics.robot_name(options.id)
    with startup.connect(options, name) as bus:
        bus.watch(topics.WORLD)
        arrival = bus.publisher(topics.by(name, topics.ARRIVAL))
        robot = Robot(decode(Briefing, startup.briefing(bus, name, lambda: arrival(b""))))
        startup.calm_garbage_collector()
        return _serve(bus, robot, name)


REUNION_S = 10.0
"""How long a process that was stopped looks for the world [s], when its session has been given up."""


def _serve(bus: Bus, robot: Robot, name: str) -> int:
    put = bus.publisher(topics.by(name, topics.OUT))
    put_awake = bus.publisher(topics.by(name, topics.AWAKE))
    bus.announce(name)
    will_be_stopped = False
    while True:
        what, data = bus.receive()
        if what == topics.PERCEPT:
            _, ((_, seen), (_, heard)) = unpack_tick(data)
            put(encode(robot.step(percept(decode(Observation, seen), decode(Inbox, heard)))))
            will_be_stopped = False
        elif what in (topics.STOP, topics.WAKE):
            will_be_stopped = True
            put_awake(b"")
        elif what == topics.KILL:
            os.kill(os.getpid(), signal.SIGKILL)
        elif what == topics.END:
            return 0
        elif (what, data) == (topics.alive(topics.WORLD), GONE) and not (
            will_be_stopped and _finds_world(bus)
        ):
            return startup.WORLD_IS_GONE


def _finds_world(bus: Bus) -> bool:
    """Whether the world comes back in time; what it says before is lost, and it will ask again."""
    deadline = time.monotonic() + REUNION_S
    while (received := bus.receive_by(deadline)) is not None:
        if received == (topics.alive(topics.WORLD), ALIVE):
            return True
    return False
