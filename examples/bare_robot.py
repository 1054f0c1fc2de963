"""The robot of simple_robot.py as a process of its own that knows nothing of Onehop but docs/wire.md.

It imports zenoh and msgpack and the standard library. `onehop run` starts it with
    --mission PREFIX --lifeline FD --id ROBOT --connect ENDPOINT
and its password in ONEHOP_PASSWORD, or with --keys DIR, the folder of its certificate.
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
import traceback
from collections.abc import Iterator
from typing import Any

import msgpack
import zenoh

WIRE_VERSION = 3
PART_BYTES = 48_000
PI = 3.141592653589793


class Simple:
    """What simple_robot.py does, operation by operation."""

    def __init__(self, briefing: dict[str, Any]) -> None:
        self.robot, self.incarnation = briefing["robot"], briefing["incarnation"]
        self.goal = briefing["goal"]["x"], briefing["goal"]["y"]
        self.speed = float(briefing["parameters"].get("speed", 0.5))
        self.heard: dict[int, tuple[float, float]] = {}
        self.has_arrived = False

    def step(self, observation: dict[str, Any], inbox: dict[str, Any]) -> dict[str, Any]:
        for message in inbox["receptions"]:
            if len(message["payload"]) == 16:
                x, y = struct.unpack("<2d", message["payload"])
                self.heard[message["source"]] = x, y
        (goal_x, goal_y), pose = self.goal, observation["pose"]
        dx, dy = goal_x - pose["x"], goal_y - pose["y"]
        distance = math.sqrt(dx * dx + dy * dy)
        nearer = 0
        for x, y in self.heard.values():
            nearer += math.sqrt((goal_x - x) * (goal_x - x) + (goal_y - y) * (goal_y - y)) < distance
        v = w = 0.0
        notes = []
        if self.has_arrived or distance < 0.4 + 0.6 * nearer:
            if not self.has_arrived:
                notes = [{"kind": "arrived", "data": {"distance": distance}}]
            self.has_arrived = True
        else:
            s, c = sine(pose["heading"]), cosine(pose["heading"])
            ahead, left = (c * dx + s * dy) / distance, (c * dy - s * dx) / distance
            scan = struct.unpack(f"<{len(observation['scan']) // 4}f", observation["scan"])
            third = len(scan) // 6
            near = min(1.0, max(0.0, min(scan[third : len(scan) - third]) - 0.4))
            v = self.speed * max(0.0, ahead) * near
            w = 2.0 * left if ahead > 0.0 else 1.0
        outbox = []
        if observation["tick"] % 20 == self.robot % 20:
            payload = struct.pack("<2d", pose["x"], pose["y"])
            outbox = [{"destination": 0, "payload": payload, "msdu_bytes": 16, "lifetime_ns": 0}]
        return {
            "v": WIRE_VERSION,
            "tick": observation["tick"],
            "incarnation": self.incarnation,
            "twist": {"v": v, "w": w},
            "outbox": outbox,
            "speed": abs(v),
            "remaining_distance": distance,
            "status": None,
            "notes": notes,
            "values": {"to_goal": distance, "heard": float(len(self.heard))},
        }


def sine(angle: float) -> float:
    arc = 4.0 / PI * angle - 4.0 / (PI * PI) * angle * abs(angle)
    return 0.775 * arc + 0.225 * arc * abs(arc)


def cosine(angle: float) -> float:
    return sine(angle + PI / 2.0 if angle <= PI / 2.0 else angle - 3.0 * PI / 2.0)


def identity(name: str, keys: str | None) -> dict[str, Any]:
    """What Zenoh has to know of who this is: a certificate, or else a password."""
    if keys is None:
        secret = os.environ["ONEHOP_PASSWORD"]
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
            "transport/unicast/lowlatency": True,
            **identity(name, keys),
        }
        config = zenoh.Config()
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
        self._session = zenoh.open(config)
        self._mission, self._name = mission, name
        self._queue: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
        self._kept = [self._session.declare_subscriber(f"{mission}/to/{name}/**", self._hear)]
        world = f"{mission}/alive/world"
        liveliness = self._session.liveliness()
        self._kept.append(liveliness.declare_subscriber(world, self._see_world, history=True))

    def _hear(self, sample: zenoh.Sample) -> None:
        self._queue.put((str(sample.key_expr).rpartition("/")[2], sample.payload.to_bytes()))

    def _see_world(self, sample: zenoh.Sample) -> None:
        there = sample.kind == zenoh.SampleKind.PUT
        self._queue.put(("world is there" if there else "world is gone", b""))

    def say(self, what: str, data: bytes) -> None:
        for word, piece in in_parts(what, data):
            key = f"{self._mission}/from/{self._name}/{word}"
            self._session.put(key, piece, express=True, congestion_control=zenoh.CongestionControl.BLOCK)

    def briefing(self) -> Any:
        """Asked for until it is given."""
        deadline = time.monotonic() + 30.0
        while time.monotonic() < deadline:
            self.say("arrival", b"")
            answer = b""
            for reply in self._session.get(
                f"{self._mission}/config/{self._name}",
                timeout=2.0,
                consolidation=zenoh.ConsolidationMode.NONE,
            ):
                if reply.ok is not None:
                    answer += reply.ok.payload.to_bytes()
                    if reply.ok.attachment is None:  # those with one are followed by more
                        return decoded(answer)
            time.sleep(0.02)
        sys.exit("the world gave no briefing")

    def announce(self) -> None:
        token = f"{self._mission}/alive/{self._name}"
        self._kept.append(self._session.liveliness().declare_token(token))

    def messages(self) -> Iterator[tuple[str, bytes]]:
        """What is said to this robot, with its parts put together."""
        parts = b""
        is_excused = True  # for having been away: it starts, or was told that it would be stopped
        while True:
            what, data = self._queue.get()
            if what == "part":
                parts += data
                continue
            data, parts = parts + data, b""
            if what == "world is gone":
                if not (is_excused and self._world_comes_back()):
                    sys.exit(3)
            elif what != "world is there":
                is_asked = what in ("percept", "observation")
                is_excused = what in ("stop", "wake") or (is_excused and not is_asked)
                yield what, data

    def _world_comes_back(self) -> bool:
        """A process that was stopped for long has lost its session; Zenoh opens it again."""
        deadline = time.monotonic() + 10.0
        while (left := deadline - time.monotonic()) > 0.0:
            try:
                if self._queue.get(timeout=left)[0] == "world is there":
                    return True
            except queue.Empty:
                break
        return False

    def has_more(self) -> bool:
        return not self._queue.empty()

    def close(self) -> None:
        self._session.close()


def in_parts(what: str, data: bytes) -> Iterator[tuple[str, bytes]]:
    """A message under its name, and what is too long for the link before it, as parts."""
    while len(data) > PART_BYTES:
        yield "part", data[:PART_BYTES]
        data = data[PART_BYTES:]
    yield what, data


def decoded(data: bytes) -> Any:
    message = msgpack.unpackb(data)
    if message["v"] != WIRE_VERSION:
        sys.exit(f"the world speaks version {message['v']} of the wire, this robot {WIRE_VERSION}")
    return message


def acted(
    number: int, robot: Simple, seen: dict[str, Any], heard: list[dict[str, Any]]
) -> dict[str, Any]:
    """A step in real time, and what went into it."""
    receptions = [one["reception"] for one in heard if one.get("reception") is not None]
    action = robot.step(seen, {"receptions": receptions})
    numbers = [one["number"] for one in heard]
    packed = msgpack.packb(action)
    return {"v": WIRE_VERSION, "number": number, "heard": numbers, "action": packed}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mission", required=True)
    parser.add_argument("--lifeline", type=int)
    parser.add_argument("--id", type=int, required=True)
    parser.add_argument("--connect", required=True)
    parser.add_argument("--keys")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for whoever started the mission
    bus = Bus(options.mission, f"robot-{options.id}", options.connect, options.keys)
    robot = Simple(bus.briefing())
    bus.announce()
    heard: list[dict[str, Any]] = []
    newest: bytes | None = None
    steps = 0
    for what, data in bus.messages():
        try:
            if what == "percept":
                _, ((_, observation), (_, inbox)) = msgpack.unpackb(data)
                bus.say("out", msgpack.packb(robot.step(decoded(observation), decoded(inbox))))
            elif what == "heard":
                heard.append(decoded(data))
            elif what == "observation":
                newest = data
            if newest is not None and not bus.has_more():
                steps += 1
                bus.say("acted", msgpack.packb(acted(steps, robot, decoded(newest), heard)))
                newest, heard = None, []
        except Exception as error:
            traceback.print_exc()
            bus.say("failed", f"{type(error).__name__}: {error}".encode())
            bus.close()
            return 4
        if what in ("stop", "wake"):
            bus.say("awake", b"")
        elif what == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        elif what == "end":
            break
    bus.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
