"""Both routing protocols where links fade: `python bench/random_nets.py` prints one JSON object.

Ten robots at rest at random places of which every one is in mean reach of the rest over relays; five
flows of a message of 800 B every half second for a minute, with a fading of 4 dB that is drawn for
every frame. Of each net: the share that was delivered, the delay from handing over to arrival, and the
bytes of routing packets (source routes apart). --shadowing 0 gives the same nets without fading.
"""

import argparse
import json
import random
import statistics

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import DeliveryStatus, Presence, Transmission, TransmitRequest, Truth
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.radio import Radio

PERIOD = 50_000_000
TICKS_PER_SECOND = 20
ROBOTS = 10
SIDE = 50.0
RANGE = 25.1
FLOWS = 5
TALKING_S, WAITING_S = 60, 30
Place = tuple[float, float]


def places(seed: int) -> list[Place]:
    """Random places in a square, drawn until they are one net [m]."""
    dice = random.Random(seed)
    while True:
        drawn = [(dice.uniform(0, SIDE), dice.uniform(0, SIDE)) for _ in range(ROBOTS)]
        reached, edge = {0}, [0]
        while edge:
            x, y = drawn[edge.pop()]
            near = {i for i, (a, b) in enumerate(drawn) if (a - x) ** 2 + (b - y) ** 2 <= RANGE**2}
            edge += sorted(near - reached)
            reached |= near
        if len(reached) == ROBOTS:
            return drawn


def net(routing: str, seed: int, shadowing_db: float) -> dict[str, float]:
    """One net under one protocol."""
    section = RadioSection(routing=routing, shadowing_db=shadowing_db)  # type: ignore[arg-type]
    robots = tuple(range(1, ROBOTS + 1))
    present = tuple(
        Presence(i, 0, Pose(x, y, 0.0), Twist(0.0, 0.0), False)
        for i, (x, y) in zip(robots, places(seed), strict=True)
    )
    dice = random.Random(seed)
    flows = [tuple(dice.sample(robots, 2)) for _ in range(FLOWS)]
    starts = [dice.randrange(TICKS_PER_SECOND // 2) for _ in flows]
    radio = Radio(RadioBriefing(seed, PERIOD, robots, section, ()))
    verdicts = []
    counted: dict[str, int] = {}
    for tick in range((TALKING_S + WAITING_S) * TICKS_PER_SECOND):
        outboxes: dict[int, list[Transmission]] = {robot: [] for robot in robots}
        if tick < TALKING_S * TICKS_PER_SECOND:
            for (source, destination), start in zip(flows, starts, strict=True):
                if tick % (TICKS_PER_SECOND // 2) == start:
                    outboxes[source].append(Transmission(destination, b"", 800, 0))
        requests = tuple(TransmitRequest(i, 0.0, 0.0, tuple(outboxes[i])) for i in robots)
        record = radio.carry(Truth(tick, tick * PERIOD, present, requests, (), (), (), ())).record
        verdicts += record.verdicts
        counted = record.control_bytes
    arrived = [v for v in verdicts if v.status is DeliveryStatus.DELIVERED]
    delays = sorted((v.arrival_ns - v.offered_ns) / 1e9 for v in arrived)
    return {
        "delivered_share": round(len(arrived) / len(verdicts), 3),
        "median_s": round(statistics.median(delays), 4),
        "p95_s": round(delays[len(delays) * 95 // 100], 3),
        "hops": round(statistics.fmean(len(v.path) - 1 for v in arrived), 2),
        "routing_kB": round((sum(counted.values()) - counted.get("source_route", 0)) / 1e3, 1),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nets", type=int, default=10)
    parser.add_argument("--shadowing", type=float, default=4.0)
    options = parser.parse_args()
    report = {}
    for routing in ("mrsr", "mrdv"):
        rows = [net(routing, seed, options.shadowing) for seed in range(1, options.nets + 1)]
        means = {key: round(statistics.fmean(row[key] for row in rows), 4) for key in rows[0]}
        report[routing] = {"mean": means, "nets": rows}
    print(json.dumps({"shadowing_db": options.shadowing, **report}, indent=1))


if __name__ == "__main__":
    main()
