"""A peer that keeps to no rule, as a process: what it does with the bus is what a stranger could.

    python -m tests.live.hostile NAME PASSWORD ENDPOINT MISSION QUERIES [ID]

It opens a session, hears all that is for its name, announces itself, says "open", asks for its briefing
QUERIES times, says "asked", and from then on reads nothing: it stops itself. Its lease is a minute.
"""

import json
import os
import signal
import sys

import zenoh


def open_session(name: str, password: str, endpoint: str, own_id: str = "") -> zenoh.Session:
    """A session of a robot's kind, under any id."""
    config = zenoh.Config()
    settings = {
        "mode": "client",
        "connect/endpoints": [endpoint],
        "listen/endpoints": [],
        "connect/timeout_ms": 2000,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "transport/unicast/qos/enabled": False,
        "transport/unicast/lowlatency": True,
        "transport/shared_memory/enabled": False,
        "transport/link/tx/lease": 60_000,
        "transport/auth/usrpwd": {"user": name, "password": password},
    }
    if own_id:
        settings["id"] = own_id
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


def main(name: str, password: str, endpoint: str, mission: str, queries: str, own_id: str = "") -> None:
    session = open_session(name, password, endpoint, own_id)
    session.declare_subscriber(f"{mission}/to/{name}/**", lambda _: None)
    token = session.liveliness().declare_token(f"{mission}/alive/{name}")
    print("open", flush=True)
    for _ in range(int(queries)):
        session.get(f"{mission}/config/{name}", zenoh.handlers.FifoChannel(1), timeout=60.0)
    print("asked", flush=True)
    os.kill(os.getpid(), signal.SIGSTOP)
    token.undeclare()


if __name__ == "__main__":
    main(*sys.argv[1:])
