"""How exactly the radio hands out receptions in real time: the radio process alone, and six that listen.

Prints one JSON object. This program is the world: truths come by the schedule, and five robots a tick
hand over a broadcast at random instants. Nobody computes anything but the radio, so that the error of a
reception (when it was read in its receiver's process, less when its last bit arrived by the schedule, on
CLOCK_MONOTONIC) is that of radio and bus. With whole robots, bench/realtime.py adds their wait for a
core.
"""

import argparse
import json
import multiprocessing
import random
import subprocess
import sys
import time
from multiprocessing.queues import Queue

from onehop.contracts import topics
from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import BROADCAST, Presence, Transmission, TransmitRequest, Truth
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.realtime import Handed, Heard, Placed
from onehop.mission.processes import free_endpoint
from onehop.node import startup
from onehop.node.bus import Bus, open_client, open_router
from onehop.wire.codec import decode, encode

PERIOD_S = 0.05
TALKERS = 5
"""Robots that hand over a message in a tick."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robots", type=int, default=6)
    parser.add_argument("--seconds", type=float, default=20.0)
    options = parser.parse_args()
    robots = tuple(range(1, options.robots + 1))
    endpoint = free_endpoint()
    spawn = multiprocessing.get_context("spawn")
    results: Queue[list[tuple[float, int]]] = spawn.Queue()
    with open_router("bench", endpoint) as bus:
        bus.watch("*")
        command = [sys.executable, "-m", "radio_proxy", "--mission", "bench", "--connect", endpoint]
        listeners = [
            spawn.Process(target=listen, args=(endpoint, robot, results), daemon=True)
            for robot in robots
        ]
        for one in listeners:
            one.start()
        briefing = encode(RadioBriefing(1, round(PERIOD_S * 1e9), robots, RadioSection(), (), speed=1.0))
        with bus.answering(topics.config("*"), lambda _: briefing):
            radio = subprocess.Popen(command)
            present: set[str] = set()
            while len(present) < options.robots + 1:
                present.add(bus.receive()[0])
        startup.be_on_time()
        start_s = play(bus, robots, options.seconds)
        time.sleep(1.0)
        for name in (topics.RADIO, *map(topics.robot_name, robots)):
            bus.publisher(topics.to(name, topics.END))(b"")
        heard = [one for _ in robots for one in results.get(timeout=20.0)]
        radio.wait(20.0)
    errors = sorted(1e3 * (read_s - start_s - arrival_ns / 1e9) for read_s, arrival_ns in heard)
    at = {"p50": 0.5, "p90": 0.9, "p99": 0.99, "max": 1.0}
    shown = {name: round(errors[round(share * (len(errors) - 1))], 3) for name, share in at.items()}
    print(json.dumps({"robots": options.robots, "receptions": len(errors), "delay_error_ms": shown}))


def play(bus: Bus, robots: tuple[int, ...], seconds: float) -> float:
    """Be the world for a while; the instant of simulated time 0."""
    place = bus.publisher(topics.to(topics.RADIO, topics.PLACED))
    hand = bus.publisher(topics.to(topics.RADIO, topics.HANDED))
    rng = random.Random(1)
    outbox = (Transmission(BROADCAST, bytes(60), 100, 0),)
    start_s = time.monotonic() + 0.1
    for tick in range(round(seconds / PERIOD_S)):
        begin_s = start_s + tick * PERIOD_S
        talking = sorted((rng.uniform(0.0, 0.9 * PERIOD_S), rng.choice(robots)) for _ in range(TALKERS))
        _sleep_until(bus, begin_s)
        place(encode(Placed(_clock_ns(start_s), 0, _truth(tick, robots))))
        for offset_s, robot in talking:
            _sleep_until(bus, begin_s + offset_s)
            hand(encode(Handed(_clock_ns(start_s), TransmitRequest(robot, 0.0, 0.0, outbox))))
    return start_s


def _clock_ns(start_s: float) -> int:
    return max(0, round((time.monotonic() - start_s) * 1e9))


def _sleep_until(bus: Bus, instant_s: float) -> None:
    while bus.receive_by(instant_s) is not None:
        pass


def _truth(tick: int, robots: tuple[int, ...]) -> Truth:
    still = Twist(0.0, 0.0)
    present = tuple(Presence(i, 0, Pose(2.0 * i, 0.0, 0.0), still, held=False) for i in robots)
    return Truth(tick, round(tick * PERIOD_S * 1e9), present, (), (), (), (), ())


def listen(endpoint: str, robot: int, results: "Queue[list[tuple[float, int]]]") -> None:
    """A robot's process that notes when receptions come to it."""
    name = topics.robot_name(robot)
    found: list[tuple[float, int]] = []
    with open_client("bench", endpoint, name, None) as bus:
        startup.be_on_time(is_ours=False)
        bus.announce(name)
        while (received := bus.receive())[0] != topics.END:
            read_s = time.monotonic()
            reception = decode(Heard, received[1]).reception
            if reception is not None:
                found.append((read_s, reception.arrival_ns))
    results.put(found)


if __name__ == "__main__":
    main()
