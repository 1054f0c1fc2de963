"""The shell of one robot: hear its observation and inbox of a tick, step the core, put the action."""

import os
import signal

from onehop.contracts import topics
from onehop.contracts.messages import Inbox, Observation, percept
from onehop.contracts.scenario import Briefing
from onehop.drive import node
from onehop.drive.bus import GONE, Bus
from onehop.drive.codec import decode, encode
from onehop.drive.record import unpack_record
from robot_agent.core.robot import Robot


def main() -> int:
    parser = node.arguments("robot_agent", "One robot of a mission.")
    node.add_connect(parser)
    parser.add_argument("--id", type=int, required=True, help="id of the robot, from 1")
    options = parser.parse_args()
    node.start(options)
    name = topics.robot_name(options.id)
    with node.connect(options, name) as bus:
        bus.watch(topics.WORLD)
        robot = Robot(decode(Briefing, node.briefing(bus, name)))
        node.calm_garbage_collector()
        return _serve(bus, robot, name)


def _serve(bus: Bus, robot: Robot, name: str) -> int:
    put = bus.publisher(topics.by(name, topics.OUT))
    bus.announce(name)
    while True:
        what, data = bus.receive()
        if what == topics.PERCEPT:
            _, ((_, seen), (_, heard)) = unpack_record(data)
            put(encode(robot.step(percept(decode(Observation, seen), decode(Inbox, heard)))))
        elif what == topics.FATE:
            os.kill(os.getpid(), signal.SIGKILL)
        elif what == topics.END:
            return 0
        elif data == GONE:
            return 1
