"""Re-execute the parts of a mission from its log alone, and compare everything that they say.

A robot is fed with the observations and inboxes that it was given, the radio with every truth, the world
with every action; nothing else goes in. If the cores are what they were and depend on nothing hidden,
every output is the same, byte for byte.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import msgpack

from onehop.contracts import topics
from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.briefings import radio_briefing, robot_briefing
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Action, Inbox, Observation, Truth, percept
from onehop.contracts.scenario import Scenario
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from onehop.wire.codec import decode, encode
from onehop.wire.difference import first_difference
from onehop.wire.log_reader import LogFile, LoggedTick
from radio_proxy.core.radio import Radio
from robot_agent.core.robot import Robot
from world_server.core.world import World


@dataclass(frozen=True, slots=True)
class Divergence:
    """An output that differs from the recorded one. robot is 0 for world and radio."""

    tick: int
    channel: str
    robot: int
    field: str
    recorded: Any
    replayed: Any


@dataclass(slots=True)
class Report:
    """What a re-execution found."""

    ticks: int = 0
    robots: tuple[int, ...] = ()
    compared: int = 0
    divergences: int = 0
    first: Divergence | None = None
    per_channel: dict[str, int] = field(default_factory=dict)

    def add(self, divergence: Divergence) -> None:
        self.divergences += 1
        self.per_channel[divergence.channel] = self.per_channel.get(divergence.channel, 0) + 1
        if self.first is None:
            self.first = divergence


Player = Callable[[LoggedTick], Iterator[tuple[str, bytes]]]
"""Takes the recorded messages of a tick, gives (bus key, bytes) of what a component says to them."""


def replay(
    log: LogFile,
    robots: tuple[int, ...] | None = None,
    parts: bool = True,
    first_tick: int = 0,
    last_tick: int | None = None,
    scenario: Scenario | None = None,
) -> Report:
    """Re-execute robots (all by default) and, with parts, radio and world; compare every output.

    Outputs before first_tick are made (state has to grow from the start) but not compared.
    scenario: run the robots with this one instead of the log's own (what-if).
    """
    original = log.bundle.scenario
    chosen = original.team.robots if robots is None else robots
    players: list[Player] = [_Robots(scenario or original, chosen).play]
    if parts:
        walls = load_map(original.map, log.bundle.files)
        players += [_radio(original, walls), _WorldPlayer(original, walls).play]
    report = Report(robots=chosen)
    for tick in log.ticks():
        if last_tick is not None and tick.tick > last_tick:
            break
        recorded = dict(tick.messages)
        for player in players:
            for key, data in player(tick):
                if tick.tick < first_tick or key not in recorded:
                    continue
                report.compared += 1
                if recorded[key] != data:
                    report.add(_divergence(tick.tick, key, recorded[key], data))
        report.ticks += tick.tick >= first_tick
    return report


def _divergence(tick: int, key: str, recorded: bytes, replayed: bytes) -> Divergence:
    robot = int(key.partition("/")[2] or 0)
    try:
        found = first_difference(_fields(recorded), _fields(replayed))
    except (ValueError, msgpack.UnpackException) as error:
        found = ("bytes", f"not decodable ({error})", "decodable")
    if found is None:
        found = ("encoding", recorded.hex()[:40], replayed.hex()[:40])
    return Divergence(tick, topics.wire(key), robot, *found)


def _fields(data: bytes) -> Any:
    return msgpack.unpackb(data)


class _Robots:
    """Every incarnation of the chosen robots."""

    def __init__(self, scenario: Scenario, robots: tuple[int, ...]) -> None:
        self._scenario = scenario
        self._robots = robots
        self._living: dict[int, tuple[int, Robot]] = {}

    def play(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        recorded = dict(tick.messages)
        for i in self._robots:
            seen, heard = recorded.get(topics.obs(i)), recorded.get(topics.rx(i))
            if seen is None or heard is None:
                continue
            observation, inbox = decode(Observation, seen), decode(Inbox, heard)
            incarnation = observation.incarnation
            if i not in self._living or self._living[i][0] != incarnation:
                briefing = robot_briefing(self._scenario, i, incarnation)
                self._living[i] = incarnation, Robot(briefing)
            yield topics.out(i), encode(self._living[i][1].step(percept(observation, inbox)))


def _radio(scenario: Scenario, walls: WallMap) -> Player:
    radio = Radio(radio_briefing(scenario, walls.segments))

    def play(tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        data = tick.get(topics.TRUTH)
        if data is None:
            return
        carried = radio.carry(decode(Truth, data))
        yield topics.RADIO_RECORD, encode(carried.record)
        for i, inbox in carried.inboxes.items():
            yield topics.rx(i), encode(inbox)

    return play


class _WorldPlayer:
    """The world, with the deaths that no script foresaw taken from the recorded truth."""

    def __init__(self, scenario: Scenario, walls: WallMap) -> None:
        self._world = World(scenario, walls)
        self._limits = ActionLimits(scenario.team.robots)

    def play(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        data = tick.get(topics.TRUTH)
        if data is None:
            return
        world = self._world
        truth = decode(Truth, data)
        present = {presence.robot for presence in truth.present}
        for departure in truth.departures:
            if departure.robot not in present:
                world.fence(departure.robot, departure.why)
        yield topics.TRUTH, encode(world.truth())
        for i, observation in world.observe().items():
            yield topics.obs(i), encode(observation)
        actions: dict[int, Action] = {}
        for key, action in tick.messages:
            stem, _, robot = key.partition("/")
            if stem == "out":
                try:
                    said = decode(Action, action)
                except DecodeError:
                    continue
                if self._limits.breach(said, tick.tick, said.incarnation) is None:
                    actions[int(robot)] = said
        world.advance(actions)
