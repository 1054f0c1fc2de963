"""Re-execute the parts of a mission from its log alone, and compare everything that they say.

A robot is fed with the observations and inboxes that it was given, the radio with every truth, the
world with every action; nothing else goes in. If the cores are what they were and depend on nothing
hidden, every output is the same, byte for byte. State grows from the start of the mission, so a
re-execution ends where a tick is missing.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import msgpack

from onehop.contracts import topics
from onehop.contracts.briefings import radio_briefing
from onehop.contracts.errors import DecodeError, OnehopError
from onehop.contracts.messages import Truth
from onehop.contracts.scenario import Scenario
from onehop.drivers.players import (
    Player,
    RadioPlayer,
    RealTimeRadioPlayer,
    RobotPlayer,
    WorldPlayer,
    value_in,
)
from onehop.maps.map_file import load_map
from onehop.plugins import plugged_radio
from onehop.programs.find import check, outsiders, search_in
from onehop.scenario.link_trace import link_trace
from onehop.wire.audit import Audit
from onehop.wire.codec import UNPACK_REFUSALS
from onehop.wire.difference import first_difference
from onehop.wire.journal import canonical_rank
from onehop.wire.log_reader import LogFile, LoggedTick, forged
from radio_proxy.core.bounds import make_radio


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
    bases: robots with a real base: what that measured is taken as it is.
    """

    ticks: int = 0
    robots: tuple[int, ...] = ()
    foreign: tuple[int, ...] = ()
    bases: tuple[int, ...] = ()
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
    wanted = original.team.robots if robots is None else robots
    check(scenario or original, str(log.path), wanted)
    foreign = outsiders(original)
    chosen = tuple(robot for robot in wanted if robot not in foreign)
    players: dict[str, Player] = {
        topics.out(i): RobotPlayer(scenario or original, i).play for i in chosen
    }
    if parts:
        walls = load_map(original.map, log.bundle.files)
        links = link_trace(log.bundle, str(log.path))
        radio = make_radio(plugged_radio(radio_briefing(original, walls.segments, links)))
        in_real_time = original.clock.is_realtime
        radio_player = RealTimeRadioPlayer(radio) if in_real_time else RadioPlayer(radio)
        players[topics.RADIO_RECORD] = radio_player.play
        players[topics.TRUTH] = WorldPlayer(original, walls).play
    report = Report(robots=chosen, foreign=foreign, bases=tuple(original.bases))
    audit = Audit(log)
    comparison = _Comparison(report, players, everything=parts and robots is None, torn=log.torn)
    try:
        ticks = audit.ticks()
        if log.torn and original.clock.is_realtime:
            ticks = _all_but_last(ticks)
        for number, tick in enumerate(ticks):
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


def _all_but_last(ticks: Iterator[LoggedTick]) -> Iterator[LoggedTick]:
    """The ticks of a torn log of real time: nothing tells whether all of the last one is there."""
    before: LoggedTick | None = None
    for tick in ticks:
        if before is not None:
            yield before
        before = tick


class _Comparison:
    """Lets the players speak to each tick, and compares what they say with what is recorded.

    players: by the channel in which each says its part of a tick, or the first of its channels.
    everything: whether they are all that speak in a mission.
    """

    def __init__(self, report: Report, players: dict[str, Player], everything: bool, torn: bool) -> None:
        self._report = report
        self._players = players
        self._everything = everything
        self._unheard = {topics.LATE, *map(topics.out, report.foreign), *map(topics.base, report.bases)}
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
                if key in self._players or (self._everything and key not in self._unheard):
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
        truth = value_in(Truth, tick, topics.TRUTH)
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
