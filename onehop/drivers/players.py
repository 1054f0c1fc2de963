"""The parts of a mission that a re-execution plays, each fed with what its log has for it.

In lock-step a tick of a log is all that a part needs for it. In real time a robot may have answered an
observation of an earlier tick, and what it heard is made of messages that the radio says again here; the
radio is told at which instants truths and messages came (`Intake`).
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Protocol

from onehop.contracts import topics
from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.briefings import Briefing, robot_briefing
from onehop.contracts.errors import DecodeError
from onehop.contracts.hardware import Taken
from onehop.contracts.messages import (
    Action,
    Inbox,
    Observation,
    Percept,
    RadioRecord,
    TransmitRequest,
    Truth,
    percept,
)
from onehop.contracts.realtime import Heard
from onehop.contracts.scenario import Scenario
from onehop.maps.walls import WallMap
from onehop.programs.host import Host, ProgramError
from onehop.wire.codec import decode, encode
from onehop.wire.heard import inbox_of
from onehop.wire.log_reader import LoggedTick
from onehop.wire.logged import M, value_of
from onehop.wire.selection import Selected
from radio_proxy.core.bounds import Carrier
from radio_proxy.core.continuous import ContinuousRadio, Due
from world_server.core.command_hold import CommandHold
from world_server.core.world import World

Player = Callable[[LoggedTick], Iterator[tuple[str, bytes]]]
"""Takes the recorded messages of a tick, gives (bus key, bytes) of what a component says to them."""


def value_in(kind: type[M], tick: LoggedTick, key: str, in_lock_step: bool = False) -> M | None:
    """The value of a message of a tick, None when there is none. Raises DecodeError."""
    data = tick.get(key)
    return None if data is None else value_of(kind, Selected(tick.tick, key, data), in_lock_step)


class Stepping(Protocol):
    """What is asked for the bytes of an action, as a Host is; may raise ProgramError."""

    def step(self, percept: Percept) -> bytes: ...


class RobotPlayer:
    """One robot in every incarnation. make_host: of one incarnation."""

    def __init__(
        self, scenario: Scenario, robot: int, make_host: Callable[[Briefing], Stepping] = Host
    ) -> None:
        self._scenario = scenario
        self._make_host = make_host
        self._in_lock_step = not scenario.clock.is_realtime
        self._id = robot
        self._incarnation = -1
        self._host: Stepping | None = None
        self._seen: dict[int, Observation] = {}

    def play(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        i = self._id
        observation = value_in(Observation, tick, topics.obs(i))
        inbox = value_in(Inbox, tick, topics.rx(i), self._in_lock_step)
        if observation is None:
            return
        if self._host is None or self._incarnation != observation.incarnation:
            self._incarnation = observation.incarnation
            self._host = self._make_host(robot_briefing(self._scenario, i, self._incarnation))
            self._seen = {}
        self._seen[tick.tick] = observation
        if inbox is None or inbox.tick not in self._seen:
            return
        answered = self._seen[inbox.tick]
        self._seen = {number: seen for number, seen in self._seen.items() if number > inbox.tick}
        try:
            said = self._host.step(percept(answered, inbox))
        except ProgramError:  # nothing more is heard of it, as in the mission
            return
        yield topics.out(i), said


class RadioPlayer:
    """The radio in lock-step."""

    def __init__(self, radio: Carrier) -> None:
        self._radio = radio

    def play(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        truth = value_in(Truth, tick, topics.TRUTH)
        if truth is None:
            return
        carried = self._radio.carry(truth)
        yield topics.RADIO_RECORD, encode(carried.record)
        for i, inbox in carried.inboxes.items():
            yield topics.rx(i), encode(inbox)


class RealTimeRadioPlayer:
    """The radio in real time: truths and messages come at the instants that its records tell."""

    def __init__(self, radio: Carrier) -> None:
        self._radio = ContinuousRadio(radio)
        self._heard: dict[int, dict[int, Heard]] = {}

    def play(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        truth = value_in(Truth, tick, topics.TRUTH)
        recorded = value_in(RadioRecord, tick, topics.RADIO_RECORD)
        if truth is None or recorded is None or recorded.intake is None:
            return
        intake = recorded.intake
        self._take(self._radio.place(truth, intake.placed_ns))
        for one in intake.handed:
            action = value_in(Action, tick, topics.out(one.robot))
            if action is not None:
                distance, outbox = action.remaining_distance, action.outbox
                request = TransmitRequest(one.robot, action.speed, distance, outbox)
                self._take(self._radio.hand_over(request, one.at_ns))
        due, record = self._radio.close(intake.until_ns)
        self._take(due)
        assert record is not None, "a truth has been placed"
        yield topics.RADIO_RECORD, encode(record)
        yield from self._inboxes(tick)

    def _take(self, due: Due) -> None:
        for robot, heard in due:
            self._heard.setdefault(robot, {})[heard.number] = heard

    def _inboxes(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        """What robots took in, said again."""
        for key, _ in tick.messages:
            stem, _, robot = key.partition("/")
            if stem != "rx" or (inbox := value_in(Inbox, tick, key)) is None:
                continue
            mine = self._heard.get(int(robot), {})
            named = [mine[number] for number in inbox.heard if number in mine]
            last = max(inbox.heard, default=0)
            self._heard[int(robot)] = {number: one for number, one in mine.items() if number > last}
            yield key, encode(inbox_of(inbox.tick, inbox.time_ns, named))


class WorldPlayer:
    """The world, with the deaths and faults that no script foresaw taken from the recorded truth.

    What real bases have measured is in the log as it went in.
    """

    def __init__(self, scenario: Scenario, walls: WallMap) -> None:
        self._world = World(scenario, walls)
        self._limits = ActionLimits(scenario.team.robots)
        self._hold = CommandHold(scenario)
        self._in_lock_step = not scenario.clock.is_realtime
        self._actions: Mapping[int, Action] | None = None

    def play(self, tick: LoggedTick) -> Iterator[tuple[str, bytes]]:
        truth = value_in(Truth, tick, topics.TRUTH)
        if truth is None:
            return
        world = self._world
        taken = {i: value_in(Taken, tick, topics.base(i)) for i in world.bases}
        measured = {i: one.measured for i, one in taken.items() if one is not None}
        if self._actions is None:
            world.place(measured)
        else:
            world.advance(self._actions, truth.faults, measured)
        present = {presence.robot for presence in truth.present}
        for departure in truth.departures:
            if departure.robot not in present:
                world.fence(departure.robot, departure.why)
        yield topics.TRUTH, encode(world.truth())
        for i, observation in world.observe().items():
            yield topics.obs(i), encode(observation)
        self._actions = self._hold.filled(truth, self._said(tick))

    def _said(self, tick: LoggedTick) -> dict[int, Action]:
        """The actions of a tick that the world can have taken."""
        actions: dict[int, Action] = {}
        for key, action in tick.messages:
            stem, _, robot = key.partition("/")
            if stem == "out":
                try:
                    said = decode(Action, action)
                except DecodeError:
                    continue
                asked = tick.tick if self._in_lock_step else said.tick
                if self._limits.breach(said, asked, said.incarnation) is None:
                    actions[int(robot)] = said
        return actions
