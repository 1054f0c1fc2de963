"""The shell of one robot: hear its observation and inbox of a tick, step the core, put the action."""

import os
import signal

from onehop.contracts import topics
from onehop.contracts.briefings import Briefing
from onehop.contracts.messages import Inbox, Observation, percept
from onehop.node import startup
from onehop.node.bus import GONE, Bus
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
        robot = Robot(decode(Briefing, startup.briefing(bus, name)))
        startup.calm_garbage_collector()
        return _serve(bus, robot, name)


def _serve(bus: Bus, robot: Robot, name: str) -> int:
    put = bus.publisher(topics.by(name, topics.OUT))
    put_awake = bus.publisher(topics.by(name, topics.AWAKE))
    bus.announce(name)
    while True:
        what, data = bus.receive()
        if what == topics.PERCEPT:
            _, ((_, seen), (_, heard)) = unpack_tick(data)
            put(encode(robot.step(percept(decode(Observation, seen), decode(Inbox, heard)))))
        elif what == topics.WAKE:
            put_awake(b"")
        elif what == topics.KILL:
            os.kill(os.getpid(), signal.SIGKILL)
        elif what == topics.END:
            return 0
        elif what == topics.alive(topics.WORLD) and data == GONE:
            return startup.WORLD_IS_GONE
