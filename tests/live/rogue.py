"""A robot's process that answers nothing, and says as fast as it can what it may not say.

    python -m tests.live.rogue KEY BYTES --mission PREFIX --id ROBOT --connect ENDPOINT

KEY: what it puts on, without the mission. BYTES: how long each message is.
"""

import argparse
import os
import time

import zenoh

from onehop.node.bus import session_id
from tests.live.hostile import open_session

STARTS_S = 30.0
"""How long the router may take to be there [s]."""


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("key")
    parser.add_argument("bytes", type=int)
    parser.add_argument("--mission")
    parser.add_argument("--id")
    parser.add_argument("--connect")
    options, _ = parser.parse_known_args()
    name, password = f"robot-{options.id}", os.environ["ONEHOP_PASSWORD"]
    session = patient(name, password, options.connect)
    ear = session.declare_subscriber(f"{options.mission}/to/{name}/**", zenoh.handlers.RingChannel(1))
    token = session.liveliness().declare_token(f"{options.mission}/alive/{name}")
    parent = os.getppid()
    message = bytes(options.bytes)
    while os.getppid() == parent:
        session.put(f"{options.mission}/{options.key}", message)
    token.undeclare()
    ear.undeclare()


def patient(name: str, password: str, endpoint: str) -> zenoh.Session:
    """Its session, as soon as there is a router."""
    deadline = time.monotonic() + STARTS_S
    while True:
        try:
            return open_session(name, password, endpoint, session_id(password))
        except zenoh.ZError:
            if time.monotonic() > deadline:
                raise


if __name__ == "__main__":
    main()
