"""Who comes with a certificate may do what its name may, once; who has none, or a wrong one, nothing.

On loopback only. What is the same with passwords is in test_bus.py and test_hostile_peers.py.
"""

import contextlib
import dataclasses
import datetime
import shutil
import socket
import threading
import time
from argparse import Namespace
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import zenoh

from onehop.contracts import topics
from onehop.contracts.errors import MissionError
from onehop.mission import authority
from onehop.node import startup
from onehop.node.bus import ALIVE, GONE, Bus, open_certified_router, open_client
from onehop.node.identity import session_id
from onehop.node.parts import PART_BYTES
from onehop.node.reachability import why_not
from tests.live.hosts import made_keys, stranger, tls_endpoint
from tests.live.listening import await_message, be_patient, heard, settle
from tests.live.mission import PATIENCE_S

pytestmark = pytest.mark.live

TEAM = (1, 2)

PATIENCE_MS = int(1000 * PATIENCE_S)


class House:
    """A router, the radio and robot-1; everyone has a certificate, and robot-2 has not come."""

    def __init__(self, stack: ExitStack, keys: Path) -> None:
        self.keys, self.endpoint = keys, tls_endpoint()
        own = startup.certificate(keys, topics.WORLD)
        router = open_certified_router("m", self.endpoint, own, topics.clients(TEAM))
        self.world = stack.enter_context(router)
        self.robot = stack.enter_context(self.client("robot-1"))
        self.radio = stack.enter_context(self.client("radio"))
        settle(self.world, {"robot-1": self.robot, "radio": self.radio})

    def client(self, name: str, timeout_ms: int = PATIENCE_MS) -> Bus:
        identity = startup.certificate(self.keys, name)
        return open_client("m", self.endpoint, name, identity, timeout_ms)

    def still_works(self) -> None:
        """Whether robot and world hear each other, and nothing else."""
        self.robot.publisher("from/robot-1/word")(b"here")
        self.world.publisher("to/robot-1/order")(b"there")
        assert heard(self.world) == [("robot-1/word", b"here")]
        assert heard(self.robot) == [("order", b"there")]


def _is_turned_out(session: zenoh.Session) -> bool:
    deadline = time.monotonic() + PATIENCE_S
    while session.info.routers_zid():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    return True


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made_keys(tmp_path_factory.mktemp("certificates") / "keys", TEAM)


@pytest.fixture
def house(keys: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    be_patient(monkeypatch)
    with ExitStack() as stack:
        yield House(stack, keys)


@pytest.mark.parametrize("size", [0, PART_BYTES + 1, 3_000_000])
def test_messages_of_any_length_come_and_go(house: House, size: int) -> None:
    data = bytes(number % 251 for number in range(size))
    house.robot.publisher("from/robot-1/out")(data)
    house.radio.publisher("from/radio/carried")(data)
    house.world.publisher("to/robot-1/percept")(data)
    assert heard(house.world, 2) == [("radio/carried", data), ("robot-1/out", data)]
    assert heard(house.robot) == [("percept", data)]


def test_who_has_no_certificate_gets_nowhere(house: House) -> None:
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        stranger(house.endpoint, None, "robot-2", timeout_ms=1000)
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        stranger(house.endpoint.replace("tls/", "tcp/"), None, "robot-2", timeout_ms=1000)
    house.still_works()


def test_a_certificate_of_another_authority_gets_nowhere(house: House, tmp_path: Path) -> None:
    foreign = made_keys(tmp_path / "foreign", TEAM)
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        stranger(house.endpoint, foreign, "robot-2", timeout_ms=1000)
    shutil.copy(house.keys / "robot-2" / "ca.pem", foreign / "robot-2" / "ca.pem")
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        stranger(house.endpoint, foreign, "robot-2", timeout_ms=1000)
    house.still_works()


def test_an_expired_certificate_gets_nowhere(
    house: House, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = shutil.copytree(house.keys, tmp_path / "old")
    monkeypatch.setattr(authority, "EARLIER", datetime.timedelta(days=3))
    authority.issue(old, "robot-2", (), days=-1)
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        stranger(house.endpoint, old, "robot-2", timeout_ms=1000)
    house.still_works()


def test_a_certificate_without_its_key_gets_nowhere(house: House) -> None:
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        stranger(house.endpoint, house.keys, "robot-2", key=house.keys / "robot-1", timeout_ms=1000)
    house.still_works()


def test_a_robot_that_comes_as_another_one_is_turned_out(house: House) -> None:
    """Its session has the id of robot-2, its certificate says robot-1; then robot-2 itself comes."""
    with contextlib.closing(
        stranger(house.endpoint, house.keys, "robot-1", session_id("robot-2"))
    ) as thief:
        ear = thief.declare_subscriber("m/to/robot-2/**", zenoh.handlers.FifoChannel(10))
        assert _is_turned_out(thief)
        house.world.publisher("to/robot-2/order")(b"secret")
        assert ear.try_recv() is None
        thief.put("m/from/robot-2/out", b"forged")
    with house.client("robot-2") as robot:
        robot.publisher("from/robot-2/word")(b"it is me")
        assert heard(house.world) == [("robot-2/word", b"it is me")]
    house.still_works()


def test_a_second_session_of_a_name_gets_no_place(house: House) -> None:
    with pytest.raises(MissionError, match="no bus at"):
        house.client("robot-1", timeout_ms=1000)
    with contextlib.closing(stranger(house.endpoint, house.keys, "robot-1", "1abc")) as second:
        ear = second.declare_subscriber("m/to/robot-1/**", zenoh.handlers.FifoChannel(10))
        second.put("m/from/robot-1/out", b"forged")
        assert _is_turned_out(second)
        assert ear.try_recv() is None
    house.still_works()


def test_who_listens_to_everything_hears_nothing(house: House) -> None:
    with contextlib.closing(stranger(house.endpoint, house.keys, "robot-2")) as spy:
        keys = ("**", "m/**", "m/to/**", "m/from/robot-1/**", "@/**")
        ears = [spy.declare_subscriber(key, zenoh.handlers.FifoChannel(100)) for key in keys]
        tokens = spy.liveliness().declare_subscriber("**", zenoh.handlers.FifoChannel(10), history=True)
        time.sleep(0.3)
        house.still_works()
        assert [ear.try_recv() for ear in (*ears, tokens)] == [None] * (len(ears) + 1)


def test_old_messages_that_somebody_else_says_again_are_not_heard(house: House) -> None:
    with contextlib.closing(stranger(house.endpoint, house.keys, "injector")) as replaying:
        for key in ("from/robot-1/out", "from/radio/carried", "from/operator/control", "to/robot-1/end"):
            for _ in range(10):
                replaying.put(f"m/{key}", b"what was said before")
        house.still_works()


def test_a_flood_on_a_denied_key_holds_nobody_up(house: House) -> None:
    """A second of it at full speed, through the router's one thread."""
    with contextlib.closing(stranger(house.endpoint, house.keys, "robot-2")) as flooding:
        denied = flooding.declare_publisher("m/to/robot-1/percept")
        started = time.monotonic()
        while time.monotonic() - started < 1.0:
            denied.put(bytes(1000))
            flooding.put("m/from/robot-1/out", bytes(40_000))
        house.still_works()


def test_messages_of_100_mb_are_dropped_and_hold_nobody_up(house: House) -> None:
    """Allowed keys and denied ones; on a link without low latency, which would not carry them at all."""
    with house.client("injector") as injector:
        for key in ("from/injector/fault", "from/robot-1/out"):
            injector.publisher(key)(bytes(100_000_000))
        house.still_works()


def test_who_is_shut_out_is_turned_out_and_comes_back_when_it_is_let_in(house: House) -> None:
    house.world.watch("robot-1")
    house.robot.announce("robot-1")
    await_message(house.world, ("world/alive/robot-1", ALIVE))
    house.world.shut_out("robot-1")
    await_message(house.world, ("world/alive/robot-1", GONE))
    house.world.let_in("robot-1")
    await_message(house.world, ("world/alive/robot-1", ALIVE))


def test_silent_connections_keep_nobody_out(house: House) -> None:
    host, port = house.endpoint.removeprefix("tls/").split(":")
    with ExitStack() as stack:
        for _ in range(100):
            stack.enter_context(socket.create_connection((host, int(port)), timeout=PATIENCE_S))
        with house.client("robot-2"):
            house.still_works()


def test_why_a_bus_is_not_reached_can_be_told(house: House, tmp_path: Path) -> None:
    own = startup.certificate(house.keys, "robot-2")
    foreign = startup.certificate(made_keys(tmp_path / "foreign", TEAM), "robot-2")
    shutil.copytree(foreign.folder, tmp_path / "mixed" / "robot-2")
    shutil.copy(own.folder / "ca.pem", tmp_path / "mixed" / "robot-2")
    mixed = dataclasses.replace(foreign, folder=tmp_path / "mixed" / "robot-2")
    assert why_not(house.endpoint, own).startswith("it is reached, and takes no session")
    unknown = "the router's certificate is refused here: unable to get local issuer certificate"
    assert why_not(house.endpoint, foreign) == unknown
    assert why_not(house.endpoint, mixed) == "this certificate is refused there: tlsv1_alert_unknown_ca"
    assert why_not(tls_endpoint(), own) == "connection refused"


def test_who_was_started_by_hand_says_what_is_wrong_and_goes_on(
    keys: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(startup, "FIRST_TRY_MS", 300)
    endpoint = tls_endpoint()
    options = Namespace(mission="m", connect=endpoint, keys=keys, lifeline=None)
    own = startup.certificate(keys, topics.WORLD)
    say, said = startup._say, threading.Event()
    monkeypatch.setattr(startup, "_say", lambda words: (say(words), said.set()))

    def open_when_it_was_said(stack: ExitStack) -> None:
        assert said.wait(PATIENCE_S)
        stack.enter_context(open_certified_router("m", endpoint, own, ["radio"]))

    with ExitStack() as stack:
        opening = threading.Thread(target=open_when_it_was_said, args=(stack,))
        opening.start()
        with startup.connect(options, "radio"):
            opening.join()
    assert capsys.readouterr().err == f"radio: no bus at {endpoint} yet: connection refused\n"
