"""A peer that floods, or that does not read, loses its place; the others do not notice.

On loopback only; every peer is a child of its test and ends with it.
"""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
import zenoh

from onehop.contracts.errors import MissionError
from onehop.mission.operator import STOPPED
from onehop.mission.processes import free_endpoint
from onehop.node import startup
from onehop.node.bus import ALIVE, GONE, Bus, open_client, open_router
from onehop.node.identity import make_credentials, session_id
from tests.live.hostile import open_session
from tests.live.listening import await_message, heard, settle
from tests.live.mission import CREEPING, DEADLINE_S, Mission

pytestmark = pytest.mark.live

NAMES = ("robot-1", "robot-2")

SOON_S = 30.0
"""A second for the peer that loses its place, and what a busy machine takes: half of its lease."""


class House:
    """A router and one client, robot-1. The place of robot-2 is for a hostile peer."""

    def __init__(self, stack: ExitStack) -> None:
        self.words = make_credentials(NAMES)
        self.endpoint = free_endpoint()
        self.world = stack.enter_context(open_router("m", self.endpoint, self.words))
        self.honest = stack.enter_context(
            open_client("m", self.endpoint, "robot-1", self.words["robot-1"])
        )
        self._stack = stack
        settle(self.world, {"robot-1": self.honest})

    def hostile(self, name: str, queries: int = 0, own_id: str = "") -> "subprocess.Popen[str]":
        """A hostile peer that is connected, and has asked, and reads nothing any more."""
        arguments = (name, self.words[name], self.endpoint, "m", str(queries), own_id)
        return self._stack.enter_context(hostile(*arguments))

    def reaches_the_honest(self, within_s: float) -> bool:
        """Whether a message from the world comes to the honest robot in time."""
        self.world.publisher("to/robot-1/word")(b"")
        return _hears(self.honest, "word", within_s)


@contextmanager
def hostile(*arguments: str) -> Iterator["subprocess.Popen[str]"]:
    command = [sys.executable, "-m", "tests.live.hostile", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as peer:
        assert peer.stdout is not None
        try:
            peer.stdout.readline()
            peer.stdout.readline()
            yield peer
        finally:
            peer.kill()  # it is stopped, and would be waited for for ever


def _hears(bus: Bus, what: str, within_s: float) -> bool:
    deadline = time.monotonic() + within_s
    while (received := bus.receive_by(deadline)) is not None:
        if received[0] == what:
            return True
    return False


@pytest.fixture
def house() -> Iterator[House]:
    with ExitStack() as stack:
        yield House(stack)


def test_a_name_is_taken_once(house: House) -> None:
    word = house.words["robot-1"]
    with pytest.raises(MissionError, match="no bus at"):
        open_client("m", house.endpoint, "robot-1", word, timeout_ms=1000)
    house.honest.publisher("from/robot-1/word")(b"still here")
    assert heard(house.world) == [("robot-1/word", b"still here")]


def test_a_session_under_another_id_hears_nothing_and_is_turned_out(house: House) -> None:
    with open_session("robot-1", house.words["robot-1"], house.endpoint) as stranger:
        ear = stranger.declare_subscriber("m/to/robot-1/**", zenoh.handlers.FifoChannel(10))
        deadline = time.monotonic() + SOON_S
        while stranger.info.routers_zid():
            assert time.monotonic() < deadline
            time.sleep(0.01)
        assert house.reaches_the_honest(SOON_S)
        assert ear.try_recv() is None


def test_a_peer_that_reads_nothing_costs_the_others_a_second(house: House) -> None:
    house.world.watch("robot-2")
    house.hostile("robot-2", own_id=session_id(house.words["robot-2"]))
    assert _hears(house.world, "world/alive/robot-2", DEADLINE_S)
    flood = house.world.publisher("to/robot-2/word")
    started = time.monotonic()
    for _ in range(400):
        flood(bytes(40_000))  # 16 MB: more than the buffers of a connection hold
    assert house.reaches_the_honest(SOON_S)
    assert 0.5 < time.monotonic() - started < SOON_S


def test_a_peer_that_asks_without_end_keeps_nobody_from_being_answered(house: House) -> None:
    with house.world.answering("config/*", lambda _: bytes(2000)):
        house.hostile("robot-2", 8000, session_id(house.words["robot-2"]))
        started = time.monotonic()
        assert startup.briefing(house.honest, "robot-1") == bytes(2000)  # one query of it may be dropped
        assert time.monotonic() - started < SOON_S
    assert house.reaches_the_honest(SOON_S)


@pytest.mark.campaign
def test_hundreds_of_silent_connections_keep_nobody_out(house: House) -> None:
    host, port = house.endpoint.removeprefix("tcp/").split(":")
    with ExitStack() as stack:
        for _ in range(500):
            stack.enter_context(socket.create_connection((host, int(port)), timeout=SOON_S))
        started = time.monotonic()
        with open_client("m", house.endpoint, "robot-2", house.words["robot-2"], timeout_ms=10_000):
            assert time.monotonic() - started < SOON_S
        while time.monotonic() - started < 12.0:  # they are turned out after 10 s
            assert house.reaches_the_honest(1.5)
            time.sleep(0.05)


def test_who_is_shut_out_stays_out_until_it_is_let_in(house: House) -> None:
    """Its session comes back by itself, again and again, and is turned out each time."""
    token = "world/alive/robot-1"
    house.world.watch("*")
    house.honest.announce("robot-1")
    await_message(house.world, (token, ALIVE))
    house.world.shut_out("robot-1")
    await_message(house.world, (token, GONE))
    over = time.monotonic() + 2.0
    while (received := house.world.receive_by(over)) is not None:
        if received == (token, ALIVE):
            await_message(house.world, (token, GONE))
    house.world.let_in("robot-1")
    await_message(house.world, (token, ALIVE))


def _identity(pid: int) -> tuple[str, str, str]:
    """Password, endpoint and mission of a child, from its environment and command line."""
    environment = Path(f"/proc/{pid}/environ").read_text().split("\0")
    words = Path(f"/proc/{pid}/cmdline").read_text().split("\0")
    password = next(word for word in environment if word.startswith("ONEHOP_PASSWORD=")).partition("=")[
        2
    ]
    return password, words[words.index("--connect") + 1], words[words.index("--mission") + 1]


def test_a_mission_goes_on_whatever_a_second_session_of_a_robot_does(tmp_path: Path) -> None:
    """One that takes the place of a dead robot, too: it asks 20,000 times and reads nothing."""
    mission = Mission(tmp_path, *CREEPING)
    mission.await_ticks(20_000)
    pid = mission.children()["robot_agent 3"]
    password, endpoint, prefix = _identity(pid)
    with hostile("robot-3", password, endpoint, prefix, "8000"):
        os.kill(pid, signal.SIGKILL)
        with hostile("robot-3", password, endpoint, prefix, "20000", session_id(password)):
            mission.await_ticks(mission.log_bytes() + 400_000)
            summary = mission.stop()
    assert summary["reason"] == STOPPED
    assert {lost["robot"]: lost["why"] for lost in summary["lost"]}[3] == "its process died"
    assert all(lost["why"] != "silent for 10 s" for lost in summary["lost"])
