"""A mission in real time without a clock: robots answer when a seed says so.

World, radio and programs are the real ones, and so is what puts questions, answers and the record
together; bus and wall clock are not there. So it takes no longer than it must, and is always the same.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from onehop.contracts import topics
from onehop.contracts.briefings import radio_briefing, robot_briefing
from onehop.contracts.geometry import Pose, Twist, wrap_angle
from onehop.contracts.hardware import Measured, Taken
from onehop.contracts.messages import Outcome, TransmitRequest, Truth
from onehop.contracts.operation import Punctuality
from onehop.maps.map_file import load_map
from onehop.programs.host import Host
from onehop.scenario.bundle import Bundle
from onehop.wire.batch import unpack_ticks
from onehop.wire.codec import encode
from onehop.wire.journal import Journal, WireMessage
from onehop.wire.log_writer import LogWriter
from onehop.wire.summary import summarize
from radio_proxy.core.bounds import make_radio
from radio_proxy.core.continuous import ContinuousRadio, Due
from robot_agent.latest_data import LatestData
from world_server.core.command_hold import CommandHold
from world_server.core.world import World
from world_server.realtime.recording import RealTimeRecording
from world_server.realtime.robots import RealTimeRobots

ANSWERS = 0.8
"""How probable it is that a robot that was asked answers before the tick ends."""


class _Bus:
    """Passes on what is put; nobody is ever absent or turned out."""

    def __init__(self) -> None:
        self.takers: dict[str, Callable[[bytes], None]] = {}
        self.readers: dict[str, Callable[[bytes], None]] = {}
        self.shut_out = self.read_stray = lambda _: None
        self.when_present = lambda *_: None

    def publisher(self, key: str, **_: Any) -> Callable[[bytes], None]:
        return lambda data: self.takers[key](data)

    def read(self, name: str, what: str, reader: Callable[[bytes], None]) -> None:
        self.readers[topics.by(name, what)] = reader


MEASURES = 0.9
"""How probable it is that a real base has measured anew when a tick ends."""


class Jitter:
    """One mission. seed: of what is a matter of time.

    A real base starts where the scenario has its robot, goes as it is told but for some slip, and its
    laser says that there is nothing.
    """

    def __init__(self, bundle: Bundle, seed: int = 1) -> None:
        scenario = bundle.scenario
        self._scenario = scenario
        walls = load_map(scenario.map, bundle.files)
        self._rng = np.random.default_rng(seed)
        self._world = World(scenario, walls)
        self._radio = ContinuousRadio(make_radio(radio_briefing(scenario, walls.segments)))
        self._hold = CommandHold(scenario)
        bus: Any = _Bus()
        self._bus = bus
        ids = scenario.team.robots
        names = {topics.robot_name(i) for i in ids}
        roll: Any = type("Roll", (), {"present": names, "when_seen_again": lambda _: None})
        self._robots = RealTimeRobots(bus, bus, roll, ids, 1e9, self._hand_over)
        self._recording = RealTimeRecording(bus, bus, bus, scenario.clock.period_ns, self._on_lie)
        self._processes: dict[int, tuple[int, LatestData]] = {}
        self._told: list[WireMessage] = []
        self._measured = {
            i: Measured(
                1, pose, Twist(0.0, 0.0), np.full(scenario.body_of(i).laser_beams, np.inf, "<f4")
            )
            for i in scenario.bases
            for pose in [Pose(*scenario.start.poses[ids.index(i)])]
        }
        self._taken = self._measured
        self._world.place(self._taken)
        for i in ids:
            bus.takers[topics.to(topics.robot_name(i), topics.OBSERVATION)] = self._taker(i)
        self._now_ns = 0
        self._out: list[bytes] = []
        bus.takers[topics.to(topics.RECORDER, topics.TICKS)] = self._out.append

    def write(self, path: Path, bundle: Bundle) -> Outcome:
        """Run it and write its log."""
        outcome = None
        while outcome is None:
            truth = self._world.truth()
            self._begin(truth)
            self._let_robots_act(truth)
            answers = self._robots.close(truth, frozenset())
            self._recording.end(truth.tick, answers)
            self._taken = self._measure()
            self._world.advance(self._hold.filled(truth, answers.actions), (), self._taken)
            for robot, why in answers.fenced.items():
                self._world.fence(robot, why)
            outcome = self._world.outcome()
        self._close(self._world.time_ns)
        self._recording.hand_over()
        log = LogWriter(path, bundle, "jitter")
        journal = Journal(log.write)
        for data in self._out:
            for tick, messages in unpack_ticks(data):
                journal.add(tick, messages)
        punctual = Punctuality(1.0, 0.0, 0, 0.0, 0.0, 0, 0)
        log.close(summarize(outcome, 1.0, journal.digest(), str(path), punctuality=punctual))
        return outcome

    def _begin(self, truth: Truth) -> None:
        for one in truth.present:
            i, incarnation = one.robot, one.incarnation
            if i not in self._processes or self._processes[i][0] != incarnation:
                host = Host(robot_briefing(self._scenario, i, incarnation))
                put = self._bus.readers[topics.by(topics.robot_name(i), topics.ACTED)]
                self._processes[i] = incarnation, LatestData(host, put)
        self._close(truth.time_ns + int(self._rng.integers(0, 3_000_000)))
        self._deliver(self._radio.place(truth, self._radio.now_ns))
        observations = {i: encode(seen) for i, seen in self._world.observe().items()}
        self._robots.ask(truth, observations)
        said = [(topics.obs(i), data) for i, data in observations.items()]
        for i, measured in self._taken.items():
            said.append((topics.base(i), encode(Taken(truth.tick, truth.time_ns, measured))))
        self._recording.begin(truth.tick, [(topics.TRUTH, encode(truth)), *said])

    def _measure(self) -> dict[int, Measured]:
        """Real bases have moved by what they were last told; those that have measured it."""
        period_s = self._scenario.clock.period_ns / 1e9
        for i, drive in self._world.drives().items():
            before = self._measured[i]
            way, turn = 0.97 * drive.v * period_s, 0.98 * drive.w * period_s
            x, y, heading = before.pose.x, before.pose.y, before.pose.heading
            pose = Pose(
                x + way * math.cos(heading), y + way * math.sin(heading), wrap_angle(heading + turn)
            )
            self._measured[i] = Measured(before.number + 1, pose, drive, before.scan)
        return {i: one for i, one in self._measured.items() if self._rng.random() < MEASURES}

    def _close(self, at_ns: int) -> None:
        due, record = self._radio.close(at_ns)
        self._deliver(due)
        if record is not None:
            radio = topics.RADIO_RECORD, encode(record)
            self._recording.take((record.tick, [radio, *self._told]))
            self._told = []

    def _let_robots_act(self, truth: Truth) -> None:
        period_ns = self._scenario.clock.period_ns
        acting = []
        for i, (_, process) in self._processes.items():
            late, in_time = self._rng.integers(0, period_ns), self._rng.random() < ANSWERS
            if process.can_step and in_time and i not in truth.stopped:
                acting.append((truth.time_ns + int(late), i))
        for self._now_ns, i in sorted(acting):
            self._deliver(self._radio.follow(self._now_ns))
            self._processes[i][1].step()

    def _taker(self, i: int) -> Callable[[bytes], None]:
        return lambda data: self._processes[i][1].on_observation(data)

    def _hand_over(self, request: TransmitRequest) -> None:
        self._deliver(self._radio.hand_over(request, max(self._now_ns, self._radio.now_ns)))

    def _deliver(self, due: Due) -> None:
        for i, heard in due:
            data = encode(heard)
            self._told.append((topics.rx(i), data))
            self._processes[i][1].on_heard(data)

    def _on_lie(self, robot: int) -> None:
        raise AssertionError(f"robot {robot} names what it was not given")
