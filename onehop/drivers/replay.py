"""Re-execute the parts of a mission from its log alone, and compare everything that they say.

A robot is fed with the observations and inboxes that it was given, the radio with every truth, the
world with every action; nothing else goes in. If the cores are what they were and depend on nothing
hidden, every output is the same, byte for byte. State grows from the start of the mission, so a
re-execution ends where a tick is missing.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import msgpack

from onehop.contracts import topics
from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.briefings import radio_briefing, robot_briefing
from onehop.contracts.errors import DecodeError, OnehopError
from onehop.contracts.link_trace import LinkTrace
from onehop.contracts.messages import Action, Inbox, Observation, Truth, percept
from onehop.contracts.scenario import Scenario
from onehop.maps.map_file import load_map
from onehop.maps.walls import WallMap
from onehop.plugins import plugged_radio
from onehop.programs.find import check, outsiders, search_in
from onehop.programs.host import Host, ProgramError
from onehop.scenario.link_trace import link_trace
from onehop.wire.audit import Audit
from onehop.wire.codec import UNPACK_REFUSALS, decode, encode
from onehop.wire.difference import first_difference
from onehop.wire.journal import canonical_rank
from onehop.wire.log_reader import LogFile, LoggedTick, forged
from onehop.wire.logged import M, value_of
from onehop.wire.selection import Selected
from radio_proxy.core.bounds import make_radio
from world_server.core.world import World


@dataclass(frozen=True, slots=True)
class Divergence:
    """An output that differs from the recorded one. robot is 0 for world and radio.

    field "message": only one of the two said anything; the value of the other is None.
    """

    tick: int
    channel: str
    robot: int
    field: str
    recorded: Any
    replayed: Any


@dataclass(slots=True)
class Report:
    """What a re-execution found. flaws: why the log is not all that was said (audit.py).

    foreign: robots of somebody else's making, or driven from outside: what they said is taken as it is.
    """

    ticks: int = 0
    robots: tuple[int, ...] = ()
    foreign: tuple[int, ...] = ()
    compared: int = 0
    divergences: int = 0
    first: Divergence | None = None
    per_channel: dict[str, int] = field(default_factory=dict)
    flaws: list[str] = field(default_factory=list)

    @property
    def same(self) -> bool:
        """Whether everything that was asked for was compared, and is the same."""
        return self.compared > 0 and not self.divergences and not self.flaws

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
    scenario: run the robots with this one instead of the log's own (what-if). A robot with a command
    has no core to run, and is left out. Raises LogError.
    """
    original = log.bundle.scenario
    search_in(log.bundle.folder)
    wanted, foreign = original.team.robots if robots is None else robots, outsiders(original)
    chosen = tuple(robot for robot in wanted if robot not in foreign)
    check(scenario or original, str(log.path), chosen)
    players: dict[str, Player] = {
        topics.out(i): _RobotPlayer(scenario or original, i).play for i in chosen
    }
    if parts:
        walls = load_map(original.map, log.bundle.files)
        players[topics.RADIO_RECORD] = _radio(original, walls, link_trace(log.bundle, str(log.path)))
        players[topics.TRUTH] = _WorldPlayer(original, walls).play
    report = Report(robots=chosen, foreign=foreign)
    audit = Audit(log)
    comparison = _Comparison(report, players, everything=parts and robots is None, torn=log.torn)
    try:
        for number, tick in enumerate(audit.ticks()):
            comparison.judge_before(tick)
            if tick.tick != number or (last_tick is not None and tick.tick > last_tick):
                break
            if not comparison.on_tick(tick, counts=tick.tick >= first_tick):
                break
        else:
            comparison.on_end()
    except DecodeError as error:
        raise forged(log.path, error) from None
    report.flaws = audit.flaws
    return report


class _Comparison:
    """Lets the players speak to each tick, and compares what they say with what is recorded.

    players: by the channel in which each says its part of a tick, or the first of its channels.
    everything: whether they are all that speak in a mission.
    """

    def __init__(self, report: Report, players: dict[str, Player], everything: bool, torn: bool) -> None:
        self._report = report
        self._players = players
        self._everything = everything
        self._foreign = {topics.out(robot) for robot in report.foreign}
        self._torn = torn
        self._unjudged: list[Divergence] = []

    def on_tick(self, tick: LoggedTick, counts: bool) -> bool:
        """Compare a tick, if it counts; False when a component failed, so that nothing can follow."""
        said: dict[str, bytes] = {}
        for key, player in self._players.items():
            try:
                said.update(player(tick))
            except OnehopError:
                raise
            except Exception as error:  # whatever a core makes of what was not recorded as it is
                failure = f"{type(error).__name__}: {error}"
                self._report.add(Divergence(tick.tick, topics.wire(key), _robot(key), "", None, failure))
                return False
        if counts:
            self._report.ticks += 1
            self._unjudged = list(self._differences(tick.tick, dict(tick.messages), said))
        return True

    def _differences(
        self, tick: int, recorded: dict[str, bytes], said: dict[str, bytes]
    ) -> Iterator[Divergence]:
        for key in sorted({*recorded, *said}, key=canonical_rank):
            if key not in said:
                if key in self._players or (self._everything and key not in self._foreign):
                    yield _only(tick, key, "present", None)
            elif key not in recorded:
                yield _only(tick, key, None, "present")
            else:
                self._report.compared += 1
                if recorded[key] != said[key]:
                    yield _divergence(tick, key, recorded[key], said[key])

    def judge_before(self, tick: LoggedTick) -> None:
        """Report the differences of the tick before this one.

        A robot that left with this tick died before it could act, and its action is not missing.
        """
        if not self._unjudged:
            return
        truth = _value(Truth, tick, topics.TRUTH)
        gone = set() if truth is None else {one.robot for one in truth.departures}
        for one in self._unjudged:
            if not (_is_missing(one) and one.channel.startswith(_OUT) and one.robot in gone):
                self._report.add(one)
        self._unjudged = []

    def on_end(self) -> None:
        """The log ends here. What its last tick lacks is lost with the tear, or was never said."""
        for one in self._unjudged:
            if not (_is_missing(one) and (self._torn or one.channel.startswith(_OUT))):
                self._report.add(one)


def _is_missing(divergence: Divergence) -> bool:
    return divergence.field == "message" and divergence.recorded is None


_OUT = topics.wire(topics.out(""))
"""Beginning of the channels of actions."""


def _only(tick: int, key: str, recorded: str | None, replayed: str | None) -> Divergence:
    return Divergence(tick, topics.wire(key), _robot(key), "message", recorded, replayed)


def _robot(key: str) -> int:
    return int(key.partition("/")[2] or 0)


def _divergence(tick: int, key: str, recorded: bytes, replayed: bytes) -> Divergence:
    try:
        found = first_difference(msgpack.unpackb(recorded), msgpack.unpackb(replayed))
    except UNPACK_REFUSALS as error:
        found = ("bytes", f"not decodable ({error})", "decodable")
    if found is None:
        found = ("encoding", recorded.hex()[:40], replayed.hex()[:40])
    return Divergence(tick, topics.wire(key), _robot(key), *found)


def _value(kind: type[M], tick: LoggedTick, key: str) -> M | None:
    """The value of a message of a tick, None when there is none. Raises DecodeError."""
    data = tick.get(key)
    return None if data is None else value_of(kind, Selected(tick.tick, key, data))


class _RobotPlayer:
    """One robot in every incarnation."""

    def __init__(self, scenario: Scenario, robot: int) -> None:
        self._scenario = scenario
        self._id = robot
        self._incarnation = -1
        self._host: Host | None = None

    def play(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        i = self._id
        observation = _value(Observation, tick, topics.obs(i))
        inbox = _value(Inbox, tick, topics.rx(i))
        if observation is None or inbox is None:
            return
        if self._host is None or self._incarnation != observation.incarnation:
            self._incarnation = observation.incarnation
            self._host = Host(robot_briefing(self._scenario, i, self._incarnation))
        try:
            said = self._host.step(percept(observation, inbox))
        except ProgramError:  # nothing more is heard of it, as in the mission
            return
        yield topics.out(i), said


def _radio(scenario: Scenario, walls: WallMap, links: LinkTrace | None) -> Player:
    radio = make_radio(plugged_radio(radio_briefing(scenario, walls.segments, links)))

    def play(tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        truth = _value(Truth, tick, topics.TRUTH)
        if truth is None:
            return
        carried = radio.carry(truth)
        yield topics.RADIO_RECORD, encode(carried.record)
        for i, inbox in carried.inboxes.items():
            yield topics.rx(i), encode(inbox)

    return play


class _WorldPlayer:
    """The world, with the deaths and faults that no script foresaw taken from the recorded truth."""

    def __init__(self, scenario: Scenario, walls: WallMap) -> None:
        self._world = World(scenario, walls)
        self._limits = ActionLimits(scenario.team.robots)
        self._actions: dict[int, Action] | None = None

    def play(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        truth = _value(Truth, tick, topics.TRUTH)
        if truth is None:
            return
        world = self._world
        if self._actions is not None:
            world.advance(self._actions, truth.faults)
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
        self._actions = actions
