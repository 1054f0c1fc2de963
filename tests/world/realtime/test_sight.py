"""Who is gone, and who is only out of sight, since the router is a process of its own and has gone."""

from collections.abc import Callable
from typing import Any

import pytest

from onehop.node.bus import ALIVE, GONE
from world_server.roll_call import BLINK_S, RollCall


class Sight:
    """The roll call of a mission of robots 1 and 2. broken: why it is to be broken off. back: who came
    in sight again."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, **may: bool) -> None:
        self.now_s = 100.0
        monkeypatch.setattr("world_server.roll_call.time.monotonic", lambda: self.now_s)
        self.readers: dict[str, Callable[[bytes], None]] = {}
        self.broken: list[str] = []
        self.back: list[str] = []
        mail: Any = self
        self.roll = RollCall(mail, (1, 2), **may)
        self.roll.when_seen_again(self.back.append)
        self.come("world", "radio", "recorder", "robot-1", "robot-2")

    def read(self, _: str, what: str, reader: Callable[[bytes], None]) -> None:
        self.readers[what] = reader

    def break_off(self, reason: str, **_: float) -> None:
        self.broken.append(reason)

    def call_off(self, reason: str) -> None:
        if reason in self.broken:
            self.broken.remove(reason)

    def come(self, *names: str) -> None:
        for name in names:
            self.readers[f"alive/{name}"](ALIVE)

    def go(self, *names: str) -> None:
        for name in names:
            self.readers[f"alive/{name}"](GONE)

    def wait(self, seconds: float) -> None:
        self.now_s += seconds


EVERYONE = {"radio", "recorder", "robot-1", "robot-2"}


@pytest.fixture
def sight(monkeypatch: pytest.MonkeyPatch) -> Sight:
    return Sight(monkeypatch, router_may_go=True)


@pytest.mark.parametrize(
    "order", [("robot-1", "radio", "world", "recorder", "robot-2"), ("world", *sorted(EVERYONE))]
)
def test_when_the_router_goes_nobody_else_does(sight: Sight, order: tuple[str, ...]) -> None:
    sight.go(*order)
    assert not sight.roll.settle()
    sight.wait(5.0)
    assert not sight.roll.settle()
    assert (sight.roll.present, sight.broken) == (EVERYONE, [])
    sight.come("world", "recorder", "radio", "robot-2")
    assert not sight.roll.settle()
    sight.come("robot-1")
    assert sight.roll.settle()
    assert sight.back == ["recorder", "radio", "robot-2", "robot-1"]


def test_who_does_not_come_back_with_the_router_is_gone(sight: Sight) -> None:
    sight.go("robot-1", "robot-2", "radio", "recorder", "world")
    sight.come("world", "recorder", "radio", "robot-2")
    sight.roll.give_up()
    assert sight.roll.settle()
    assert sight.roll.present == EVERYONE - {"robot-1"}


def test_one_process_that_goes_is_gone_a_moment_later(sight: Sight) -> None:
    sight.go("radio")
    assert sight.roll.settle()
    assert "radio" in sight.roll.present
    sight.wait(1.1 * BLINK_S)
    assert sight.roll.settle()
    assert sight.roll.present == EVERYONE - {"radio"}
    assert sight.broken == ["the radio process is gone from the bus: killed, stopped or cut off"]
    sight.come("radio")
    assert (sight.broken, sight.back) == ([], [])


def test_when_the_mission_is_over_who_goes_is_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    sight = Sight(monkeypatch, radio_may_be_away=True, router_may_go=True)
    sight.go("robot-1", "world", "recorder")
    sight.roll.wait_for_nobody()
    assert sight.roll.present == {"radio", "robot-2"}
    sight.go("radio", "robot-2")
    assert sight.roll.present == set()


def test_where_the_world_is_the_router_it_is_gone_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    sight = Sight(monkeypatch)
    sight.go("robot-2")
    assert sight.roll.present == EVERYONE - {"robot-2"}


def test_a_radio_that_may_be_away_is_waited_for_until_it_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sight = Sight(monkeypatch, radio_may_be_away=True)
    for _ in range(2):
        sight.go("radio", "robot-2")
        assert (sight.roll.settle(), sight.broken) == (False, [])
        sight.come("radio", "robot-2")
        assert sight.roll.settle()
    sight.go("radio")
    sight.roll.give_up()
    assert sight.broken == ["the radio process is gone from the bus: killed, stopped or cut off"]
    assert sight.roll.present == EVERYONE - {"radio"}
