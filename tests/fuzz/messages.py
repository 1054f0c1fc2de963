"""What peers say: wire messages to every decoder, actions to the world, payloads to a robot, truths to
the radio."""

from collections.abc import Iterator
from pathlib import Path
from random import Random

import msgpack
import numpy as np

from onehop.contracts.action_limits import LARGEST, MSDU_BYTES, ActionLimits
from onehop.contracts.briefings import (
    Briefing,
    LogBriefing,
    RadioBriefing,
    radio_briefing,
    robot_briefing,
)
from onehop.contracts.errors import DecodeError
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import (
    Action,
    Cut,
    Inbox,
    Jam,
    Observation,
    Outcome,
    Percept,
    Presence,
    RadioRecord,
    Reception,
    Transmission,
    TransmitRequest,
    Truth,
)  # fmt: skip
from onehop.contracts.operation import Death, End, Progress, RobotProgress
from onehop.contracts.values import Wire
from onehop.maps.map_file import load_map
from onehop.programs.host import Host
from onehop.scenario.bundle import Bundle
from onehop.wire.codec import decode, encode
from onehop.wire.log_reader import LogFile
from onehop.wire.spoken import action_in
from radio_proxy.core.bounds import make_radio
from robot_agent.core.team import team_messages
from tests.fuzz.damage import damaged
from tests.onehop.log_forms import ticks_of, with_extreme
from world_server.core.world import World

_KINDS: dict[str, type[Wire]] = {
    kind.__name__: kind
    for kind in (
        Action, Briefing, Death, End, Inbox, LogBriefing, Observation, Progress, RadioBriefing,
        RadioRecord, Truth,
    )
}  # fmt: skip
_CHANNELS = {"truth": Truth, "radio": RadioRecord, "obs": Observation, "rx": Inbox, "out": Action}

_PAYLOAD, _AIR = "payload", "air"
"""Two more kinds of files: a payload between robots, truths as MessagePack for the radio."""

_COORDINATES = (0.0, 1.0, 8.0, 20.0, -1e7, 1e7, 1e-9)
_SPEEDS = (0.0, 1.0, 1e-300, LARGEST)


_AIRTIME_NS = 1_000_000
"""What a payload takes on the air [ns], about that of 800 bytes at 11 Mbit/s."""


class Messages:
    """Messages made of those of a recorded mission."""

    def __init__(self, recorded: Path) -> None:
        self._bundle = LogFile(recorded).bundle
        self._known: dict[str, list[bytes]] = {name: [] for name in (*_KINDS, _PAYLOAD)}
        for _, messages in ticks_of(recorded):
            for key, data in messages:
                self._known[_CHANNELS[key.partition("/")[0]].__name__].append(data)
        for data in self._known[Inbox.__name__]:
            self._known[_PAYLOAD] += [one.payload for one in decode(Inbox, data).receptions]
        for message in _others(self._bundle, decode(Action, self._known[Action.__name__][-1])):
            self._known[type(message).__name__].append(encode(message))

    def make(self, folder: Path, random: Random) -> None:
        """Write one file, named as its kind."""
        kinds = (Action.__name__, _PAYLOAD, _PAYLOAD, _AIR, random.choice(list(_KINDS)))
        name = random.choice(kinds)
        if name == _AIR:
            data = msgpack.packb([encode(truth) for truth in self._truths(random)])
        else:
            data = random.choice(self._known[name])
            if name == _PAYLOAD:
                data = data[: -team_messages.CHECKSUM_BYTES]
            if random.random() < 0.6:
                data = with_extreme(data, random)
            if random.random() < 0.4:
                data = damaged(data, self._known[random.choice(list(self._known))], random)
            if name == _PAYLOAD and random.random() < 0.9:
                data = team_messages.sealed(data)
        (folder / f"{name}.bin").write_bytes(data)

    def read(self, folder: Path) -> None:
        """Hand it to whom it is for. Raises DecodeError for what is refused."""
        path = next(folder.glob("*.bin"))
        data = path.read_bytes()
        if path.stem == _AIR:
            self._carry(data)
        elif path.stem == _PAYLOAD:
            self._hear(data)
        else:
            message = decode(_KINDS[path.stem], data)
            decode(type(message), encode(message))
            if isinstance(message, Action):
                self._act(message)

    def _act(self, action: Action) -> None:
        """The world takes an action within the limits, and the radio what is in it."""
        scenario = self._bundle.scenario
        limits = ActionLimits(scenario.team.robots)
        why = limits.breach(action, action.tick, action.incarnation)
        if why is not None:
            raise DecodeError(why)
        walls = load_map(scenario.map, self._bundle.files)
        world, radio = World(scenario, walls), make_radio(radio_briefing(scenario, walls.segments))
        for _ in range(3):
            encode(radio.carry(world.truth()).record)
            world.observe()
            world.advance(dict.fromkeys(scenario.team.robots, action))
        world.outcome()

    def _hear(self, payload: bytes) -> None:
        """Two robots hear it at some ticks; what they do stays within the limits."""
        scenario = self._bundle.scenario
        limits = ActionLimits(scenario.team.robots)
        scan = np.full(scenario.robot.laser_beams, 5.0, dtype=np.float32)
        for me in (1, 3):
            robot = Host(robot_briefing(scenario, me, 0))
            for tick in range(12):
                now = tick * scenario.clock.period_ns
                heard = Reception(
                    1 + tick % 4, payload, now - _AIRTIME_NS, now, 1, 1, 20.0, 0.0, MSDU_BYTES
                )
                inbox = (heard,) if tick % 3 else ()
                percept = Percept(tick, now, Pose(8.0, 8.0, 0.0), Twist(0.0, 0.0), scan, inbox)
                action = action_in(robot.step(percept), limits)
                why = limits.breach(action, tick, 0)
                assert why is None, f"robot {me} does what it may not: {why}"
        team_messages.decode(payload)

    def _carry(self, data: bytes) -> None:
        scenario = self._bundle.scenario
        walls = load_map(scenario.map, self._bundle.files)
        radio = make_radio(radio_briefing(scenario, walls.segments))
        for packed in msgpack.unpackb(data):
            carried = radio.carry(decode(Truth, packed))
            encode(carried.record)
            for inbox in carried.inboxes.values():
                encode(inbox)

    def _truths(self, random: Random) -> Iterator[Truth]:
        """What a world could say at some ticks: any poses, any faults, anything that may be sent."""
        scenario = self._bundle.scenario
        team = scenario.team.robots
        limits = ActionLimits(team)
        for tick in range(4):
            present = tuple(sorted(random.sample(team, random.randint(1, len(team)))))
            cuts = tuple(Cut((random.choice(team),), team) for _ in range(random.choice((0, 0, 1, 3))))
            jams = tuple(
                Jam(random.choice(_COORDINATES), 8.0, 1e6, random.choice((-200.0, -60.0, 100.0)))
                for _ in range(random.choice((0, 0, 1)))
            )
            yield Truth(
                tick,
                tick * scenario.clock.period_ns,
                tuple(
                    Presence(robot, random.choice((0, 0, 1)), _pose(random), Twist(0.0, 0.0), False)
                    for robot in present
                ),
                tuple(_request(robot, limits, random) for robot in present),
                cuts,
                jams,
                (),
                (),
            )


def _pose(random: Random) -> Pose:
    return Pose(random.choice(_COORDINATES), random.choice(_COORDINATES), 0.0)


def _request(robot: int, limits: ActionLimits, random: Random) -> TransmitRequest:
    outbox = []
    for _ in range(random.choice((0, 1, 3, 100))):
        length = random.choice((0, 1, 800, MSDU_BYTES))
        destination = random.choice((0, 1, 2, 3, 4, 5, 2**63 - 1))
        outbox.append(Transmission(destination, bytes(length), length, random.choice((0, 1, 2**63 - 1))))
    fitting = tuple(limits.fitting(outbox))
    return TransmitRequest(robot, random.choice(_SPEEDS), random.choice(_SPEEDS), fitting)


def _others(bundle: Bundle, action: Action) -> Iterator[Wire]:
    """Messages that no log holds."""
    scenario = bundle.scenario
    yield robot_briefing(scenario, 1, 0)
    yield radio_briefing(scenario, load_map(scenario.map, bundle.files).segments)
    yield LogBriefing("processes", "{}", (("m.pgm", b"P5"),), "")
    yield Death("robot-1", 0, "killed by SIGKILL")
    yield End(Outcome("arrived", "all are there", (1, 2), (), (), 30, 1.5, 0), 29, 1.0)
    yield Progress(3, 150_000_000, (RobotProgress(1, 1.0, action.status),))
