"""Zenoh as this project uses it: one router (the world), all others clients, everyone with an identity.

The router refuses every put, subscription and query that the table in `rights` does not give to the
sender's user name. A process receives from one channel, as (what, bytes), in arrival order; nothing may
depend on that order. Liveliness changes come through the same channel. The channel is Zenoh's own: its
network thread fills it without Python's interpreter lock, and the process's one thread takes from it. A
Python callback costs a thread switch or two more for each message.

No thread outlives its session: the alarm and the threads of Python callbacks end before it is closed.
"""

import contextlib
import json
import os
import secrets
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from queue import SimpleQueue
from types import TracebackType
from typing import Any, Self, TypeVar

import zenoh

from onehop.contracts import topics
from onehop.contracts.errors import MissionError
from onehop.node import peer_limits
from onehop.node.alarm import Alarm
from onehop.node.gate import Gate, limit_unread
from onehop.node.identity import Certificate, Identity, proof, session_id
from onehop.node.parts import PART_BYTES, Parts, last_part, leading_parts
from onehop.node.rights import access_control

T = TypeVar("T")

ALIVE = b"alive"
GONE = b"gone"

CHANNEL_MESSAGES = 100_000
"""Messages that may wait for a process. When there are more its peers wait too: nothing is dropped."""

CONNECT_TIMEOUT_MS = 300_000
"""How long a client waits for the router to appear: the first world of an installation compiles its
kernels before, which takes more than a minute on a machine that has much else to do."""

LEASE_MS = 3000
"""Silence after which a stopped process, the world too, counts as gone; a killed one is gone at once. A
peer goes by the lease that the silent one announced (Zenoh's default is 10 s)."""

ONE_THREAD = (
    "(rx: (handover: net), acc: (handover: net), app: (handover: net), tx: (handover: net), "
    "net: (worker_threads: 1))"
)
"""Zenoh's own threads in each process: one. Its default of several costs 30 % more time a tick."""

ROUTER_THREADS = ONE_THREAD.replace("acc: (handover: net)", "acc: (worker_threads: 1)")
"""The router's: new connections have a thread of their own. To close one that never said who it is takes
5 ms (SO_LINGER), in which the thread can do nothing else; strangers may open as many as they like."""

WAITING_QUERIES = 256
"""Queries that wait for their answer, at most: the 300 robots of a mission do not ask all at once."""

LOW_LATENCY = (topics.RADIO, topics.robot_name(""))
"""Beginnings of the names of those whom every tick waits for: their links are of Zenoh's low-latency
transport, which writes from the thread of the sender instead of waking another one."""

QUIET = {
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "transport/shared_memory/enabled": False,
    "transport/unicast/qos/enabled": False,
    "timestamping/enabled": False,
}
"""What nobody here uses. Without priorities a link is of low latency if both of its ends ask for it."""


class Bus:
    """One session on the bus of one mission. Use as a context manager: leaving without close hangs."""

    def __init__(
        self,
        session: zenoh.Session,
        mission: str,
        name: str,
        gate: Gate | None = None,
        is_router: bool = False,
    ) -> None:
        self._session = session
        self._gate = gate
        self.is_router = is_router
        self._mission = mission
        heard = self._key(topics.heard(name))
        self._prefix = len(heard.removesuffix("**"))
        self._own = heard.replace("**", topics.WORLD + "/" if name == topics.WORLD else "")
        self._parts = Parts(peer_limits.LONGEST_MESSAGE_BYTES)
        self._kept: list[Any] = []
        self._token: Any = None
        self._called: list[Any] = []
        self._callback_ends: list[SimpleQueue[threading.Thread]] = []
        self._alarm: Alarm | None = None
        self._closed = threading.Event()
        if gate is not None:
            links = session.info.declare_link_events_listener(self._callback(gate.on_link))
            self._called.append(links)
        self._channel = session.declare_subscriber(heard, zenoh.handlers.FifoChannel(CHANNEL_MESSAGES))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._closed.is_set():
            self._closed.set()
            self._end_threads()
            self._session.close()  # type: ignore[no-untyped-call]

    def _end_threads(self) -> None:
        """Wait for everything that may still use the session: on a closed one it would raise."""
        self._channel.undeclare()  # type: ignore[no-untyped-call]  # lets go who waits for room in it
        if self._alarm is not None:
            self._alarm.end()
        for declared in self._called:
            declared.undeclare()
        for end in self._callback_ends:
            end.get().join()
        for publisher in self._kept:  # one that outlives its session keeps 13 kB of it for ever
            publisher.undeclare()

    def _callback(self, call: Callable[[T], None]) -> "zenoh.handlers.Callback[T]":
        """A handler that calls from a thread of its own, whose end is noted when it is undeclared."""
        end: SimpleQueue[threading.Thread] = SimpleQueue()
        self._callback_ends.append(end)
        return zenoh.handlers.Callback(call, drop=lambda: end.put(threading.current_thread()))

    def _key(self, key: str) -> str:
        return f"{self._mission}/{key}"

    def publisher(
        self, key: str, express: bool = True, may_drop: bool = False
    ) -> Callable[[bytes], None]:
        """A function that puts bytes on a key. express: send at once rather than batch.

        may_drop: what does not fit into a queue is dropped, and nobody waits until it does.
        """
        control = zenoh.CongestionControl.DROP if may_drop else zenoh.CongestionControl.BLOCK
        publisher = self._session.declare_publisher(
            self._key(key), congestion_control=control, express=express
        )
        self._kept.append(publisher)
        _, _, to_or_by = key.partition("/")
        in_parts = to_or_by.startswith(LOW_LATENCY)
        return self._in_parts(publisher.put, key) if in_parts else publisher.put

    def _in_parts(self, put: Callable[[bytes], None], key: str) -> Callable[[bytes], None]:
        """put for a link of low latency, for messages of any length."""
        part = self._key(key.rpartition("/")[0] + "/" + topics.PART)

        def put_all(data: bytes) -> None:
            if len(data) > PART_BYTES:
                for leading in leading_parts(data):
                    self._session.put(part, leading, congestion_control=zenoh.CongestionControl.BLOCK)
                data = last_part(data)
            put(data)

        return put_all

    def tell_self(self, what: str, data: bytes = b"") -> None:
        """Let this process receive a message from itself; after the session's end it is no message.

        Signal handlers may call it at any time.
        """
        if not self._closed.is_set():
            self._session.put(self._own + what, data, allowed_destination=zenoh.Locality.SESSION_LOCAL)

    def watch(self, name: str) -> None:
        """Receive ("alive/<name>", ALIVE or GONE) for a process, or "*", present ones included."""
        prefix = len(self._mission) + 1

        def changed(sample: zenoh.Sample) -> None:
            state = ALIVE if sample.kind == zenoh.SampleKind.PUT else GONE
            self.tell_self(str(sample.key_expr)[prefix:], state)

        liveliness, token = self._session.liveliness(), self._key(topics.alive(name))
        self._called.append(liveliness.declare_subscriber(token, self._callback(changed), history=True))

    def announce(self, name: str) -> None:
        """Declare this process alive. Do it last: whoever sees the token may send at once."""
        self._token = self._session.liveliness().declare_token(self._key(topics.alive(name)))

    def withdraw(self) -> None:
        """Take the announcement back: this process is there, and not ready."""
        if self._token is not None:
            self._token.undeclare()
            self._token = None

    def receive(self) -> tuple[str, bytes]:
        """The next message or liveliness change, whenever it comes.

        Its name is what the key says after to/<name>/, and for the world after from/.
        """
        channel = self._channel
        while True:
            received = self._whole(channel.try_recv() or channel.recv())
            if received is not None:
                return received

    def _whole(self, sample: zenoh.Sample) -> tuple[str, bytes] | None:
        """A message with the parts that came before it; None if it is a part itself."""
        what = str(sample.key_expr)[self._prefix :]
        data = sample.payload.to_bytes()
        if not (self._parts.waiting or what.endswith(topics.PART)):
            return what, data
        whole = self._parts.joined(what, data)
        return None if whole is None else (what, whole)

    def receive_by(self, deadline: float) -> tuple[str, bytes] | None:
        """The next message; None when there is none by the deadline (time.monotonic() [s])."""
        if self._alarm is None:
            self._alarm = Alarm(lambda: self.tell_self(topics.PULSE))
        pulse = (self._own + topics.PULSE)[self._prefix :]
        while True:
            self._alarm.ring_by(deadline)
            what, data = self.receive()
            if what != pulse:
                return what, data
            if time.monotonic() >= deadline:
                return None

    def poll(self) -> tuple[str, bytes] | None:
        """The next message if it is there already."""
        while (sample := self._channel.try_recv()) is not None:
            received = self._whole(sample)
            if received is not None:
                return received
        return None

    def shut_out(self, name: str) -> None:
        """End the session of a name, and do not take another one. It needs names that are known."""
        if self._gate is not None:
            self._gate.shut_out(name)

    def let_in(self, name: str) -> None:
        """Take a session of this name again."""
        if self._gate is not None:
            self._gate.let_in(name)

    @contextlib.contextmanager
    def answering(self, key: str, reply: Callable[[str], bytes | None]) -> Iterator[None]:
        """Answer queries on an expression meanwhile: reply(key) gives the bytes, or None for no answer.

        At any other time the router itself says to whoever asks that there is nobody to answer. Of more
        than WAITING_QUERIES the oldest is dropped; who asked it hears so, and asks again. If they were
        held back instead, Zenoh's network thread would wait here for an answer to a peer that does not
        read, and that answer for the network thread.
        """
        prefix = len(self._mission) + 1
        ring: Any = zenoh.handlers.RingChannel(WAITING_QUERIES)
        queryable: Any = self._session.declare_queryable(self._key(key), ring)

        def answer_all() -> None:
            for query in queryable:
                with query:
                    data = reply(str(query.key_expr)[prefix:])
                    if data is not None:
                        for leading in leading_parts(data):
                            query.reply(query.key_expr, leading, attachment=topics.PART)
                        query.reply(query.key_expr, last_part(data))

        answerer = threading.Thread(target=answer_all, name="answers", daemon=True)
        answerer.start()
        try:
            yield
        finally:
            queryable.undeclare()
            answerer.join()

    def ask(self, key: str, timeout_s: float) -> bytes | None:
        """The first answer to a query on a key, None when none comes in time, or not all of it."""
        answer = bytearray()
        every_part = zenoh.ConsolidationMode.NONE
        for reply in self._session.get(self._key(key), timeout=timeout_s, consolidation=every_part):
            if reply.ok is not None:
                answer += reply.ok.payload.to_bytes()
                if reply.ok.attachment is None:
                    return bytes(answer)
        return None


def open_router(mission: str, endpoint: str, credentials: Mapping[str, str] | None = None) -> Bus:
    """The world's session. credentials: passwords by name; without them anyone may say anything."""
    if credentials is None:
        return Bus(_open_router(endpoint, {}), mission, topics.WORLD, is_router=True)
    with tempfile.TemporaryFile("w") as dictionary:  # it has no name that could outlive this process
        dictionary.writelines(f"{name}:{word}\n" for name, word in credentials.items())
        dictionary.flush()
        login = {
            "user": topics.WORLD,
            "password": secrets.token_hex(16),
            "dictionary_file": f"/dev/fd/{dictionary.fileno()}",
        }
        sessions = {name: session_id(word) for name, word in credentials.items()}
        rights = access_control(mission, sessions, "usernames")
        settings = {"transport/auth/usrpwd": login, "access_control": rights}
        return Bus(
            _open_router(endpoint, settings), mission, topics.WORLD, Gate(sessions), is_router=True
        )


def open_certified_router(
    mission: str, endpoint: str, certificate: Certificate, names: Iterable[str]
) -> Bus:
    """The world's session, where everyone has a certificate. names: who may come."""
    sessions = {name: session_id(name) for name in names}
    rights = access_control(mission, sessions, "cert_common_names")
    settings = {**certificate.settings("listen"), "access_control": rights}
    gate = Gate(sessions, certified=True)
    return Bus(_open_router(endpoint, settings), mission, topics.WORLD, gate, is_router=True)


def _open_router(endpoint: str, settings: Mapping[str, Any]) -> zenoh.Session:
    own = {
        "mode": "router",
        "listen/endpoints": [endpoint],
        "scouting/delay": 0,
        "transport/unicast/lowlatency": True,
        **peer_limits.SETTINGS,
        **settings,
    }
    session = _open(own)
    limit_unread(int(endpoint.rpartition(":")[2]))
    return session


def open_client(
    mission: str,
    endpoint: str,
    name: str,
    identity: Identity | None,
    timeout_ms: int = CONNECT_TIMEOUT_MS,
) -> Bus:
    """The session of everyone else. Raises MissionError if the router does not appear in time."""
    settings: dict[str, Any] = {
        "mode": "client",
        "connect/endpoints": [endpoint],
        "connect/timeout_ms": timeout_ms,
        "connect/exit_on_failure": True,
        "connect/retry": {"period_init_ms": 20, "period_max_ms": 200, "period_increase_factor": 1.5},
        "listen/endpoints": [],
        "transport/unicast/lowlatency": name.startswith(LOW_LATENCY),
    }
    if identity is not None:
        settings |= proof(name, identity)
    return Bus(_open(settings), mission, name)


def _open(settings: Mapping[str, Any]) -> zenoh.Session:
    threads = ROUTER_THREADS if settings["mode"] == "router" else ONE_THREAD
    os.environ.setdefault("ZENOH_RUNTIME", threads)
    config = zenoh.Config()
    for key, value in {**QUIET, "transport/link/tx/lease": LEASE_MS, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        endpoint = settings["listen/endpoints"] or settings["connect/endpoints"]
        raise MissionError(f"no bus at {endpoint[0]}: {str(error).splitlines()[0]}") from None
