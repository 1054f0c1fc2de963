"""How fast the radio is: `python bench/radio.py` prints one JSON object.

The peer is ns-3 3.44: six stations, all pairs every 50 ms, simulated in the same run by the interpreter
that --python names (bench/ns3.py says how to get it). Without it the ratio is to what was recorded on
the same kind of cores, 11.4 times real time. Both sides are measured in processor time; `loop_ns`, one
turn of a bare Python loop before and after, says how busy the machine was meanwhile.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable

from msgspec import structs
from radio_validation.cases import Run
from radio_validation.peer import Ns3, installed

from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import DeliveryStatus, Presence, Transmission, TransmitRequest, Truth
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.airtime import dsss
from radio_proxy.core.link_budget import link_budget
from radio_proxy.core.link_rules import link_rules
from radio_proxy.core.radio import Radio
from radio_proxy.core.saturation import Saturation, ring

RECORDED_NS3_REAL_TIME_FACTOR = 11.4
PERIOD = 50_000_000
TICKS_PER_SECOND = 20
Outboxes = dict[int, tuple[Transmission, ...]]


class Mission:
    """Robots that stand on a grid, one radio, and the processor time of each tick."""

    def __init__(self, robots: int, spacing: float, section: RadioSection) -> None:
        columns = max(1, round(robots**0.5))
        self.robots = tuple(range(1, robots + 1))
        self.present = tuple(
            Presence(
                i,
                0,
                Pose(spacing * ((i - 1) % columns), spacing * ((i - 1) // columns), 0.0),
                Twist(0, 0),
                False,
            )
            for i in self.robots
        )
        self.radio = Radio(RadioBriefing(1, PERIOD, self.robots, section, ()))
        self.tick = 0
        self.seconds: list[float] = []
        self.delivered = 0
        self.received: dict[int, int] = {}

    def step(self, outboxes: Outboxes) -> None:
        requests = tuple(TransmitRequest(i, 1.0, 50.0, outboxes.get(i, ())) for i in self.robots)
        truth = Truth(self.tick, self.tick * PERIOD, self.present, requests, (), (), (), ())
        begin = time.process_time()
        carriage = self.radio.carry(truth)
        self.seconds.append(time.process_time() - begin)
        self.tick += 1
        self.delivered += sum(v.status is DeliveryStatus.DELIVERED for v in carriage.record.verdicts)
        self.received = {i: len(inbox.receptions) for i, inbox in carriage.inboxes.items()}

    def figures(self) -> dict[str, float]:
        ordered = sorted(self.seconds)
        return {
            "mean_ms": round(1e3 * sum(ordered) / len(ordered), 4),
            "p50_ms": round(1e3 * ordered[len(ordered) // 2], 4),
            "p99_ms": round(1e3 * ordered[len(ordered) * 99 // 100], 4),
            "real_time_factor": round(len(ordered) / TICKS_PER_SECOND / sum(ordered), 1),
            "delivered": self.delivered,
        }


def loop_ns() -> float:
    """Processor time of one turn of a bare loop [ns]: the yardstick of this machine at this moment."""
    turns = 300_000
    begin = time.process_time()
    for _ in range(turns):
        pass
    return round((time.process_time() - begin) / turns * 1e9, 1)


def idle(robots: int) -> dict[str, float]:
    """Microseconds of a tick in which nobody transmits; the best of five runs."""
    mission = Mission(robots, 3.0, RadioSection())
    truth = Truth(0, 0, mission.present, (), (), (), (), ())
    best = float("inf")
    for _ in range(5):
        begin = time.process_time()
        for _ in range(2000):
            mission.radio.carry(truth)
        best = min(best, (time.process_time() - begin) / 2000)
    return {"robots": robots, "us_per_tick": round(best * 1e6, 2)}


def ns3_real_time_factor(mission: Mission, section: RadioSection, seconds: int, ns3: Ns3) -> float:
    """The same stations and messages on ns-3: simulated seconds in a second of its processor time."""
    places = tuple((p.pose.x, p.pose.y) for p in mission.present)
    each = range(len(places))
    run = Run(
        seed=1,
        seconds=float(seconds),
        places=places,
        paths=tuple((i, j) for i in each for j in each if i != j),
        period_s=PERIOD / 1e9,
        rate_mbps=section.rate_mbps,
        rts_threshold_bytes=section.rts_threshold_bytes,
        fading_db=4.0,
    )
    return seconds / float(ns3.simulate(run.as_json())["cpu_s"])


def all_pairs(
    rate_mbps: float, rts_threshold_bytes: int, seconds: int, ns3: Ns3 | None
) -> dict[str, object]:
    """Six stations, each with a message for every other one every 50 ms; beside ns-3 if it is here."""
    section = RadioSection(
        routing="direct", rate_mbps=rate_mbps, rts_threshold_bytes=rts_threshold_bytes
    )
    mission = Mission(6, 3.0, section)
    outboxes = {
        i: tuple(Transmission(j, b"", 800, 0) for j in mission.robots if j != i) for i in mission.robots
    }
    for _ in range(seconds * TICKS_PER_SECOND):
        mission.step(outboxes)
    figures = mission.figures()
    peer = {"ratio_to_recorded_ns3": figures["real_time_factor"] / RECORDED_NS3_REAL_TIME_FACTOR}
    if ns3 is not None:
        factor = ns3_real_time_factor(mission, section, seconds, ns3)
        peer = {"ns3_real_time_factor": factor, "ratio_to_ns3": figures["real_time_factor"] / factor}
    return {
        "rate_mbps": rate_mbps,
        "rts_cts": rts_threshold_bytes == 0,
        **{key: round(value, 1) for key, value in peer.items()},
        **figures,
    }


def team(robots: int, routing: str, spacing: float, seconds: int) -> dict[str, object]:
    """The thesis's traffic: a Next of 800 B to every follower every 2 s, 60 B back."""
    mission = Mission(robots, spacing, RadioSection(routing=routing))  # type: ignore[arg-type]
    leader = (robots + 1) // 2
    followers = [i for i in mission.robots if i != leader]
    outboxes: Outboxes = {}
    for tick in range(seconds * TICKS_PER_SECOND):
        if tick % 40 == 0:
            outboxes[leader] = tuple(Transmission(i, b"", 800, 0) for i in followers)
        mission.step(outboxes)
        outboxes = {i: (Transmission(leader, b"", 60, 0),) for i in followers if mission.received[i]}
    return {"robots": robots, "routing": routing, "spacing_m": spacing, **mission.figures()}


def sparse(robots: int) -> dict[str, object]:
    """Time that one message a tick costs a pair alone in reach of each other, above an idle tick."""
    section = RadioSection(routing="direct", path_loss_exponent=4.0)
    means = []
    talk: Outboxes = {1: (Transmission(2, b"", 800, 0),)}
    for outboxes in ({}, talk):
        mission = Mission(robots, 80.0, section)
        first, second, *others = mission.present
        near = structs.replace(second, pose=Pose(first.pose.x + 1.0, first.pose.y, 0.0))
        mission.present = (first, near, *others)
        for _ in range(20 * TICKS_PER_SECOND):
            mission.step(outboxes)
        means.append(mission.figures()["mean_ms"])
    return {
        "robots": robots,
        "delivered": mission.delivered,
        "ms_above_idle": round(means[1] - means[0], 4),
    }


def engine(stations: int, seconds: float) -> dict[str, object]:
    """A saturated cell with and without the shortcut of quiet exchanges, one after the other."""
    section = RadioSection(shadowing_db=0.0)
    cost = {}
    for name, shortcuts in (("shortcuts", True), ("played_out", False)):
        load = ring(stations, 800, True)
        budget, rules = link_budget(section), link_rules(section)
        run = Saturation(load, dsss(section), budget, 1, rules, take_shortcuts=shortcuts)
        begin = time.process_time()
        tally = run.run(seconds)
        cost[name] = (time.process_time() - begin) / sum(tally.delivered) * 1e6
    return {"stations": stations, **{f"us_per_message_{k}": round(v, 1) for k, v in cost.items()}}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", default=sys.executable, help="the interpreter that has ns-3")
    python = parser.parse_args().python
    version = installed(python)
    ns3 = Ns3(python) if version else None
    sections: dict[str, Callable[[], object]] = {
        "idle": lambda: [idle(6), idle(50)],
        "six_stations_all_pairs_every_50_ms": lambda: [
            all_pairs(1.0, 0, 20, ns3),
            all_pairs(11.0, 0, 10, ns3),
            all_pairs(11.0, 2304, 10, ns3),
        ],
        "thesis_traffic": lambda: [
            team(6, "mrdv", 3.0, 60),
            team(6, "mrsr", 3.0, 60),
            team(50, "direct", 1.5, 40),
            team(50, "mrdv", 1.5, 40),
            team(50, "mrsr", 1.5, 40),
        ],
        "one_pair_among_robots_out_of_reach": lambda: [sparse(n) for n in (16, 64, 256)],
        "event_engine": lambda: [engine(n, 20.0) for n in (2, 6, 20)],
    }
    recorded = f"ns-3 3.44 at {RECORDED_NS3_REAL_TIME_FACTOR} x real time, recorded: not installed here"
    report: dict[str, object] = {"peer": f"ns-3 {version}, in this run" if version else recorded}
    for name, section in sections.items():
        before = loop_ns()
        rows = section()
        report[name] = {"loop_ns": [before, loop_ns()], "rows": rows}
    if ns3 is not None:
        ns3.close()
    print(json.dumps(report, indent=1))


if __name__ == "__main__":
    main()
