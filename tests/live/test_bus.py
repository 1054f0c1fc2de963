"""Who may say and hear what: the router holds everyone to the table, on loopback too."""

import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest
import zenoh

from onehop.contracts import topics
from onehop.contracts.errors import MissionError
from onehop.mission.processes import free_endpoint
from onehop.node import bus, startup
from onehop.node.bus import ALIVE, GONE, open_client, open_router
from onehop.node.identity import make_credentials
from onehop.node.parts import PART_BYTES
from tests.live.listening import be_patient, heard, settle
from tests.live.mission import PATIENCE_S

pytestmark = pytest.mark.live

NAMES = ("radio", "recorder", "operator", "robot-1", "robot-2")


class Network:
    """A router and one client for each identity, all in this process."""

    def __init__(self, stack: ExitStack) -> None:
        words = make_credentials(NAMES)
        self.endpoint = free_endpoint()
        self.world = stack.enter_context(open_router("m", self.endpoint, words))
        self.clients = {
            name: stack.enter_context(open_client("m", self.endpoint, name, words[name]))
            for name in NAMES
        }
        settle(self.world, self.clients)


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Iterator[Network]:
    be_patient(monkeypatch)
    with ExitStack() as stack:
        yield Network(stack)


def test_everyone_is_heard_where_the_table_lets_them_speak(network: Network) -> None:
    for name in NAMES:
        network.clients[name].publisher(f"from/{name}/word")(name.encode())
        network.world.publisher(f"to/{name}/order")(name.encode())
    network.clients["recorder"].publisher("to/operator/digest")(b"sha")
    words = sorted((f"{name}/word", name.encode()) for name in NAMES)
    assert heard(network.world, len(NAMES)) == words
    for name in NAMES:
        expected = [("order", name.encode())]
        if name == "operator":
            expected.insert(0, ("digest", b"sha"))
        assert heard(network.clients[name], len(expected)) == expected


def test_a_robot_cannot_speak_for_another_or_around_the_radio(network: Network) -> None:
    robot = network.clients["robot-2"]
    for name in ("robot-1", "radio", "recorder", "operator", "world"):
        robot.publisher(f"from/{name}/word")(b"forged")
        robot.publisher(f"to/{name}/order")(b"forged")
    robot.publisher("truth")(b"forged")
    assert heard(network.world, 0) == []
    for name in ("robot-1", "radio", "recorder", "operator"):
        assert heard(network.clients[name], 0) == []


def test_the_radio_tells_robots_what_they_have_received_and_nothing_else(network: Network) -> None:
    radio = network.clients["radio"]
    for name in ("robot-1", "robot-2", "recorder", "operator"):
        for what in (topics.HEARD, topics.OBSERVATION, topics.PERCEPT, topics.KILL, topics.PART):
            radio.publisher(topics.to(name, what))(b"said by the radio")
    for name in ("robot-1", "robot-2"):
        assert heard(network.clients[name]) == [("heard", b"said by the radio")]
    for name in ("recorder", "operator"):
        assert heard(network.clients[name], 0) == []


def test_a_wait_ends_at_its_deadline_whatever_it_was_told_before(network: Network) -> None:
    """An earlier wait had set the alarm for a time that comes sooner than its own end, or later."""
    world = network.world
    for told_s, patience_s in ((0.3, 0.6), (PATIENCE_S, 0.02), (0.3, 0.4), (PATIENCE_S, 0.05)):
        world.tell_self("word")
        assert world.receive_by(time.monotonic() + told_s) == ("world/word", b"")
        deadline = time.monotonic() + patience_s
        assert world.receive_by(deadline) is None
        assert 0.0 <= time.monotonic() - deadline < PATIENCE_S / 2


def test_a_robot_hears_nothing_that_is_not_for_it(network: Network) -> None:
    spy = network.clients["robot-2"]._session
    keys = ("m/to/robot-1/**", "m/from/**", "m/to/radio/**", "m/**")
    ears = [spy.declare_subscriber(key, zenoh.handlers.FifoChannel(100)) for key in keys]
    time.sleep(0.3)
    network.world.publisher("to/robot-1/percept")(b"scan")
    network.world.publisher("to/radio/truth")(b"poses")
    network.clients["radio"].publisher("from/radio/carried")(b"inboxes")
    network.clients["robot-1"].publisher("from/robot-1/out")(b"action")
    assert len(heard(network.world, 2)) == 2
    assert [ear.try_recv() for ear in ears] == [None] * len(ears)


def test_liveliness_comes_with_the_messages(network: Network) -> None:
    network.world.watch("*")
    robot = network.clients["robot-1"]
    robot.announce("robot-1")
    assert heard(network.world) == [("world/alive/robot-1", ALIVE)]
    robot.__exit__(None, None, None)
    assert heard(network.world) == [("world/alive/robot-1", GONE)]


def test_a_process_is_briefed_for_itself_only(network: Network) -> None:
    with network.world.answering("config/*", lambda key: key.encode()):
        assert startup.briefing(network.clients["robot-1"], "robot-1") == b"config/robot-1"
        assert network.clients["robot-1"].ask(topics.config("robot-2"), 1.0) is None
    assert network.clients["robot-1"].ask(topics.config("robot-1"), 1.0) is None


def test_a_wrong_password_gets_nobody_in(network: Network) -> None:
    with pytest.raises(MissionError, match="no bus at"):
        open_client("m", network.endpoint, "robot-1", "guess", timeout_ms=1000)


@pytest.mark.parametrize("size", [0, 1, PART_BYTES, PART_BYTES + 1, 2 * PART_BYTES, 3_000_000])
@pytest.mark.parametrize("name", ["robot-1", "radio"])
def test_messages_of_any_length_come_and_go_over_a_link_of_low_latency(
    network: Network, name: str, size: int
) -> None:
    data = bytes(number % 251 for number in range(size))
    network.clients[name].publisher(f"from/{name}/out")(data)
    network.clients["robot-2"].publisher("from/robot-2/out")(b"short")
    network.world.publisher(f"to/{name}/percept")(data)
    network.world.publisher(f"to/{name}/kill")(b"")
    assert heard(network.world, 2) == [(f"{name}/out", data), ("robot-2/out", b"short")]
    assert heard(network.clients[name], 2) == [("kill", b""), ("percept", data)]


def test_the_recorders_link_carries_messages_of_any_length(network: Network) -> None:
    ticks = bytes(3_000_000)
    network.world.publisher("to/recorder/ticks")(ticks)
    assert heard(network.clients["recorder"]) == [("ticks", ticks)]


@pytest.mark.parametrize("name", ["robot-1", "radio", "recorder"])
@pytest.mark.parametrize("size", [0, PART_BYTES, PART_BYTES + 1, 3_000_000])
def test_a_briefing_may_have_any_length(network: Network, name: str, size: int) -> None:
    data = bytes(number % 251 for number in range(size))
    with network.world.answering("config/*", lambda _: data):
        assert startup.briefing(network.clients[name], name) == data


def test_no_thread_outlives_its_session(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Sessions close while others come and go."""
    raised: list[threading.ExceptHookArgs] = []
    monkeypatch.setattr(threading, "excepthook", raised.append)
    before = threading.enumerate()
    endpoint = free_endpoint()
    for _ in range(10):
        with open_router("m", endpoint) as world:
            world.watch("*")
            with world.answering("config/*", lambda key: key.encode()):
                for _ in range(5):
                    with open_client("m", endpoint, "robot-1", None) as robot:
                        robot.watch("*")
                        robot.announce("robot-1")
                        robot.ask(topics.config("robot-1"), 0.01)
                        robot.receive_by(time.monotonic() + 0.01)
                        robot.announce("robot-1")
            world.receive_by(time.monotonic() + 0.01)
    assert threading.enumerate() == before
    assert raised == []
    assert capfd.readouterr().err == ""


def test_after_its_end_a_session_tells_itself_nothing() -> None:
    """A signal handler that stops a process may run at any time, and cannot know."""
    with open_router("m", free_endpoint()) as world:
        world.tell_self("word")
        assert world.receive() == ("world/word", b"")
    world.tell_self("word")


def test_a_session_closes_though_nobody_has_made_room_for_its_messages(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(bus, "CHANNEL_MESSAGES", 3)
    with open_router("m", free_endpoint()) as world:
        world.receive_by(time.monotonic() + 0.01)
        for _ in range(3):
            world.tell_self("word")
        world._alarm.ring_by(0.0)  # and its thread waits for room
        time.sleep(0.1)
    assert "alarm" not in [thread.name for thread in threading.enumerate()]


SESSIONS = """
from resource import getpagesize
from pathlib import Path
from onehop.node.bus import open_client

def opened(times):
    for _ in range(times):
        with open_client("m", {endpoint!r}, "operator", {word!r}) as bus:
            bus.publisher("from/operator/word")(b"")
    return int(Path("/proc/self/statm").read_text().split()[1]) * getpagesize()

before = opened(50)
print(opened(150) - before)
"""


def test_a_session_that_is_closed_leaves_no_memory_behind() -> None:
    """A program may launch thousands of missions: a publisher left open would keep 13 kB of each."""
    word = make_credentials(["operator"])["operator"]
    with open_router("m", endpoint := free_endpoint(), {"operator": word}):
        script = SESSIONS.format(endpoint=endpoint, word=word)
        told = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    assert int(told.stdout) / 150 < 4096
