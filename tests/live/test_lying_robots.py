"""Robots whose processes lie: fenced at once, by name and with the reason; the mission goes on."""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import msgspec
import pytest

from onehop.contracts import topics
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import Action, Presence, Transmission, Truth
from onehop.contracts.team import Mode, Shape, Status
from onehop.mission.processes import free_endpoint
from onehop.node.bus import Bus, open_client, open_router
from onehop.node.identity import make_credentials
from onehop.wire.codec import encode
from onehop.wire.log_reader import digest
from tests.live.mission import Mission, proven
from world_server.mailbox import Mailbox
from world_server.remote_robots import Answers, RemoteRobots
from world_server.roll_call import RollCall

pytestmark = pytest.mark.live

NAME = "robot-1"
SILENCE_S = 30.0
"""How long a robot may take. No test here waits for it."""

AT_ONCE_S = 5.0
STATUS = Status(Mode.LEADING, 0, 1, (1,), Shape.SOLO, -1.0, 5e5, 1.0, 9.0, 9.0, 9.0)


def action(tick: int, incarnation: int) -> Action:
    return Action(tick, incarnation, Twist(0.0, 0.0), (), 0.0, 9.0, STATUS, ())


def truth(tick: int, incarnation: int) -> Truth:
    one = Presence(1, incarnation, Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0), False)
    return Truth(tick, tick, (one,), (), (), (), (), ())


class Place:
    """The world's side of a mission of one robot, and the session of the robot's process."""

    def __init__(self, stack: ExitStack) -> None:
        words, endpoint = make_credentials([NAME]), free_endpoint()
        self.world = stack.enter_context(open_router("m", endpoint, words))
        self.robot: Bus = stack.enter_context(open_client("m", endpoint, NAME, words[NAME]))
        mail = Mailbox(self.world)
        roll = RollCall(mail, [1])
        self.robots = RemoteRobots(self.world, mail, roll, (1,), SILENCE_S)
        self.put = self.robot.publisher(topics.by(NAME, topics.OUT))
        self.world.watch("*")
        self.robot.announce(NAME)
        roll.gather([NAME], SILENCE_S)

    def step(self, tick: int, incarnation: int = 0) -> Answers:
        """A tick that does not wait for the robot's silence: what it has put is there, or is enough."""
        started = time.monotonic()
        answers = self.robots.step(truth(tick, incarnation), {"obs/1": b"seen"}, {"rx/1": b"heard"})
        assert time.monotonic() - started < AT_ONCE_S
        return answers


@pytest.fixture
def place() -> Iterator[Place]:
    with ExitStack() as stack:
        yield Place(stack)


LIES: dict[str, tuple[Callable[[], bytes], str]] = {
    "another tick": (
        lambda: encode(action(6, 1)),
        "answered for tick 6 as incarnation 1 when asked for tick 5 as incarnation 1",
    ),
    "a tick that is over": (lambda: encode(action(4, 1)), "answered for tick 4 as incarnation 1"),
    "another incarnation": (lambda: encode(action(5, 2)), "answered for tick 5 as incarnation 2"),
    "an earlier incarnation, now": (
        lambda: encode(action(5, 0)),
        "answered for tick 5 as incarnation 0",
    ),
    "no number": (
        lambda: encode(msgspec.structs.replace(action(5, 1), speed=float("nan"))),
        "speed is nan, not a number from 0 to 1e+09",
    ),
    "too long a message": (
        lambda: encode(
            msgspec.structs.replace(action(5, 1), outbox=(Transmission(0, bytes(60_000), 60_000, 0),))
        ),
        "a message of 60000 bytes on the air",
    ),
    "too many bytes": (
        lambda: bytes(1_000_000),
        "put no action: 1000000 bytes, and an action has at most",
    ),
    "nothing": (lambda: b"", "put no action: Action: not msgpack"),
    "an escape": (lambda: b"\x81\xa4\x1b[2J\x01", "put no action: Action: no schema version"),
}


@pytest.mark.parametrize("lie", LIES)
def test_a_wrong_answer_is_fenced_at_once(place: Place, lie: str) -> None:
    said, why = LIES[lie]
    place.put(said())
    answers = place.step(5, incarnation=1)
    assert answers.fenced[1].startswith(why)
    assert answers.fenced[1].isprintable()
    assert (answers.actions, answers.wire) == ({}, [])


def test_the_last_word_of_an_earlier_process_is_ignored(place: Place) -> None:
    late, right = encode(action(4, 0)), encode(action(5, 1))
    place.put(late)
    place.put(right)
    answers = place.step(5, incarnation=1)
    assert answers.wire == [("out/1", right)]
    assert answers.fenced == {}


def test_who_speaks_without_being_asked_is_fenced(place: Place) -> None:
    place.robot.publisher(topics.by(NAME, "song"))(b"la")
    place.put(encode(action(5, 0)))
    answers = place.step(5)
    assert answers.fenced == {1: "spoke without being asked"}
    assert (answers.actions, answers.wire) == ({}, [])


def test_a_second_answer_is_one_too_many(place: Place) -> None:
    for _ in range(2):
        place.put(encode(action(5, 0)))
    assert place.step(5).fenced == {}
    assert len(place.step(6).fenced) == 1


LIAR = """
import sys

words = sys.orig_argv
if "robot_agent" in words and words[words.index("--id") + 1] == "3":
    from onehop.contracts.messages import Action
    from onehop.programs import host

    honest = host.encode

    def lie(action):
        data = honest(action)
        return data if action.tick < 20 else {lie}

    host.encode = lie
"""


def test_a_mission_with_a_liar_goes_on_without_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its process is ours with one function changed: Python runs sitecustomize before everything."""
    lie = "data.replace(honest(action.twist), honest(type(action.twist)(float('nan'), 0.0)))"
    (tmp_path / "sitecustomize.py").write_text(LIAR.format(lie=lie))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    summary = Mission(tmp_path, "clock.limit_s=10").finish()
    log = proven(tmp_path / "out" / "mission.mcap")
    lost = {one["robot"]: (one["at_s"], one["why"]) for one in summary["lost"]}
    assert lost[3] == (1.05, "twist.v is nan, not a number from -1e+09 to 1e+09")
    assert {why for _, why in lost.values()} == {lost[3][1], "did not arrive"}
    assert summary["ticks"] == 200
    assert digest(log) == summary["digest"]
