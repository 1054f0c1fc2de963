"""Who stays connected to the router: one session for each name, until the name is shut out.

Zenoh refuses what a stranger says and asks, but it keeps the connection, and goes on reading. What a
peer floods it with is then the work of the one thread that serves everyone. So the connection is ended
here, by the socket's own means, since Zenoh has none.
"""

import contextlib
import ipaddress
import os
import socket
import threading
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import zenoh

from onehop.node.peer_limits import UNREAD_MS


class Gate:
    """The gate of one router. sessions: the session id that each name has to come with.

    certified: they come with certificates, whose common names have to be those of their sessions.
    """

    def __init__(self, sessions: Mapping[str, str], certified: bool = False) -> None:
        self._sessions = dict(sessions)
        self._certified = {session: name for name, session in sessions.items()} if certified else None
        self._welcome = set(sessions.values())
        self._connected: dict[str, str] = {}
        self._lock = threading.Lock()

    def on_link(self, event: zenoh.LinkEvent) -> None:
        """A connection was opened or closed: end it if its session is not welcome."""
        session, peer = str(event.link.zid), event.link.dst
        with self._lock:
            if event.kind == zenoh.SampleKind.PUT:
                self._connected[session] = peer
                welcome = session in self._welcome and self._is_genuine(session, event.link)
            else:
                welcome = True
                if self._connected.get(session) == peer:
                    del self._connected[session]
        if not welcome:
            _hang_up(peer)

    def _is_genuine(self, session: str, link: zenoh.Link) -> bool:
        return self._certified is None or self._certified[session] == link.auth_identifier

    def shut_out(self, name: str) -> None:
        """End the connection of this name, and any that it opens from now on."""
        with self._lock:
            session = self._sessions[name]
            self._welcome.discard(session)
            peer = self._connected.get(session)
        if peer is not None:
            _hang_up(peer)

    def let_in(self, name: str) -> None:
        """Another process may come under this name."""
        with self._lock:
            self._welcome.add(self._sessions[name])


def limit_unread(port: int) -> None:
    """Hold every connection that this process takes on a TCP port to UNREAD_MS, if the system can."""
    if hasattr(socket, "TCP_USER_TIMEOUT"):

        def limit(own: socket.socket) -> None:
            if own.getsockname()[1] == port:
                own.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNREAD_MS)

        _with_sockets(limit)


def _hang_up(peer: str) -> None:
    """End the connection to a peer by its Zenoh locator, e.g. tcp/ADDRESS:PORT."""
    host, _, port = peer.partition("/")[2].rpartition(":")
    end_of_peer = _address(host.strip("[]")), int(port)

    def end(own: socket.socket) -> None:
        address, port = own.getpeername()[:2]
        if (_address(address), port) == end_of_peer:
            own.shutdown(socket.SHUT_RDWR)

    _with_sockets(end)


def _address(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """An address, that of IPv4 also where a socket of IPv6 took it."""
    address = ipaddress.ip_address(text.partition("%")[0])
    return getattr(address, "ipv4_mapped", None) or address


def _with_sockets(act: Callable[[socket.socket], None]) -> None:
    """Do something with every TCP socket of this process. If it is not connected, OSError is no news."""
    for own in _sockets():
        if own.family in (socket.AF_INET, socket.AF_INET6):
            with contextlib.suppress(OSError):
                act(own)


def _sockets() -> Iterator[socket.socket]:
    """Every socket of this process, by a descriptor of its own: Zenoh may close its own at any time."""
    for entry in Path("/dev/fd").iterdir():
        with contextlib.suppress(OSError):  # no socket, or closed meanwhile
            copy = os.dup(int(entry.name))
            try:
                own = socket.socket(fileno=copy)
            except OSError:
                os.close(copy)
                raise
            with own:
                yield own
