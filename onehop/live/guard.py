"""Who may see the page: whoever has its address with the token in it, and no page of somebody else's.

A page of another site that the same browser shows can send requests here, under a name that it lets
point to this machine (DNS rebinding), or as a WebSocket across sites, which browsers do not forbid. So a
request has to name this machine by a name that nobody else can give it, and a WebSocket has to come from
this page.
"""

import hmac
import ipaddress
import secrets
import socket
from dataclasses import dataclass, field

from onehop.contracts.errors import InputError

LOOPBACK = "127.0.0.1"

HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""What every answer says; the address with its token goes to nobody else."""


@dataclass(frozen=True, slots=True)
class Address:
    """Where the page is served. port: 0 for a free one."""

    host: str = LOOPBACK
    port: int = 0


def parse_address(text: str) -> Address:
    """HOST:PORT, [V6]:PORT, HOST, :PORT, or nothing for a free port on loopback. Raises InputError."""
    host, _, port = text.rpartition(":") if ":" in text else (text, "", "")
    host = host.removeprefix("[").removesuffix("]") or LOOPBACK
    if port and not (port.isascii() and port.isdecimal() and int(port) < 65536):
        raise InputError(f"--live {text:.60}", "no address", "HOST:PORT, e.g. 127.0.0.1:8000")
    return Address(host, int(port or 0))


def bind(address: Address) -> socket.socket:
    """A socket that listens there. Raises InputError."""
    try:
        family, kind, protocol, _, place = socket.getaddrinfo(
            address.host, address.port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listening = socket.socket(family, kind, protocol)
    except (OSError, UnicodeError) as error:
        raise _refused(address, error) from None
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(place)
        listening.listen()
    except OSError as error:
        listening.close()
        raise _refused(address, error) from None
    return listening


def _refused(address: Address, error: Exception) -> InputError:
    why = getattr(error, "strerror", None) or "no address"
    remedy = "another HOST:PORT; without one it is a free port on loopback"
    return InputError(f"--live {address.host}:{address.port}", f"cannot be listened on: {why}", remedy)


@dataclass(frozen=True, slots=True)
class Guard:
    """host, port: where the page is served. token: without it nobody sees anything."""

    host: str
    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(16))

    @property
    def url(self) -> str:
        """The address that people open."""
        if _is_every_interface(self.host):
            host = socket.gethostname()
        else:
            host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}/?token={self.token}"

    def knows_host(self, header: str | None) -> bool:
        """Whether a request's Host is this machine by a name that no stranger can give it."""
        host, port = _parted(header or "")
        if port != self.port:
            return False
        if host in ("localhost", self.host.lower()):
            return True
        if not _is_every_interface(self.host):
            return False
        return _is_number(host) or host in (socket.gethostname().lower(), socket.getfqdn().lower())

    def knows_token(self, token: str | None) -> bool:
        return hmac.compare_digest((token or "").encode(), self.token.encode())

    def is_own_page(self, origin: str | None, host: str | None) -> bool:
        """Whether a WebSocket comes from a page that was served here, under the same name."""
        return (
            self.knows_host(host) and origin is not None and origin.lower() == f"http://{host}".lower()
        )


def content_policy(host: str) -> str:
    """What the page may load: its own files, and nothing that stands in its text. host: checked."""
    return (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
        f"connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


def _parted(header: str) -> tuple[str, int]:
    """Name and port of a Host header; port 80 where it names none, -1 where it is none."""
    host, colon, port = header.lower().rpartition(":")
    if not colon or port.endswith("]"):
        host, port = header.lower(), "80"
    return host.removeprefix("[").removesuffix("]"), int(port) if port.isdecimal() else -1


def _is_number(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


def _is_every_interface(host: str) -> bool:
    return _is_number(host) and ipaddress.ip_address(host).is_unspecified
