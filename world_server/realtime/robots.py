"""The robot processes in real time: each is told the newest observation, and answers when it can.

A robot that has not answered yet is asked nothing new, so it answers at most once in a tick, and is
never behind by more than the step that it is at. What it hands to its NIC goes to the radio at once; the
rest of its answer counts when the tick ends.
"""

import time
from collections import deque
from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass, field
from functools import partial

from onehop.contracts import topics
from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Action, TransmitRequest, Truth, running
from onehop.contracts.realtime import Acted
from onehop.node.bus import Bus
from onehop.wire.codec import decode
from onehop.wire.spoken import action_in, failed
from world_server.mailbox import Mailbox
from world_server.roll_call import RollCall

ASK_AGAIN_S = 0.5
"""How long after a question without an answer a robot is asked again [s]: either may have been lost."""

MOST_HEARD = 10_000
"""What a robot may have taken in from the radio for one answer: more than a NIC gets in 10 s."""

UNASKED = "spoke without being asked"


@dataclass(slots=True)
class Given:
    """An answer. data: the action as it came. heard: what of the radio's messages went into it.

    number: of this answer of its process.
    """

    number: int
    action: Action
    data: bytes
    heard: tuple[int, ...]
    is_handed_over: bool = False


@dataclass(slots=True)
class Answers:
    """What counts at the end of a tick, by robot. fenced: who is to leave, and why.

    unanswered: how many robots that run gave nothing for it.
    """

    given: dict[int, Given] = field(default_factory=dict)
    fenced: dict[int, str] = field(default_factory=dict)
    unanswered: int = 0

    @property
    def actions(self) -> dict[int, Action]:
        return {robot: one.action for robot, one in self.given.items()}


@dataclass(slots=True)
class _Robot:
    """What the world knows of one. asked: ticks of questions without an answer, and when they were put.

    is_prompt: what it hands to its NIC is in the air at once; not so of a slow one. answers: so far.
    """

    id: int
    put: Callable[[bytes], None]
    incarnation: int = -1
    runs: bool = False
    is_prompt: bool = True
    asked: dict[int, float] = field(default_factory=dict)
    given: deque[Given] = field(default_factory=deque)
    refused: str | None = None
    answers: int = 0

    def begin(self, incarnation: int) -> None:
        """Another process is there, or nobody any more."""
        self.incarnation, self.runs, self.refused = incarnation, False, None
        self.asked, self.given, self.answers = {}, deque(), 0

    def ask_anew(self, now_s: float) -> None:
        """The time since it was asked does not count."""
        self.asked = dict.fromkeys(self.asked, now_s)


class RealTimeRobots:
    """All of them. silence_s: how long one may say nothing [s]. hand_over: tells the radio."""

    def __init__(
        self,
        bus: Bus,
        mail: Mailbox,
        roll: RollCall,
        robots: tuple[int, ...],
        silence_s: float,
        hand_over: Callable[[TransmitRequest], None],
    ) -> None:
        self._limits = ActionLimits(robots)
        self._roll = roll
        self._silence_s = silence_s
        self._hand_over = hand_over
        self._shut_out = bus.shut_out
        self._slow: Set[int] = frozenset()
        self._robots: dict[int, _Robot] = {}
        self._ids = {topics.robot_name(i): i for i in robots}
        self._put_wake: dict[str, Callable[[bytes], None]] = {}
        for name, i in self._ids.items():
            put = bus.publisher(topics.to(name, topics.OBSERVATION), may_drop=True)
            self._robots[i] = _Robot(i, put)
            mail.read(name, topics.ACTED, partial(self._on_acted, i))
            mail.read(name, topics.FAILED, partial(self._on_failure, i))
            self._put_wake[name] = bus.publisher(topics.to(name, topics.WAKE))
        mail.read_stray(self._on_stray)
        roll.when_seen_again(self._on_reunion)

    def close(self, truth: Truth, starting: Set[int]) -> Answers:
        """What robots have given for the tick that ends. starting: whose process is yet to come."""
        answers = Answers()
        now_s = time.monotonic()
        for one in running(truth):
            i, robot = one.robot, self._robots[one.robot]
            if robot.given:
                answers.given[i] = robot.given.popleft()
            elif robot.refused is not None:
                answers.fenced[i] = robot.refused
            elif i in starting:
                answers.unanswered += 1
            elif topics.robot_name(i) not in self._roll.present:
                answers.fenced[i] = "its process died"
            elif robot.asked and now_s - min(robot.asked.values()) > self._silence_s:
                answers.fenced[i] = f"silent for {self._silence_s:g} s"
            else:
                answers.unanswered += 1
        return answers

    def ask(self, truth: Truth, observations: Mapping[int, bytes]) -> None:
        """Tell each robot that runs, and has answered, what it sees in the tick that begins."""
        now_s = time.monotonic()
        slow = {one.robot for one in truth.slow}
        late, self._slow = slow | self._slow, slow  # who was slow may still have something to say
        incarnations = {one.robot: one.incarnation for one in truth.present}
        for i, robot in self._robots.items():
            incarnation = incarnations.get(i, -1)
            if incarnation != robot.incarnation:
                robot.begin(incarnation)
            if i in observations and not robot.runs:  # time in which it was stopped does not count
                robot.ask_anew(now_s)
            robot.runs, robot.is_prompt = i in observations, i not in late
            if robot.given:
                self._pass_on(robot)
            elif robot.runs and topics.robot_name(i) in self._roll.present:
                self._ask(robot, truth.tick, now_s, observations[i])

    def excuse(self) -> None:
        """Nobody could be heard: the patience with each begins anew."""
        now_s = time.monotonic()
        for robot in self._robots.values():
            robot.ask_anew(now_s)

    def _on_reunion(self, name: str) -> None:
        """Tell a robot that was out of sight, and is still in the mission, to go on as it is."""
        if name in self._ids and self._robots[self._ids[name]].incarnation >= 0:
            self._put_wake[name](b"")

    @staticmethod
    def _ask(robot: _Robot, tick: int, now_s: float, observation: bytes) -> None:
        if not robot.asked or now_s - max(robot.asked.values()) >= ASK_AGAIN_S:
            robot.asked[tick] = now_s
            robot.put(observation)

    def refuse(self, i: int, why: str) -> None:
        """Take nothing more from a robot; it leaves with the next tick."""
        robot = self._robots[i]
        if robot.incarnation >= 0 and robot.refused is None:
            robot.refused = why
            self._shut_out(topics.robot_name(i))

    def _pass_on(self, robot: _Robot) -> None:
        """Hand over to the radio what counts at the end of this tick."""
        given = robot.given[0]
        if robot.runs and robot.is_prompt and not given.is_handed_over and given.action.outbox:
            given.is_handed_over = True
            action = given.action
            self._hand_over(
                TransmitRequest(robot.id, action.speed, action.remaining_distance, action.outbox)
            )

    def _on_acted(self, i: int, data: bytes) -> None:
        robot = self._robots[i]
        if robot.incarnation < 0 or robot.refused is not None:
            return
        try:
            given = self._answer_in(data)
        except DecodeError as error:
            self.refuse(i, str(error))
            return
        action = given.action
        if action.incarnation < robot.incarnation:
            return  # the last word of the process that was here before
        if given.number <= robot.answers:
            return  # said again by one that was out of sight
        wrong = self._limits.breach(action, action.tick, robot.incarnation)
        if wrong is None and action.tick not in robot.asked:
            wrong = UNASKED
        if wrong is None and given.number != robot.answers + 1:
            wrong = f"its answer {robot.answers + 1} was lost on its way"
        if wrong is not None:
            self.refuse(i, wrong)
            return
        robot.answers = given.number
        robot.asked = {tick: at_s for tick, at_s in robot.asked.items() if tick > action.tick}
        robot.given.append(given)
        self._pass_on(robot)

    def _answer_in(self, data: bytes) -> Given:
        """Raises DecodeError for what is no answer."""
        if len(data) > self._limits.action_bytes + 9 * MOST_HEARD:
            raise DecodeError(f"put no answer: {len(data)} bytes")
        try:
            acted = decode(Acted, data)
        except DecodeError as error:
            raise DecodeError(f"put no answer: {error}") from None
        if len(acted.heard) > MOST_HEARD:
            raise DecodeError(f"put no answer: names {len(acted.heard)} receptions")
        action = action_in(acted.action, self._limits)
        return Given(acted.number, action, acted.action, acted.heard)

    def _on_failure(self, i: int, reason: bytes) -> None:
        """A robot says that its program has failed, in place of an action."""
        self.refuse(i, failed(reason.decode(errors="replace")))

    def _on_stray(self, name: str) -> None:
        if name in self._ids:
            self.refuse(self._ids[name], UNASKED)
