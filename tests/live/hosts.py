"""Identities, endpoints and processes that tests of several hosts share."""

import contextlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
import zenoh

from onehop.mission import authority
from onehop.mission.processes import free_endpoint
from onehop.mission.router_file import write_router_file
from onehop.node.certificates import own_certificate
from onehop.node.identity import KEY, Certificate, session_id
from tests.live.mission import DEADLINE_S

DAYS = 7

LINK = "10.77.0."
"""Addresses of the hosts that are namespaces."""


def made_keys(folder: Path, robots: Sequence[int], *hosts: str, bases: Sequence[int] = ()) -> Path:
    """A folder of keys for a team. bases: robots with a real one."""
    authority.found(folder)
    for name in authority.names_of(robots, bases):
        authority.issue(folder, name, hosts, DAYS)
    return folder


def tls_endpoint() -> str:
    """One on loopback that nobody listens on right now."""
    return free_endpoint().replace("tcp/", "tls/")


def stranger(
    endpoint: str,
    keys: Path | None,
    name: str,
    own_id: str | None = None,
    key: Path | None = None,
    timeout_ms: int = 60_000,
) -> zenoh.Session:
    """A session that shows the certificate of a name, whatever it is worth. Raises zenoh.ZError.

    own_id: of the session, that of the name by default. key: another one than the certificate's.
    timeout_ms: how long it tries again.
    """
    settings: dict[str, Any] = {
        "mode": "client",
        "connect/endpoints": [endpoint],
        "connect/timeout_ms": timeout_ms,
        "connect/exit_on_failure": True,
        "listen/endpoints": [],
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "transport/unicast/qos/enabled": False,
        "transport/unicast/lowlatency": True,
        "transport/shared_memory/enabled": False,
        "transport/link/tls/verify_name_on_connect": False,
    }
    if keys is not None:
        shown = Certificate(name, keys / name, (), None)  # type: ignore[arg-type]
        settings |= shown.settings("connect") | {"id": own_id or session_id(name)}
        if key is not None:
            settings["transport/link/tls/connect_private_key"] = str(key / KEY)
    config = zenoh.Config()
    for setting, value in settings.items():
        config.insert_json5(setting, json.dumps(value))
    return zenoh.open(config)


ROUTER = """
import sys, zenoh
with zenoh.open(zenoh.Config.from_file(sys.argv[1])):
    print("open", flush=True)
    sys.stdin.read()
"""


class Router:
    """A router with the configuration of `onehop keys` and Zenoh's own threads, as zenohd has them.

    For robots 1 to 6. bases: those with a real one.
    """

    def __init__(self, keys: Path, endpoint: str, bases: Sequence[int] = ()) -> None:
        names = authority.names_of(range(1, 7), bases)
        self._path = write_router_file(own_certificate(keys, authority.ROUTER), "onehop", names)
        self._path.write_text(self._path.read_text().replace("tls/[::]:7447", endpoint))
        self._child = self._started()

    def __enter__(self) -> "Router":
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()

    def _started(self) -> "subprocess.Popen[str]":
        child = subprocess.Popen(
            [sys.executable, "-c", ROUTER, self._path.name],
            cwd=self._path.parent,
            env={key: value for key, value in os.environ.items() if key != "ZENOH_RUNTIME"},
            text=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        assert child.stdout is not None
        assert child.stdout.readline() == "open\n"
        return child

    def kill(self) -> None:
        """End it outright (SIGKILL)."""
        self._child.kill()
        self._child.communicate(timeout=DEADLINE_S)

    def start_again(self) -> None:
        """Another process in its place."""
        self._child = self._started()


class Host:
    """A network namespace with an address of its own. number: last part of its address."""

    def __init__(self, prefix: str, number: int) -> None:
        self.namespace = f"{prefix}-{number}"
        self.address = f"{LINK}{number}"

    def start(self, *words: str, **options: Any) -> "subprocess.Popen[str]":
        """A Python program on this host."""
        command = ["ip", "netns", "exec", self.namespace, sys.executable, "-m", *words]
        return subprocess.Popen(command, text=True, **options)

    @contextlib.contextmanager
    def cut(self) -> Iterator[None]:
        """Its cable is pulled meanwhile."""
        _ip("-n", self.namespace, "link", "set", "eth0", "down")
        try:
            yield
        finally:
            _ip("-n", self.namespace, "link", "set", "eth0", "up")


@contextlib.contextmanager
def hosts(count: int) -> Iterator[list[Host]]:
    """Namespaces on one switch, a bridge in a namespace of its own; skips where there can be none."""
    if shutil.which("ip") is None or os.geteuid() != 0:
        pytest.skip("network namespaces need root and the program ip")
    prefix = f"onehop-{os.getpid()}"
    switch, made = f"{prefix}-switch", [Host(prefix, number) for number in range(1, count + 1)]
    try:
        try:
            _ip("netns", "add", switch)
        except subprocess.CalledProcessError as error:
            pytest.skip(f"no network namespace can be made here: {error.stderr.strip()}")
        _ip("-n", switch, "link", "add", "name", "sw0", "type", "bridge")
        _ip("-n", switch, "link", "set", "sw0", "up")
        for number, host in enumerate(made, start=1):
            _ip("netns", "add", host.namespace)
            pair = ("type", "veth", "peer", "name", f"port{number}", "netns", switch)
            _ip("link", "add", "name", "eth0", "netns", host.namespace, *pair)
            _ip("-n", switch, "link", "set", f"port{number}", "master", "sw0", "up")
            _ip("-n", host.namespace, "link", "set", "lo", "up")
            _ip("-n", host.namespace, "addr", "add", f"{host.address}/24", "dev", "eth0")
            _ip("-n", host.namespace, "link", "set", "eth0", "up")
        yield made
    finally:
        for name in (*(host.namespace for host in made), switch):
            subprocess.run(["ip", "netns", "del", name], check=False, capture_output=True)


def _ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


@contextlib.contextmanager
def ended(*children: "subprocess.Popen[str]") -> Iterator[None]:
    """Let these processes end with the test, by themselves or not."""
    try:
        yield
    finally:
        for child in children:
            if child.poll() is None:
                child.kill()
            child.communicate(timeout=DEADLINE_S)
