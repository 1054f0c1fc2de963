"""Links as they are measured: `python bench/links.py [--figure FILE]` prints one JSON object.

A robot walks away from another that stands, and comes back the same way, and gets a message of 800 B
every 50 ms; what it measures is 8 * 800 B over the time from service to arrival, 0 for a lost one. The
same walk under the draw of each frame, under shadowing between places, and under Rayleigh fading, at the
thesis's mean SNR. Then what the radio costs with them. Documented in docs/links.md.
"""

import argparse
import json
import time
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from radio import PERIOD, TICKS_PER_SECOND, Mission, Outboxes

from onehop.contracts.arrays import FloatArray
from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.geometry import Pose, Twist
from onehop.contracts.messages import DeliveryStatus, Presence, Transmission, TransmitRequest, Truth
from onehop.contracts.radio_section import RadioSection
from radio_proxy.core.radio import Radio

MSDU_BYTES = 800
THRESHOLD_BPS = 0.5333e6
NEAREST, FARTHEST, SPEED = 3.0, 28.0, 0.5
"""The walk [m], [m/s]."""

KINDS = {
    "one draw for each frame, 4 dB (preset thesis)": RadioSection(routing="direct"),
    "shadowing of places, 9 dB, 1/e after 1.8 m": RadioSection(
        routing="direct", shadowing_db=0.6, spatial_shadowing_db=9.0
    ),
    "Rayleigh fading": RadioSection(routing="direct", shadowing_db=0.6, fast_fading="rayleigh"),
}

COLUMNS = {
    "thesis": RadioSection(),
    "shadowing": RadioSection(spatial_shadowing_db=4.0),
    "rayleigh": RadioSection(fast_fading="rayleigh"),
}
"""What the cost is measured of; otherwise alike."""


def walk(section: RadioSection, seed: int) -> tuple[FloatArray, FloatArray]:
    """Distances [m] and throughputs [bit/s] out and back, (2, messages) each; back is turned round."""
    robots = (1, 2)
    radio = Radio(RadioBriefing(seed, PERIOD, robots, section, ()))
    one_way = round((FARTHEST - NEAREST) / SPEED * TICKS_PER_SECOND)
    steps = np.linspace(NEAREST, FARTHEST, one_way)
    places = np.concatenate((steps, steps[::-1]))
    measured = np.zeros(len(places))
    outbox = (Transmission(2, b"", MSDU_BYTES, 0),)
    requests = (TransmitRequest(1, 0.0, 0.0, outbox), TransmitRequest(2, SPEED, 0.0, ()))
    still = Twist(0.0, 0.0)
    for tick, x in enumerate(places.tolist(), 1):
        present = (
            Presence(1, 0, Pose(0.0, 0.0, 0.0), still, False),
            Presence(2, 0, Pose(x, 0.0, 0.0), Twist(SPEED, 0.0), False),
        )
        truth = Truth(tick, tick * PERIOD, present, requests, (), (), (), ())
        for verdict in radio.carry(truth).record.verdicts:
            if verdict.status is DeliveryStatus.DELIVERED:
                taken = (verdict.arrival_ns - verdict.service_start_ns) / 1e9
                measured[verdict.offered_ns // PERIOD] = 8.0 * MSDU_BYTES / taken
    return np.stack((steps, steps)), np.stack((measured[:one_way], measured[one_way:][::-1]))


def smoothed(values: FloatArray, count: int) -> FloatArray:
    """Means of `count` neighbours, along the last axis."""
    whole = values.shape[-1] // count * count
    means: FloatArray = values[..., :whole].reshape(*values.shape[:-1], -1, count).mean(axis=-1)
    return means


def place_share(seeds: int, section: RadioSection) -> dict[str, float]:
    """What of the throughput's variance is the place's: between out and back, beyond the distance's.

    Per 0.25 m of way; the mean over the seeds at each distance is taken off first.
    """
    runs = np.array([smoothed(walk(section, seed)[1], 10) for seed in range(1, seeds + 1)])
    rest = runs - runs.mean(axis=(0, 1))
    return {
        "mean_mbps": round(float(runs.mean()) / 1e6, 4),
        "std_beyond_distance_mbps": round(float(rest.std()) / 1e6, 4),
        "correlation_out_and_back": round(
            float(np.corrcoef(rest[:, 0].ravel(), rest[:, 1].ravel())[0, 1]), 3
        ),
        "share_below_threshold": round(float((runs < THRESHOLD_BPS).mean()), 3),
    }


def figure(file: Path) -> None:
    """Throughput over distance, out and back, one panel a kind."""
    drawn = Figure(figsize=(9.0, 7.0), layout="constrained")
    for axes, (name, section) in zip(drawn.subplots(3, 1, sharex=True), KINDS.items(), strict=True):
        distances, measured = walk(section, 1)
        for way, label, colour in ((0, "out", "tab:blue"), (1, "back", "tab:orange")):
            axes.plot(
                smoothed(distances[way], 10),
                smoothed(measured[way], 10) / 1e6,
                color=colour, label=label, linewidth=1.2, alpha=0.8,
            )  # fmt: skip
        axes.axhline(THRESHOLD_BPS / 1e6, color="grey", linewidth=0.8, linestyle=":")
        axes.set_title(name, fontsize=10)
        axes.set_ylabel("Mb/s")
        axes.set_ylim(0.0, 0.9)
    axes.set_xlabel("distance of the two robots [m]")
    axes.legend(loc="lower left")
    with mpl.rc_context({"svg.hashsalt": "onehop"}):
        drawn.savefig(file, dpi=110, metadata={"Software": None})


def cost(robots: int, section: RadioSection, seconds: int) -> dict[str, float]:
    """Processor time of ticks in which all robots move: six talk in all pairs, more as in the thesis."""
    mission = Mission(robots, 3.0 if robots < 10 else 1.5, section)
    leader = (robots + 1) // 2
    followers = [i for i in mission.robots if i != leader]
    standing = mission.present
    outboxes: Outboxes = {}
    for tick in range(seconds * TICKS_PER_SECOND):
        shift = 0.075 * tick
        mission.present = tuple(
            Presence(p.robot, 0, Pose(p.pose.x + shift, p.pose.y, 0.0), Twist(1.5, 0.0), False)
            for p in standing
        )
        if robots < 10:
            outboxes = {
                i: tuple(Transmission(j, b"", MSDU_BYTES, 0) for j in mission.robots if j != i)
                for i in mission.robots
            }
        elif tick % 40 == 0:
            outboxes[leader] = tuple(Transmission(i, b"", MSDU_BYTES, 0) for i in followers)
        mission.step(outboxes)
        outboxes = {i: (Transmission(leader, b"", 60, 0),) for i in followers if mission.received[i]}
    return mission.figures()


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--figure", type=Path, help="write the walk as a PNG")
    options.add_argument("--seeds", type=int, default=20)
    options.add_argument("--seconds", type=int, default=20, help="simulated, of the cost")
    chosen = options.parse_args()
    if chosen.figure is not None:
        figure(chosen.figure)
    begin = time.process_time()
    report: dict[str, object] = {
        "walks": {name: place_share(chosen.seeds, section) for name, section in KINDS.items()},
        "walks_took_s": round(time.process_time() - begin, 1),
        "cost": {
            f"{robots} robots": {
                name: cost(robots, section, chosen.seconds) for name, section in COLUMNS.items()
            }
            for robots in (6, 50)
        },
    }
    print(json.dumps(report, indent=1))


if __name__ == "__main__":
    main()
