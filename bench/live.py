"""What the live page costs a mission: its lock-step rate with and without a viewer, in turn.

Prints one JSON object. The viewer is a process that asks for frames as a page does, and draws nothing: a
browser on the same cores takes what it takes. `server_cpu` is the share of a core that the launcher's
process takes with the page, less what it takes without; `mission_cpu_ms` what all processes of the
mission take for a tick, which other work on the machine moves less than the rate.
"""

import argparse
import json
import multiprocessing
import os
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from onehop.commands.live import live_page
from onehop.mission import launcher
from onehop.scenario import scenario_file
from onehop.wire.output_folder import claimed

SCENARIO = Path(__file__).parents[1] / "scenarios" / "map1.toml"

WANT = json.dumps({"kind": "want", "tick": -1, "since": -1, "robot": 1})
"""Always the newest frame, with a scan, as a page that has just been opened."""


class Cost(NamedTuple):
    """Of one mission. mission_cpu_ms: of its processes a tick. frames_per_s: that a viewer was sent."""

    ticks_per_s: float
    mission_cpu_ms: float
    cpu: float
    frames_per_s: float


def look_on(url: str, frames: Any) -> None:
    """Ask for one frame after the other until the page goes."""
    own = urlsplit(url)
    with connect(f"ws://{own.netloc}/feed/0?{own.query}", origin=f"http://{own.netloc}") as line:  # type: ignore[arg-type]
        line.recv()
        try:
            while True:
                line.send(WANT)
                line.recv()
                frames.value += 1
        except ConnectionClosed:
            return


def mission(robots: int, limit: float, viewers: int | None, folder: Path) -> Cost:
    """viewers: of the page; None for a mission without one."""
    settings = [f"team.size={robots}", f"clock.limit_s={limit}"]
    bundle = scenario_file.load(SCENARIO, settings)
    arguments = launcher.world_arguments(SCENARIO, settings, None, None, None, None)
    context = multiprocessing.get_context("spawn")
    frames = context.Value("q", 0)
    with claimed(folder) as claim:
        plan = launcher.plan(bundle, arguments, folder, claim, True)
        before, spent = time.process_time(), _of_children_s()
        if viewers is None:
            summary = launcher.run(plan, lambda _: None)
        else:
            with live_page("", False, folder, ()) as page:
                looking = [
                    context.Process(target=look_on, args=(page.server.url, frames), daemon=True)
                    for _ in range(viewers)
                ]
                for one in looking:
                    one.start()
                summary = launcher.run(plan, lambda _: None, attend=page.attend)
                used = time.process_time() - before
                spent_s = _of_children_s() - spent
            for one in looking:
                one.join(10.0)
            return _cost(summary, spent_s, used, frames.value / max(1, viewers))
        return _cost(summary, _of_children_s() - spent, time.process_time() - before, 0)


def _of_children_s() -> float:
    """CPU time of the children that have ended [s]: those of missions; viewers end after it is read."""
    times = os.times()
    return times.children_user + times.children_system


def _cost(summary: dict[str, Any], spent_s: float, used_s: float, frames: float) -> Cost:
    wall_s, ticks = float(summary["wall_s"]), int(summary["ticks"])
    return Cost(float(summary["ticks_per_s"]), 1e3 * spent_s / ticks, used_s / wall_s, frames / wall_s)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=6)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--viewers", type=int, default=1)
    parser.add_argument("--limit", type=float, default=120.0, help="simulated seconds of the mission")
    options = parser.parse_args()
    without: list[Cost] = []
    watched: list[Cost] = []
    with tempfile.TemporaryDirectory() as name:
        for _ in range(options.rounds):
            without.append(mission(options.robots, options.limit, None, Path(name)))
            watched.append(mission(options.robots, options.limit, options.viewers, Path(name)))
    plain, seen = (statistics.median(one.ticks_per_s for one in costs) for costs in (without, watched))
    cpu = statistics.median(a.cpu - b.cpu for a, b in zip(watched, without, strict=True))
    result = {
        "robots": options.robots,
        "rounds": options.rounds,
        "viewers": options.viewers,
        "ticks_per_s": {"without": round(plain, 1), "watched": round(seen, 1)},
        "watched_over_without": round(seen / plain, 3),
        "ratio_of_each_round": [
            round(a.ticks_per_s / b.ticks_per_s, 3) for a, b in zip(watched, without, strict=True)
        ],
        "mission_cpu_ms": {
            "without": round(statistics.median(one.mission_cpu_ms for one in without), 2),
            "watched": round(statistics.median(one.mission_cpu_ms for one in watched), 2),
        },
        "server_cpu": round(cpu, 3),
        "frames_per_s": round(statistics.median(one.frames_per_s for one in watched), 1),
    }
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
