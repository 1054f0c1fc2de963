"""The shell of the world in lock-step: it holds the clock, and everyone else waits for its tick.

For tick k it puts truth(k), waits for the inboxes that the radio makes of it, puts every percept(k),
waits for out(k) of every robot that truth(k) called present, and lets the world advance. A robot whose
token vanishes, who stays silent too long or puts something that is no action of this tick is fenced:
truth(k+1) leaves it out. Without its radio or its recorder a mission has no meaning: it is aborted.
"""

import argparse
import signal
import time
from dataclasses import dataclass
from pathlib import Path

from onehop.contracts import topics
from onehop.contracts.briefings import LogBriefing, RadioBriefing, radio_briefing, robot_briefing
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Action, End, Outcome, Progress, RobotProgress, Truth
from onehop.maps.map_file import load_map
from onehop.node import startup
from onehop.node.bus import ALIVE, Bus, open_router
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.wire.batch import TickMessages, pack_tick, pack_ticks, unpack_tick
from onehop.wire.codec import decode, encode
from onehop.wire.journal import WireMessage
from world_server.core.world import World

RECORD_TICKS = 3
"""Ticks that go to the recorder at once."""

RECORD_WINDOW = 5
"""Ticks that the world may be ahead of the file: what a kill -9 of the recorder can cost at most."""

_AIR = f"{topics.RADIO}/{topics.CARRIED}"
_RECORDED = f"{topics.RECORDER}/{topics.RECORDED}"
_STOPS = (f"{topics.OPERATOR}/{topics.CONTROL}", f"{topics.WORLD}/{topics.CONTROL}")
_ALIVE = f"{topics.WORLD}/{topics.alive('')}"
"""What the bus calls the messages that the world hears."""

_TOLD_OF_THE_OUTCOME = (topics.RECORDER, topics.OPERATOR)

PROGRESS_S = 0.2
FAREWELL_S = 30.0
START_S = 30.0
RESTART_S = 20.0


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
    world.observe()  # compiles or loads the laser kernel before anyone waits for it
    with open_router(options.mission, options.listen, startup.credentials()) as bus:
        return _Host(
            bus, bundle, world, radio_briefing(bundle.scenario, walls.segments), options.driver
        ).serve()


def _options() -> argparse.Namespace:
    parser = startup.arguments("world_server", "Map, motion and clock of a mission; its bus router.")
    parser.add_argument("scenario", type=Path, help="scenario file (.toml)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change a key")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--map", type=Path)
    parser.add_argument("--start", metavar="X,Y")
    parser.add_argument("--goal", metavar="X,Y")
    parser.add_argument("--listen", required=True, metavar="ENDPOINT", help="e.g. tcp/127.0.0.1:7447")
    parser.add_argument("--driver", default="processes", help="what the log calls this way of running")
    return parser.parse_args()


@dataclass
class _InterruptedError(Exception):
    reason: str


class _Host:
    """One mission as the world runs it."""

    def __init__(
        self, bus: Bus, bundle: Bundle, world: World, radio: RadioBriefing, driver: str
    ) -> None:
        self._bus = bus
        self._scenario = bundle.scenario
        self._world = world
        robots = self._scenario.team.robots
        self._incarnations = dict.fromkeys(robots, 0)
        self._names = {topics.robot_name(i): i for i in robots}
        self._outs = {f"{name}/{topics.OUT}": i for name, i in self._names.items()}
        self._alive: set[str] = set()
        self._recorded = -1
        self._last_tick = -1
        self._record: list[TickMessages] = []
        self._air: bytes | None = None
        self._actions: dict[int, tuple[Action, bytes]] = {}
        self._awaited: set[int] = set()
        self._fenced: dict[int, str] = {}
        self._stop: str | None = None
        self._restarting = 0
        self._next_progress = 0.0
        self._briefings = {
            topics.config(topics.RADIO): encode(radio),
            topics.config(topics.RECORDER): encode(
                LogBriefing(driver, bundle.scenario_json(), tuple(sorted(bundle.files.items())))
            ),
        }
        to = topics.to
        self._put_truth = bus.publisher(to(topics.RADIO, topics.TRUTH))
        self._put_percept = {
            i: bus.publisher(to(name, topics.PERCEPT)) for name, i in self._names.items()
        }
        self._put_kill = {i: bus.publisher(to(name, topics.KILL)) for name, i in self._names.items()}
        self._put_record = bus.publisher(to(topics.RECORDER, topics.TICKS), express=False)
        self._put_progress = bus.publisher(to(topics.OPERATOR, topics.PROGRESS), express=False)
        self._put_restart = bus.publisher(to(topics.OPERATOR, topics.RESTART))
        self._put_end = [bus.publisher(to(name, topics.END)) for name in _TOLD_OF_THE_OUTCOME]
        self._dismiss = [bus.publisher(to(name, topics.END)) for name in (*self._names, topics.RADIO)]

    def serve(self) -> int:
        """Run the mission from the first process's arrival to the last one's farewell."""
        signal.signal(signal.SIGTERM, self._on_sigterm)
        bus = self._bus
        bus.watch("*")
        bus.answer(topics.config("*"), self._brief)
        bus.announce(topics.WORLD)
        started = time.monotonic()
        try:
            self._await_everyone()
            startup.calm_garbage_collector()
            started = time.monotonic()
            outcome = self._run()
        except _InterruptedError as interruption:
            outcome = self._world.aborted(interruption.reason)
        wall_s = time.monotonic() - started
        self._hand_over_record()
        end = encode(End(outcome, self._last_tick, wall_s))
        for put in self._put_end:
            put(end)
        for put in self._dismiss:
            put(b"")
        self._await_farewell()
        return 0

    def _on_sigterm(self, *_: object) -> None:
        self._bus.tell_self(topics.CONTROL)

    def _brief(self, key: str) -> bytes | None:
        """The answer to a process that asks for its briefing."""
        name = key.removeprefix(topics.config(""))
        robot = self._names.get(name)
        if robot is None:
            return self._briefings.get(key)
        return encode(robot_briefing(self._scenario, robot, self._incarnations[robot]))

    def _await_everyone(self) -> None:
        wanted = {*self._names, topics.RADIO, topics.RECORDER}
        deadline = time.monotonic() + START_S
        while missing := wanted - self._alive:
            self._hear(deadline)
            if time.monotonic() > deadline:
                names = ", ".join(sorted(missing))
                raise _InterruptedError(f"not started within {START_S:.0f} s: {names}")

    def _run(self) -> Outcome:
        outcome = None
        while outcome is None:
            outcome = self._tick()
        return outcome

    def _tick(self) -> Outcome | None:
        world = self._world
        truth = world.truth()
        self._carry_out_faults(truth)
        encoded_truth = encode(truth)
        self._air = None
        self._put_truth(encoded_truth)
        seen = [(topics.obs(i), encode(observation)) for i, observation in world.observe().items()]
        air = self._await_air()
        heard = dict(air)
        for presence, observation in zip(truth.present, seen, strict=True):
            inbox = topics.rx(presence.robot)
            percept = pack_tick(truth.tick, [observation, (inbox, heard[inbox])])
            self._put_percept[presence.robot](percept)
        self._collect(truth)
        done = [(topics.out(i), self._actions[i][1]) for i in sorted(self._actions)]
        self._record.append((truth.tick, [(topics.TRUTH, encoded_truth), *air, *seen, *done]))
        self._last_tick = truth.tick
        if len(self._record) == RECORD_TICKS:
            self._hand_over_record()
        world.advance({i: self._actions[i][0] for i in sorted(self._actions)})
        for i in sorted(self._fenced):
            world.fence(i, self._fenced[i])
        self._fenced.clear()
        self._report_progress(truth)
        return world.outcome()

    def _hand_over_record(self) -> None:
        self._put_record(pack_ticks(self._record))
        self._record.clear()

    def _await_air(self) -> list[WireMessage]:
        """Inboxes and record of this tick, from the radio."""
        deadline = time.monotonic() + self._scenario.clock.silence_s
        while self._air is None:
            if self._stop:
                raise _InterruptedError(self._stop)
            self._hear(deadline)
            if time.monotonic() > deadline:
                raise _InterruptedError(f"the radio is silent for {self._scenario.clock.silence_s:g} s")
        tick, messages = unpack_tick(self._air)
        if tick != self._world.tick:
            raise _InterruptedError(f"the radio answers for tick {tick}, not {self._world.tick}")
        return messages

    def _collect(self, truth: Truth) -> None:
        """Wait for the action of every present robot; fence those who cannot give it."""
        self._actions.clear()
        self._awaited = {presence.robot for presence in truth.present}
        for i in sorted(self._awaited):
            if topics.robot_name(i) not in self._alive:
                self._fence(i, "its process died")
        deadline = time.monotonic() + self._scenario.clock.silence_s
        while self._awaited or truth.tick - self._recorded > RECORD_WINDOW:
            if self._stop:
                raise _InterruptedError(self._stop)
            self._hear(deadline)
            if time.monotonic() > deadline:
                if not self._awaited:
                    raise _InterruptedError("the recorder does not keep up")
                for i in sorted(self._awaited):
                    self._fence(i, f"silent for {self._scenario.clock.silence_s:g} s")

    def _hear(self, deadline: float) -> None:
        """Take in one message, waiting for it until the deadline at most."""
        received = self._bus.receive_by(deadline)
        if received is None:
            return
        key, data = received
        robot = self._outs.get(key)
        if robot is not None:
            self._on_action(robot, data)
        elif key == _AIR:
            self._air = data
        elif key == _RECORDED:
            self._recorded = int.from_bytes(data, "little")
        elif key in _STOPS:
            self._stop = "stopped by the operator"
        elif key.startswith(_ALIVE):
            self._on_alive(key.removeprefix(_ALIVE), data == ALIVE)

    def _on_alive(self, name: str, alive: bool) -> None:
        """Take in that a process has come or gone."""
        if alive:
            self._alive.add(name)
            return
        self._alive.discard(name)
        robot = self._names.get(name)
        if robot is not None:
            if robot != self._restarting:
                self._fence(robot, "its process died")
        elif name in (topics.RADIO, topics.RECORDER):
            self._stop = f"the {name} process died"

    def _on_action(self, robot: int, data: bytes) -> None:
        if robot not in self._awaited:
            return
        try:
            action = decode(Action, data)
        except DecodeError as error:
            self._fence(robot, f"put no action: {error}")
            return
        if (action.tick, action.incarnation) != (self._world.tick, self._incarnations[robot]):
            return
        self._awaited.discard(robot)
        self._actions[robot] = action, data

    def _fence(self, robot: int, why: str) -> None:
        """Leave a robot out from the next tick on; an action that it gave for this one still counts."""
        self._awaited.discard(robot)
        self._fenced.setdefault(robot, why)

    def _carry_out_faults(self, truth: Truth) -> None:
        """End the processes of those who departed, start those anew that the script restarts.

        The world holds its tick meanwhile, so a run with kills and restarts is as reproducible as one
        without.
        """
        present = {presence.robot for presence in truth.present}
        for departure in truth.departures:
            if departure.robot not in present:
                self._put_kill[departure.robot](b"")
        for fault in self._world.due_faults():
            if fault.kind == "restart":
                for i in sorted(fault.robots):
                    self._restart(i)

    def _restart(self, robot: int) -> None:
        name = topics.robot_name(robot)
        self._incarnations[robot] += 1
        self._put_kill[robot](b"")
        self._restarting = robot
        deadline = time.monotonic() + RESTART_S
        while name in self._alive and time.monotonic() < deadline:
            self._hear(deadline)
        self._put_restart(str(robot).encode())
        while name not in self._alive:
            self._hear(deadline)
            if time.monotonic() > deadline:
                raise _InterruptedError(f"robot {robot} was not started again within {RESTART_S:.0f} s")
        self._restarting = 0

    def _report_progress(self, truth: Truth) -> None:
        now = time.monotonic()
        if now < self._next_progress:
            return
        self._next_progress = now + PROGRESS_S
        lines = tuple(
            RobotProgress(i, action.twist.v, action.status)
            for i, (action, _) in sorted(self._actions.items())
        )
        self._put_progress(encode(Progress(truth.tick, truth.time_ns, lines)))

    def _await_farewell(self) -> None:
        """Stay, as the router of the bus, until everyone who was told of the end has left."""
        deadline = time.monotonic() + FAREWELL_S
        staying = {*self._names, topics.RADIO, topics.RECORDER}
        while self._alive & staying and time.monotonic() < deadline:
            self._hear(deadline)
