"""The driver of a robot's real base (docs/hardware.md): what it measures goes to the world, twists come.

It imports zenoh and msgpack and the standard library. The base itself is a class with `read` and
`drive`; here it is that of fake_base.py, and yours takes its place in `make_base`. Start it by hand,
where the base is, with
    python base_driver.py --id ROBOT --connect tls/HOST:PORT --keys DIR [WORDS FOR THE BASE]
or let `onehop run` start it (base_command of the scenario), with a password in ONEHOP_PASSWORD.
"""

import argparse
import hashlib
import json
import math
import os
import queue
import signal
import struct
import sys
import time
from collections.abc import Sequence
from typing import Any, Protocol

import msgpack
import zenoh

WIRE_VERSION = 3

RATE_HZ = 40.0
"""How often it measures; at the end of each of its ticks (50 ms) the world takes in the newest."""

DEADMAN_S = 0.5
"""After so long without a command the base rests [s], whatever has become of world and network."""


REUNION_S = 10.0
"""How long a driver that has lost the world looks for it [s]: a cable, or the router, may come back."""


class Base(Protocol):
    """What a base has to offer. Frames: docs/hardware.md."""

    def read(self) -> tuple[tuple[float, float, float], tuple[float, float], Sequence[float]]:
        """Pose x [m], y [m], heading [rad] in the map frame; v [m/s], w [rad/s]; ranges [m].

        As many ranges as `laser_beams` of the briefing, right to left, math.inf where nothing is in
        range.
        """

    def drive(self, v: float, w: float) -> None:
        """Drive by this twist [m/s, rad/s] until the next one. It is called often, and must not wait."""


def make_base(briefing: dict[str, Any], words: list[str]) -> Base:
    """The base that is driven: put yours here."""
    from fake_base import FakeBase

    return FakeBase(briefing["body"], *words)


class Bus:
    """This process's session: what it hears comes through one queue, in the order of its arrival."""

    def __init__(self, mission: str, name: str, endpoint: str, keys: str | None) -> None:
        settings = {
            "mode": "client",
            "connect/endpoints": [endpoint],
            "connect/timeout_ms": 300_000,
            "connect/exit_on_failure": True,
            "listen/endpoints": [],
            "scouting/multicast/enabled": False,
            "transport/unicast/qos/enabled": False,
            "transport/link/tx/lease": 3000,
            **identity(name, keys),
        }
        config = zenoh.Config()
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
        self._session = zenoh.open(config)
        self._mission, self._name = mission, name
        self._queue: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
        self._kept: list[Any] = [
            self._session.declare_subscriber(f"{mission}/to/{name}/**", self._hear),
            self._session.liveliness().declare_subscriber(
                f"{mission}/alive/world", self._see_world, history=True
            ),
            self._session.declare_publisher(
                f"{mission}/from/{name}/measured",
                express=True,
                congestion_control=zenoh.CongestionControl.DROP,  # the next one is newer
            ),
        ]
        self.measured = self._kept[-1].put

    def _hear(self, sample: zenoh.Sample) -> None:
        self._queue.put((str(sample.key_expr).rpartition("/")[2], sample.payload.to_bytes()))

    def _see_world(self, sample: zenoh.Sample) -> None:
        there = sample.kind == zenoh.SampleKind.PUT
        self._queue.put(("world is there" if there else "world is gone", b""))

    def briefing(self) -> dict[str, Any]:
        """Asked for until it is given."""
        deadline = time.monotonic() + 30.0
        while time.monotonic() < deadline:
            for reply in self._session.get(f"{self._mission}/config/{self._name}", timeout=2.0):
                if reply.ok is not None:
                    return decoded(reply.ok.payload.to_bytes())
            time.sleep(0.1)
        sys.exit("the world gave no briefing")

    def announce(self) -> None:
        token = f"{self._mission}/alive/{self._name}"
        self._kept.append(self._session.liveliness().declare_token(token))

    def heard_by(self, deadline: float) -> tuple[str, bytes] | None:
        """The next message; None when there is none by the deadline (time.monotonic() [s])."""
        try:
            return self._queue.get(timeout=max(0.0, deadline - time.monotonic()))
        except queue.Empty:
            return None

    def close(self) -> None:
        self._session.close()


def identity(name: str, keys: str | None) -> dict[str, Any]:
    """What Zenoh has to know of who this is: a certificate, or else a password."""
    if keys is None:
        secret = os.environ.get("ONEHOP_PASSWORD", "")
        if not secret:
            sys.exit("no password: give --keys DIR, or let onehop run start this driver")
        proof: dict[str, Any] = {"transport/auth/usrpwd": {"user": name, "password": secret}}
    else:
        secret, tls, own = name, "transport/link/tls/", os.path.join(keys, name)
        proof = {
            tls + "root_ca_certificate": os.path.join(own, "ca.pem"),
            tls + "enable_mtls": True,
            tls + "connect_certificate": os.path.join(own, "cert.pem"),
            tls + "connect_private_key": os.path.join(own, "key.pem"),
        }
    return {**proof, "id": "1" + hashlib.sha256(secret.encode()).hexdigest()[:31]}


def decoded(data: bytes) -> Any:
    message = msgpack.unpackb(data)
    if message["v"] != WIRE_VERSION:
        sys.exit(f"the world speaks version {message['v']} of the wire, this driver {WIRE_VERSION}")
    return message


def measurement(base: Base, number: int) -> bytes:
    """What the base measures now, as it goes on the wire."""
    (x, y, heading), (v, w), ranges = base.read()
    said = {
        "v": WIRE_VERSION,
        "number": number,
        "pose": {"x": x, "y": y, "heading": math.remainder(heading, math.tau)},
        "twist": {"v": v, "w": w},
        "scan": struct.pack(f"<{len(ranges)}f", *ranges),
    }
    packed: bytes = msgpack.packb(said)
    return packed


def serve(bus: Bus, base: Base) -> int:
    """Measure and drive to the end of the mission; the exit status. The base rests when this ends."""
    number, commanded_s, gone_s = 0, -math.inf, math.inf
    due_s = time.monotonic()
    try:
        while True:
            while (heard := bus.heard_by(due_s)) is not None:
                what, data = heard
                if what == "drive":
                    twist, commanded_s = decoded(data)["twist"], time.monotonic()
                    base.drive(twist["v"], twist["w"])
                elif what == "end":
                    return 0
                elif what == "world is gone":
                    gone_s, commanded_s = time.monotonic(), -math.inf
                elif what == "world is there":
                    gone_s = math.inf
            if time.monotonic() - commanded_s > DEADMAN_S:
                base.drive(0.0, 0.0)
            if time.monotonic() - gone_s > REUNION_S:
                return 3
            number += 1
            bus.measured(measurement(base, number))
            due_s = max(due_s + 1.0 / RATE_HZ, time.monotonic())
    finally:
        base.drive(0.0, 0.0)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("words", nargs="*", help="what the base is told")
    parser.add_argument("--mission", default="onehop")
    parser.add_argument("--lifeline", type=int)
    parser.add_argument("--id", type=int, required=True)
    parser.add_argument("--connect", required=True)
    parser.add_argument("--keys")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))  # so that the base rests
    bus = Bus(options.mission, f"base-{options.id}", options.connect, options.keys)
    try:
        base = make_base(bus.briefing(), options.words)
        bus.announce()
        return serve(bus, base)
    except KeyboardInterrupt:
        return 130
    finally:
        bus.close()  # without it the process would not end


if __name__ == "__main__":
    sys.exit(main())
