"""Who a process is on the bus: a password that its launcher made, or a certificate of `onehop keys`.

Either goes with one session id, so that a name cannot be used twice at once. That of a password is a
secret like the password; that of a certificate is not, and the gate compares it with the certificate.
"""

import datetime
import hashlib
import secrets
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

AUTHORITY, CERTIFICATE, KEY = "ca.pem", "cert.pem", "key.pem"
"""Files of one process: the authority's certificate, its own, and the key to its own."""

TLS = "tls/"
"""What endpoints begin with that certificates are for."""


@dataclass(frozen=True, slots=True)
class Certificate:
    """What says who a process is. name: of the process, its common name. folder: of its three files.

    hosts: names and addresses under which it may be a router. expires: the last moment of its validity.
    """

    name: str
    folder: Path
    hosts: tuple[str, ...]
    expires: datetime.datetime

    def settings(self, side: str) -> dict[str, Any]:
        """Zenoh's settings. side: "listen" or "connect".

        Not in them: close_link_on_expiration, with which Zenoh 1.10 panics when a link of low latency is
        closed. So a certificate counts when a session is opened, and the session stays.
        """
        tls = "transport/link/tls/"
        return {
            f"{tls}root_ca_certificate": str(self.folder / AUTHORITY),
            f"{tls}enable_mtls": True,
            f"{tls}verify_name_on_connect": True,
            f"{tls}{side}_certificate": str(self.folder / CERTIFICATE),
            f"{tls}{side}_private_key": str(self.folder / KEY),
        }


Identity = str | Certificate
"""A password, or a certificate."""


def make_credentials(names: Iterable[str]) -> dict[str, str]:
    """A fresh password for every name of a mission."""
    return {name: secrets.token_hex(16) for name in names}


def session_id(secret: str) -> str:
    """The id of the one session that may use a password: 16 bytes in hexadecimal, no zero in front.

    With a certificate it is that of the name in place of a password.
    """
    return "1" + hashlib.sha256(secret.encode()).hexdigest()[:31]


def proof(name: str, identity: Identity) -> dict[str, Any]:
    """Zenoh's settings for the session of a name."""
    if isinstance(identity, Certificate):
        return {**identity.settings("connect"), "id": session_id(name)}
    login = {"user": name, "password": identity}
    return {"transport/auth/usrpwd": login, "id": session_id(identity)}
