"""Missions in real time: late ticks, how exactly receptions come to robots, CPU of each process.

Prints one JSON object. The delay error of a reception is the instant at which it was in its robot's
process, less the instant at which its last bit arrived by the world's schedule, both on the
CLOCK_MONOTONIC of this host. CPU is in percent of one core, from start to end of each process, its
imports included.
"""

import argparse
import json
import resource
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from onehop.mission import launcher
from onehop.scenario import scenario_file
from onehop.wire.output_folder import claimed

SIDE = 400.0
"""Length of a side of the open map [m]."""

SCENARIO = """
name = "realtime"
seed = 1
map = {{ width = {side}, height = {side} }}
start = {{ x = 60, y = 200 }}
goal = {{ x = 390, y = 200 }}
[team]
size = {robots}
[clock]
mode = "realtime"
speed = {speed}
limit_s = {limit_s}
"""


def main() -> None:
    if "--as-robot" in sys.argv:
        as_robot()
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robots", type=int, nargs="+", default=[6, 24, 50])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--speed", type=float, default=1.0)
    options = parser.parse_args()
    found = [measure(robots, options.seconds, options.speed) for robots in options.robots]
    print(json.dumps({"seconds": options.seconds, "missions": found}, indent=1))


def measure(robots: int, seconds: float, speed: float) -> dict[str, Any]:
    """One mission of so many robots for so many seconds of the wall clock."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        scenario = folder / "realtime.toml"
        text = SCENARIO.format(side=SIDE, robots=robots, speed=speed, limit_s=seconds * speed)
        command = json.dumps(["python", str(Path(__file__).absolute()), "--as-robot", name])
        entries = [f"[[robots]]\nid = {i}\ncommand = {command}\n" for i in range(1, robots + 1)]
        scenario.write_text(text + "".join(entries))
        bundle = scenario_file.load(scenario)
        out = folder / "out"
        before = _children_s()
        with claimed(out) as claim:
            plan = launcher.plan(bundle, (str(scenario),), out, claim, record=True)
            summary = launcher.run(plan, lambda _: None, lambda line: print(line, file=sys.stderr))
        told = [json.loads(path.read_text()) for path in sorted(folder.glob("robot-*.json"))]
        all_s = _children_s() - before
    return report(robots, summary, told, all_s)


def report(
    robots: int, summary: dict[str, Any], told: list[dict[str, Any]], all_s: float
) -> dict[str, Any]:
    """What is printed of one mission. told: by its robots. all_s: CPU of all of its processes [s]."""
    timing = summary["realtime"]
    start_s, speed = timing["start_s"], timing["speed"]
    errors = sorted(
        1e3 * (received_s - start_s - arrival_ns / 1e9 / speed)
        for one in told
        for received_s, arrival_ns in one["receptions"]
    )
    shares = [100.0 * one["cpu_s"] / one["wall_s"] for one in told]
    rest_s = all_s - sum(one["cpu_s"] for one in told)
    return {
        "robots": robots,
        "outcome": summary["reason"],
        "ticks": summary["ticks"],
        **timing,
        "receptions": len(errors),
        "delay_error_ms": _percentiles(errors) if errors and not timing["moved_ms"] else None,
        "cpu_percent_per_robot": round(statistics.mean(shares), 2) if shares else None,
        "cpu_percent_world_radio_recorder": round(100.0 * rest_s / summary["wall_s"], 1),
    }


def _percentiles(values: list[float]) -> dict[str, float]:
    at = {"p50": 0.5, "p90": 0.9, "p99": 0.99, "max": 1.0}
    return {name: round(values[round(share * (len(values) - 1))], 3) for name, share in at.items()}


def _children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def as_robot() -> None:
    """A robot of the team that notes when receptions come to it, and what it has cost."""
    from onehop.node import startup
    from robot_agent import process
    from robot_agent.latest_data import LatestData

    at = sys.argv.index("--as-robot")
    folder = Path(sys.argv[at + 1])
    del sys.argv[at : at + 2]
    receptions: list[tuple[float, int]] = []

    class Noting(LatestData):
        def on_heard(self, data: bytes) -> None:
            now_s = time.monotonic()
            super().on_heard(data)
            reception = self._heard[-1].reception
            if reception is not None:
                receptions.append((now_s, reception.arrival_ns))

    process.LatestData = Noting  # type: ignore[misc]
    started_s = time.monotonic()

    def body() -> int:
        status = process.main()
        number = sys.argv[sys.argv.index("--id") + 1]
        wall_s = time.monotonic() - started_s
        told = {"receptions": receptions, "cpu_s": time.process_time(), "wall_s": wall_s}
        (folder / f"robot-{number}.json").write_text(json.dumps(told))
        return status

    startup.main(body)


if __name__ == "__main__":
    main()
