"""The shell of one robot: hear an observation and an inbox, step the core, put the action.

Lock-step: an action is put as soon as observation and inbox of the same tick are there, never before.
"""

import os
import signal

from onehop.contracts import topics
from onehop.contracts.messages import Inbox, Observation, percept
from onehop.contracts.scenario import Briefing
from onehop.drive import node
from onehop.drive.bus import GONE, Bus
from onehop.drive.codec import decode, encode
from robot_agent.core.robot import Robot


def main() -> int:
    parser = node.arguments("robot_agent", "One robot of a mission.")
    node.add_connect(parser)
    parser.add_argument("--id", type=int, required=True, help="id of the robot, from 1")
    options = parser.parse_args()
    node.start(options)
    name = topics.robot_name(options.id)
    with node.connect(options, name) as bus:
        for key in (topics.obs, topics.rx, topics.fate):
            bus.subscribe(key(options.id))
        bus.subscribe(topics.END)
        bus.watch(topics.alive(topics.WORLD))
        robot = Robot(decode(Briefing, node.briefing(bus, name)))
        node.calm_garbage_collector()
        return _serve(bus, robot, options.id, name)


def _serve(bus: Bus, robot: Robot, identity: int, name: str) -> int:
    put = bus.publisher(topics.out(identity))
    obs_key, rx_key, fate_key = (key(identity) for key in (topics.obs, topics.rx, topics.fate))
    observation: Observation | None = None
    inbox: Inbox | None = None
    bus.announce(name)
    while True:
        key, data = bus.inbox.get()
        if key == obs_key:
            observation = decode(Observation, data)
        elif key == rx_key:
            inbox = decode(Inbox, data)
        elif key == fate_key:
            os.kill(os.getpid(), signal.SIGKILL)
        elif key == topics.END:
            return 0
        elif key == topics.alive(topics.WORLD):
            if data is GONE:
                return 1
            continue
        if observation is not None and inbox is not None and observation.tick == inbox.tick:
            put(encode(robot.step(percept(observation, inbox))))
            observation = inbox = None
