"""The configuration of a router of its own, zenohd, with the rights that the world's router gives.

Its links are not of low latency: there the thread that hears from one end writes to the other, and when
it has to wait all that this thread serves waits too.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from onehop.contracts import topics
from onehop.mission.authority import ROUTER
from onehop.node.bus import LEASE_MS, QUIET
from onehop.node.identity import Certificate, session_id
from onehop.node.peer_limits import SETTINGS
from onehop.node.rights import access_control
from onehop.wire.output_folder import explained

FILE = "zenohd.json5"

HEAD = """\
// The router of a mission, made by onehop keys: in this folder, zenohd --config zenohd.json5
// The world and everyone else are its clients; each may say and hear what the table of rights gives it.
"""


def write_router_file(certificate: Certificate, mission: str, names: Sequence[str]) -> Path:
    """Write the file beside the router's certificate; gives its path. names: who may come."""
    path = certificate.folder / FILE
    with explained(path, "a folder that can be written"):
        path.write_text(HEAD + json.dumps(_nested(_settings(certificate, mission, names)), indent=1))
        path.chmod(0o600)
    return path


def _settings(certificate: Certificate, mission: str, names: Sequence[str]) -> dict[str, Any]:
    guests = {name: session_id(name) for name in names if name not in (ROUTER, topics.WORLD)}
    here = Certificate(certificate.name, Path(), certificate.hosts, certificate.expires)
    return {
        **QUIET,
        **SETTINGS,
        **here.settings("listen"),
        "mode": "router",
        "listen/endpoints": ["tls/[::]:7447"],
        "adminspace/enabled": False,
        "transport/link/tx/lease": LEASE_MS,
        "access_control": access_control(mission, guests, "cert_common_names", session_id(topics.WORLD)),
    }


def _nested(settings: dict[str, Any]) -> dict[str, Any]:
    """Zenoh's keys with slashes as objects within objects."""
    nested: dict[str, Any] = {}
    for key, value in settings.items():
        *path, last = key.split("/")
        inner = nested
        for step in path:
            inner = inner.setdefault(step, {})
        inner[last] = value
    return nested
