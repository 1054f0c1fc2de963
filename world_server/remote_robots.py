"""The robots as the world calls them: a percept to each that is present, an action back from each."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial

from onehop.contracts import topics
from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Action, Presence, Truth, running
from onehop.node.bus import Bus
from onehop.wire.batch import pack_tick
from onehop.wire.journal import WireMessage
from onehop.wire.spoken import action_in, failed
from world_server.mailbox import Mailbox, MissionBrokenError
from world_server.roll_call import RollCall


@dataclass(slots=True)
class Answers:
    """What the robots gave for one tick, each by id in ascending order.

    actions: of those who gave one. wire: the same as the bytes that arrived. fenced: why the others gave
    none, and are to be left out from the next tick on.
    """

    actions: dict[int, Action] = field(default_factory=dict)
    wire: list[WireMessage] = field(default_factory=list)
    fenced: dict[int, str] = field(default_factory=dict)


class RemoteRobots:
    """The robot processes. silence_s: how long they may take for a tick [s], on the wall clock."""

    def __init__(
        self, bus: Bus, mail: Mailbox, roll: RollCall, robots: tuple[int, ...], silence_s: float
    ) -> None:
        self._limits = ActionLimits(robots)
        self._mail = mail
        self._roll = roll
        self._silence_s = silence_s
        self._put = {i: bus.publisher(topics.to(topics.robot_name(i), topics.PERCEPT)) for i in robots}
        self._tick = 0
        self._awaited: dict[str, int] = {}
        self._given: dict[int, tuple[Action, bytes]] = {}
        self._refused: dict[int, str] = {}
        self._incarnations: dict[int, int] = {}
        self._unasked: dict[int, int] = {}
        self._shut_out = bus.shut_out
        self._robots = {topics.robot_name(i): i for i in robots}
        for name, i in self._robots.items():
            mail.read(name, topics.OUT, partial(self._on_action, i))
            mail.read(name, topics.FAILED, partial(self._on_failure, i))
        mail.read_stray(self._on_stray)

    def step(
        self, truth: Truth, observations: Mapping[str, bytes], inboxes: Mapping[str, bytes]
    ) -> Answers:
        """Let every robot that runs take its step, and wait for all of them.

        observations, inboxes: wire messages of this tick by log channel. Raises MissionBrokenError.
        """
        self._tick, runners = truth.tick, running(truth)
        self._incarnations = {one.robot: one.incarnation for one in truth.present}
        self._awaited = {topics.robot_name(one.robot): one.incarnation for one in runners}
        self._given.clear()
        self._refused.clear()
        for one in runners:
            seen, heard = topics.obs(one.robot), topics.rx(one.robot)
            if heard not in inboxes:
                raise MissionBrokenError(f"the radio carried no inbox for robot {one.robot}")
            percept = [(seen, observations[seen]), (heard, inboxes[heard])]
            self._put[one.robot](pack_tick(truth.tick, percept))
        present, awaited = self._roll.present, self._awaited.keys()
        self._mail.wait(lambda: awaited.isdisjoint(present), self._silence_s)
        self._awaited.clear()
        return self._answers(runners)

    def _answers(self, asked: Iterable[Presence]) -> Answers:
        answers = Answers()
        for one in asked:
            i = one.robot
            if self._unasked.pop(i, None) == one.incarnation:
                self._given.pop(i, None)
                answers.fenced[i] = "spoke without being asked"
            elif i in self._given:
                answers.actions[i], data = self._given[i]
                answers.wire.append((topics.out(i), data))
            elif i in self._refused:
                answers.fenced[i] = self._refused[i]
            elif topics.robot_name(i) in self._roll.present:
                answers.fenced[i] = f"silent for {self._silence_s:g} s"
            else:
                answers.fenced[i] = "its process died"
        return answers

    def _on_action(self, robot: int, data: bytes) -> None:
        name = topics.robot_name(robot)
        incarnation = self._awaited.get(name)
        if incarnation is None:
            self._on_unasked(robot)
            return
        try:
            action = action_in(data, self._limits)
        except DecodeError as error:
            self._refuse(robot, str(error))
        else:
            if action.incarnation < incarnation and action.tick < self._tick:
                return  # the last word of the process that was here before
            wrong = self._limits.breach(action, self._tick, incarnation)
            if wrong is None:
                self._given[robot] = action, data
            else:
                self._refuse(robot, wrong)
        del self._awaited[name]

    def _on_failure(self, robot: int, reason: bytes) -> None:
        """A robot says that its program has failed, in place of an action."""
        if self._awaited.pop(topics.robot_name(robot), None) is None:
            self._on_unasked(robot)
        else:
            self._refuse(robot, failed(reason.decode(errors="replace")))

    def _refuse(self, robot: int, why: str) -> None:
        """Take nothing more from a robot: what it says next could be a flood."""
        self._refused[robot] = why
        self._shut_out(topics.robot_name(robot))

    def _on_unasked(self, robot: int) -> None:
        """A robot that takes part says something that it was not asked for."""
        if robot in self._incarnations:
            self._unasked[robot] = self._incarnations[robot]
            self._shut_out(topics.robot_name(robot))

    def _on_stray(self, name: str) -> None:
        if name in self._robots:
            self._on_unasked(self._robots[name])
