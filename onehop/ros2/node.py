"""A ROS 2 node on Zenoh: publishers and subscriptions that other nodes see and use."""

import contextlib
import json
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

import zenoh
import zenoh.ext

from onehop.contracts.errors import MissionError
from onehop.ros2 import rmw

FIND_MS = 1000
"""How long a router is looked for before one is opened, or before it is looked for again [ms]."""

PATIENCE_S = 20.0
"""How long a robot waits for a router: it may start before the bridge that opens one [s]."""

HEARTBEAT_S = 0.5
"""How often a publisher that lasts says what it has sent last, as rmw_zenoh's do [s]."""

LOOPBACK = ("tcp/127.0.0.1:", "tcp/localhost:")

_SHARED = {
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "transport/shared_memory/enabled": False,
    "timestamping/enabled": {"router": True, "peer": True, "client": True},
}
"""As rmw_zenoh's sessions: lasting publishers want time stamps."""


def open_session(endpoint: str) -> tuple[zenoh.Session, bool]:
    """A session at a router of ROS 2, and whether that router is our own: on loopback, if none is there.

    Raises MissionError.
    """
    with contextlib.suppress(zenoh.ZError):
        return _open_client(endpoint), False
    if not endpoint.startswith(LOOPBACK):
        raise MissionError(f"no router at {endpoint}: start rmw_zenohd there, or give its address")
    return open_router(endpoint), True


def open_router(endpoint: str) -> zenoh.Session:
    """A session that is the router of ROS 2 itself. Raises MissionError where it cannot listen."""
    try:
        return _open({"mode": "router", "listen/endpoints": [endpoint]})
    except zenoh.ZError as error:
        raise MissionError(f"no router at {endpoint}: {str(error).splitlines()[0]}") from None


def wait_for_router(endpoint: str) -> zenoh.Session:
    """A session at a router of ROS 2 that others open. Raises MissionError if none is there in time."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        try:
            return _open_client(endpoint)
        except zenoh.ZError as error:
            if time.monotonic() > deadline:
                why = str(error).splitlines()[0]
                raise MissionError(f"no router of ROS 2 at {endpoint}: {why}") from None


def _open_client(endpoint: str) -> zenoh.Session:
    client = {"mode": "client", "connect/endpoints": [endpoint], "connect/timeout_ms": FIND_MS}
    return _open({**client, "connect/exit_on_failure": True, "listen/endpoints": []})


def _open(settings: dict[str, Any]) -> zenoh.Session:
    config = zenoh.Config()
    for key, value in {**_SHARED, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


class RosNode:
    """One node. Use as a context manager. store: rosbags' types. hashes: False with Humble."""

    def __init__(
        self, session: zenoh.Session, name: str, store: Any, domain: int = 0, hashes: bool = True
    ) -> None:
        self._session = session
        self._store = store
        self._hashes = hashes
        self._node = rmw.Node(domain, str(session.info.zid()), 0, name)
        self._count = 0
        self._tokens = [session.liveliness().declare_token(rmw.node_token(self._node))]
        self._declared: list[Any] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        for one in (*self._declared, *self._tokens):
            one.undeclare()
        self._session.close()  # type: ignore[no-untyped-call]

    def publisher(self, topic: str, kind: str, qos: rmw.Qos) -> Callable[[Any], None]:
        """A function that publishes messages of a type on a topic."""
        key, token = self._announce(rmw.PUBLISHER, topic, kind, qos)
        options: dict[str, Any] = {"congestion_control": zenoh.CongestionControl.DROP}
        if qos.lasting:
            publisher: Any = zenoh.ext.declare_advanced_publisher(
                self._session, key, cache=zenoh.ext.CacheConfig(qos.depth), publisher_detection=True,
                sample_miss_detection=zenoh.ext.MissDetectionConfig(
                    heartbeat=None, sporadic_heartbeat=HEARTBEAT_S
                ),
                **options,
            )  # fmt: skip
        else:
            publisher = self._session.declare_publisher(key, **options)
        self._declared.append(publisher)
        sender, sent = rmw.gid(token), 0

        def publish(message: Any) -> None:
            nonlocal sent
            sent += 1
            data = bytes(self._store.serialize_cdr(message, kind))
            publisher.put(data, attachment=rmw.attachment(sent, time.time_ns(), sender))

        return publish

    def subscribe(self, topic: str, kind: str, qos: rmw.Qos, take: Callable[[Any], None]) -> None:
        """Let take() have every message of a topic, in a thread of Zenoh; passes over what is none."""
        key, _ = self._announce(rmw.SUBSCRIPTION, topic, kind, qos)

        def heard(sample: zenoh.Sample) -> None:
            with contextlib.suppress(Exception):  # whatever a decoder makes of any bytes
                take(self._store.deserialize_cdr(sample.payload.to_bytes(), kind))

        self._declared.append(self._session.declare_subscriber(key, heard))

    def _announce(self, role: str, topic: str, kind: str, qos: rmw.Qos) -> tuple[str, str]:
        """Let others know of an endpoint; its key and its token."""
        type_hash = self._store.hash_rihs01(kind) if self._hashes else rmw.NO_HASH
        self._count += 1
        one = rmw.Endpoint(self._count, role, topic, kind, type_hash, qos)
        token = rmw.endpoint_token(self._node, one)
        self._tokens.append(self._session.liveliness().declare_token(token))
        return rmw.topic_key(self._node.domain, topic, kind, type_hash), token
