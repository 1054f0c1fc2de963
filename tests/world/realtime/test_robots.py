"""Questions and answers in real time: who is asked when, what counts, and who is turned out."""

from collections.abc import Callable
from typing import Any

import pytest

from onehop.contracts import topics
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import (
    BROADCAST,
    Action,
    Presence,
    Slow,
    Transmission,
    TransmitRequest,
    Truth,
)
from onehop.contracts.realtime import Acted
from onehop.wire.codec import encode
from world_server.realtime.robots import RealTimeRobots


class Team:
    """Robots 1 and 2, and everyone they deal with. shut_out: whose sessions have been ended."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.handed: list[TransmitRequest] = []
        self.shut: list[str] = []
        self.woken: list[str] = []
        self.readers: dict[str, Callable[[bytes], None]] = {}
        self.present = {"robot-1", "robot-2"}
        self.stray: Callable[[str], None] = lambda _: None
        self.see_again: Callable[[str], None] = lambda _: None
        world: Any = self
        self.robots = RealTimeRobots(world, world, world, (1, 2), 10.0, self.handed.append)

    def publisher(self, key: str, **_: Any) -> Callable[[bytes], None]:
        if key.endswith("/wake"):
            return lambda _: self.woken.append(key.split("/")[1])
        return lambda data: self.asked.append(f"{key.split('/')[1]} {data.decode()}")

    def read(self, name: str, what: str, reader: Callable[[bytes], None]) -> None:
        self.readers[topics.by(name, what)] = reader

    def read_stray(self, reader: Callable[[str], None]) -> None:
        self.stray = reader

    def when_seen_again(self, act: Callable[[str], None]) -> None:
        self.see_again = act

    def shut_out(self, name: str) -> None:
        self.shut.append(name)

    def begin(self, tick: int, **keys: Any) -> Truth:
        """A tick begins: its truth; questions are the number of the tick."""
        now = truth(tick, **keys)
        running = [one.robot for one in now.present if one.robot not in now.stopped]
        self.robots.ask(now, dict.fromkeys(running, b"%d" % tick))
        return now

    def answer(self, robot: int, tick: int, number: int = 1, **keys: Any) -> None:
        action = Action(tick, 0, Twist(0.1, 0.0), (SENT,), 0.1, 5.0, None, ())
        said = Acted(number, (), encode(action))
        self.readers[f"from/robot-{robot}/acted"](keys.get("data", encode(said)))

    def end(self, now: Truth) -> tuple[dict[int, int], dict[int, str]]:
        """A tick ends: which observations were answered, and who is to leave."""
        answers = self.robots.close(now, frozenset())
        return {robot: one.tick for robot, one in answers.actions.items()}, answers.fenced


SENT = Transmission(BROADCAST, b"hi", 2, 0)


def truth(tick: int, robots: tuple[int, ...] = (1, 2), **keys: Any) -> Truth:
    present = tuple(Presence(i, 0, Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0), False) for i in robots)
    return Truth(tick, tick * 50_000_000, present, (), (), (), (), (), **keys)


@pytest.fixture
def team() -> Team:
    return Team()


def test_a_robot_is_asked_again_when_it_has_answered(team: Team) -> None:
    first = team.begin(0)
    team.answer(1, 0)
    assert team.end(first) == ({1: 0}, {})
    second = team.begin(1)
    assert team.asked == ["robot-1 0", "robot-2 0", "robot-1 1"]
    team.answer(2, 0)
    assert team.end(second) == ({2: 0}, {})
    team.begin(2)
    assert team.asked[3:] == ["robot-2 2"]  # and robot 1 owes the answer of tick 1


def test_what_it_hands_over_is_in_the_air_at_once(team: Team) -> None:
    now = team.begin(0)
    team.answer(1, 0)
    assert [(one.robot, one.outbox) for one in team.handed] == [(1, (SENT,))]
    team.end(now)
    team.begin(1)
    assert len(team.handed) == 1


@pytest.mark.parametrize("slow_from", [0, -1])
def test_what_a_slow_robot_hands_over_waits_for_its_action(team: Team, slow_from: int) -> None:
    if slow_from < 0:
        team.end(team.begin(0, slow=(Slow(1, 3),)))
        team.begin(1)
    else:
        team.begin(0, slow=(Slow(1, 3),))
    team.answer(1, 0)
    assert team.handed == []


def test_what_comes_from_a_robot_that_is_stopped_counts_when_it_goes_on(team: Team) -> None:
    team.end(team.begin(0))
    stopped = team.begin(1, stopped=(1,))
    team.answer(1, 0)
    assert (team.end(stopped), team.handed) == (({}, {}), [])
    going = team.begin(2)
    assert [one.robot for one in team.handed] == [1]
    assert team.end(going) == ({1: 0}, {})


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ({"tick": 1}, "spoke without being asked"),
        ({"tick": 0, "number": 2}, "its answer 1 was lost on its way"),
        ({"tick": 0, "data": b"no"}, "put no answer: Acted: not msgpack"),
        ({"tick": 0, "data": encode(Acted(1, (), b"no"))}, "put no action: Action: not msgpack"),
        ({"tick": 0, "data": encode(Acted(1, (1,) * 10_001, b""))}, "put no answer: names 10001"),
        ({"tick": 0, "data": bytes(10**7)}, "put no answer: 10000000 bytes"),
    ],
)
def test_who_says_what_is_no_answer_leaves(team: Team, said: dict[str, Any], why: str) -> None:
    now = team.begin(0)
    team.answer(1, **said)
    actions, fenced = team.end(now)
    assert actions == {}
    assert fenced[1].startswith(why)
    assert team.shut == ["robot-1"]


def test_an_answer_counts_once(team: Team) -> None:
    now = team.begin(0)
    team.answer(1, 0)
    team.answer(1, 0, number=2)
    assert team.end(now) == ({1: 0}, {})
    assert team.end(team.begin(1)) == ({}, {1: "spoke without being asked"})


def test_who_is_gone_leaves_and_who_is_yet_to_come_does_not(team: Team) -> None:
    now = team.begin(0)
    team.present.clear()
    answers = team.robots.close(now, {2})
    assert answers.fenced == {1: "its process died"}
    assert answers.unanswered == 1


def test_a_word_that_nobody_reads_costs_its_robot_its_place(team: Team) -> None:
    now = team.begin(0)
    team.stray("robot-2")
    assert team.end(now)[1] == {2: "spoke without being asked"}


def test_the_last_word_of_a_process_that_was_here_before_is_ignored(team: Team) -> None:
    team.begin(0)
    present = (Presence(1, 1, Pose(0.0, 0.0, 0.0), Twist(0.0, 0.0), False),)
    again = Truth(1, 50_000_000, present, (), (), (), (), ())
    team.robots.ask(again, {1: b"1"})
    team.answer(1, 0)
    assert team.end(again) == ({}, {})


def test_who_is_seen_again_is_told_to_go_on_if_it_is_still_in_the_mission(team: Team) -> None:
    team.begin(0)
    team.begin(1, robots=(1,))
    team.see_again("robot-1")
    team.see_again("robot-2")
    team.see_again("radio")
    assert team.woken == ["robot-1"]


def test_an_answer_that_is_said_again_counts_once(team: Team) -> None:
    first = team.begin(0)
    team.answer(1, 0)
    team.answer(1, 0)
    assert team.end(first) == ({1: 0}, {})
    second = team.begin(1)
    team.answer(1, 0)
    assert team.end(second) == ({}, {})
    assert not team.shut
    assert len(team.handed) == 1


def test_time_in_which_nobody_could_be_heard_does_not_count_as_silence(
    team: Team, monkeypatch: pytest.MonkeyPatch
) -> None:
    now_s = [100.0]
    monkeypatch.setattr("world_server.realtime.robots.time.monotonic", lambda: now_s[0])
    now = team.begin(0)
    now_s[0] += 15.0  # for longer than the patience with a robot
    team.robots.excuse()
    assert team.end(now) == ({}, {})
    now_s[0] += 15.0
    assert team.end(now)[1] == {1: "silent for 10 s", 2: "silent for 10 s"}
