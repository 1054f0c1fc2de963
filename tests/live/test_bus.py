"""Who may say and hear what: the router holds everyone to the table, on loopback too."""

import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from onehop.contracts import topics
from onehop.contracts.errors import MissionError
from onehop.drive.bus import Bus, make_credentials, open_client, open_router
from onehop.mission.processes import free_endpoint

pytestmark = pytest.mark.live

NAMES = ("radio", "recorder", "operator", "robot-1", "robot-2")


class House:
    """A router and one client for each identity, all in this process."""

    def __init__(self, stack: ExitStack) -> None:
        words = make_credentials(NAMES)
        self.endpoint = free_endpoint()
        self.world = stack.enter_context(open_router("m", self.endpoint, words))
        for key in ("out/*", "air", "recorded", "control"):
            self.world.subscribe(key)
        self.clients = {
            name: stack.enter_context(open_client("m", self.endpoint, name, words[name]))
            for name in NAMES
        }
        for name, keys in {
            "robot-1": ("percept/1",),
            "robot-2": ("percept/2", "percept/1", "out/1", "truth", "air"),
            "radio": ("truth", "out/1"),
            "recorder": ("record", "truth"),
        }.items():
            for key in keys:
                self.clients[name].subscribe(key)
        time.sleep(0.3)  # declarations travel by themselves; nothing announces that they have arrived


@pytest.fixture
def house() -> Iterator[House]:
    with ExitStack() as stack:
        yield House(stack)


def _heard(bus: Bus) -> list[tuple[str, bytes]]:
    messages = []
    while (received := bus.receive(0.2)) is not None:
        messages.append(received)
    return sorted(messages)


def test_everyone_is_heard_where_the_table_lets_them_speak(house: House) -> None:
    house.clients["robot-1"].publisher("out/1")(b"action")
    house.clients["radio"].publisher("air")(b"inboxes")
    house.clients["recorder"].publisher("recorded")(b"tick")
    house.clients["operator"].publisher("control")(b"stop")
    house.world.publisher("percept/1")(b"scan")
    house.world.publisher("truth")(b"poses")
    house.world.publisher("record")(b"messages")
    assert _heard(house.world) == [
        ("air", b"inboxes"),
        ("control", b"stop"),
        ("out/1", b"action"),
        ("recorded", b"tick"),
    ]
    assert _heard(house.clients["robot-1"]) == [("percept/1", b"scan")]
    assert _heard(house.clients["radio"]) == [("truth", b"poses")]
    assert _heard(house.clients["recorder"]) == [("record", b"messages")]


def test_a_robot_cannot_speak_for_another_or_around_the_radio(house: House) -> None:
    robot = house.clients["robot-2"]
    for key in ("out/1", "percept/1", "air", "truth", "control", "end", "recorded"):
        robot.publisher(key)(b"forged")
    assert _heard(house.world) == []
    assert _heard(house.clients["robot-1"]) == []
    assert _heard(house.clients["radio"]) == []


def test_a_robot_hears_nothing_that_is_not_for_it(house: House) -> None:
    house.world.publisher("percept/1")(b"scan")
    house.world.publisher("truth")(b"poses")
    house.clients["radio"].publisher("air")(b"inboxes")
    house.clients["robot-1"].publisher("out/1")(b"action")
    assert _heard(house.clients["robot-2"]) == []


def test_a_process_is_briefed_for_itself_only(house: House) -> None:
    house.world.answer("config/*", lambda key: key.encode())
    time.sleep(0.2)
    assert house.clients["robot-1"].ask(topics.config("robot-1"), 2.0) == b"config/robot-1"
    assert house.clients["robot-1"].ask(topics.config("robot-2"), 1.0) is None


def test_a_wrong_password_gets_nobody_in(house: House) -> None:
    with pytest.raises(MissionError, match="no bus at"):
        open_client("m", house.endpoint, "robot-1", "guess", timeout_ms=1000)
