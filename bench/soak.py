"""An hour of missions in real time: memory, threads, files and sockets of every process, as it goes on.

The first half of the time is one mission of a small team in a small room, whose robot 3 is killed and
started again every two minutes; the second half are short missions one after the other, all launched by
this process. Figures are from /proc, each 30 s, and in the second half of this process alone, after each
mission. Printed is a table with a line for each process: its memory when it was warm and at the end, the
slope of it with its 95 % interval, and how many threads, files and sockets it had in the first and the
last quarter of the time (medians, so that a start that is under way does not count). Ends with status 1
if any of the latter has grown by more than one: Zenoh's runtime keeps a thread more or less.
"""

import argparse
import json
import os
import statistics
import sys
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy

from onehop.mission import launcher
from onehop.scenario import scenario_file
from onehop.wire.output_folder import claimed

ROOM = """
name = "soak"
seed = 1
[map]
width = 40
height = 40
obstacles = [[[18, 24], [24, 24], [24, 30], [18, 30]]]
[start]
x = 8
y = 8
[goal]
x = 30
y = 14
[team]
size = {robots}
[robot]
leader_speed = {leader_speed}
[clock]
mode = "realtime"
speed = {speed}
limit_s = {limit_s}
"""

KILLS = """
[[faults]]
kind = "kill"
at_s = {at_s}
robots = [3]
[[faults]]
kind = "restart"
at_s = {again_s}
robots = [3]
"""

KILL_EVERY_S = 120.0

SHORT_S = 20.0
"""A mission of the loop, in simulated time [s]; at twice the speed of the clock it takes half of it."""

SHORT = {"leader_speed": 0.5, "speed": 2.0, "limit_s": SHORT_S}

WARM_S = 180.0
"""From when on a process is warm [s], at most a fifth of its time."""

SLOWEST = 0.01
"""Least speed that a scenario may give to a leader [m/s]."""

MOST_MINUTES = 70
"""At that speed, on a way of 23 m, the team is still under way when half of this is over."""

LAUNCHER = "launcher"


@dataclass(frozen=True, slots=True)
class Sample:
    """One process at one instant. at_s: since it was first seen [s]."""

    at_s: float
    rss_kb: int
    threads: int
    files: int
    sockets: int


class Watch:
    """Samples of this process and its children, by name; of a robot that is started again, all are one.

    every_s: between two [s].
    """

    def __init__(self, every_s: float) -> None:
        self.samples: dict[str, list[Sample]] = defaultdict(list)
        self._began: dict[str, float] = {}
        self._every_s = every_s
        self._over = threading.Event()

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Sample meanwhile, from a thread of its own."""
        thread = threading.Thread(target=self._watch)
        thread.start()
        try:
            yield
        finally:
            self._over.set()
            thread.join()

    def _watch(self) -> None:
        while not self._over.wait(self._every_s):
            self.look()
            for name, pid in _children():
                self._take(name, pid)

    def look(self) -> None:
        """Take one sample of this process."""
        self._take(LAUNCHER, os.getpid())

    def _take(self, name: str, pid: int) -> None:
        now_s = time.monotonic()
        began_s = self._began.setdefault(name, now_s)
        try:
            status = dict(
                line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines()
            )
            open_files = [os.readlink(entry.path) for entry in os.scandir(f"/proc/{pid}/fd")]
            rss_kb, threads = int(status["VmRSS"].split()[0]), int(status["Threads"])
        except (OSError, KeyError):
            return  # it has just ended
        sockets = sum(one.startswith("socket:") for one in open_files)
        self.samples[name].append(Sample(now_s - began_s, rss_kb, threads, len(open_files), sockets))


def _children() -> Iterator[tuple[str, int]]:
    """Name and id of each process that this one has started and that runs a program of the mission."""
    for thread in Path("/proc/self/task").iterdir():
        for pid in (thread / "children").read_text().split():
            try:
                words = Path(f"/proc/{pid}/cmdline").read_text().split("\0")
            except OSError:
                continue
            if "-m" in words:
                program = words[words.index("-m") + 1].removeprefix("onehop.")
                number = f" {words[words.index('--id') + 1]}" if "--id" in words else ""
                yield program + number, int(pid)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=6.0)
    parser.add_argument("--robots", type=int, default=3)
    parser.add_argument("--every", type=float, default=30.0, help="seconds between two samples")
    options = parser.parse_args()
    if not 0 < options.minutes <= MOST_MINUTES:
        parser.error(f"--minutes {options.minutes:g}: more than 0, and {MOST_MINUTES} at most")
    half_s, every_s = 30.0 * options.minutes, min(options.every, options.minutes)

    watch = Watch(every_s)
    with watch.watching():
        summary = _long(options.robots, half_s)
    print(f"one mission of {half_s / 60:g} min, {options.robots} robots: {_told(summary)}")
    grown = _table(watch)

    loop = Watch(every_s)
    ends_s, missions, odd = time.monotonic() + half_s, 0, 0
    while time.monotonic() < ends_s:
        outcome = _mission(ROOM.format(robots=options.robots, **SHORT))["outcome"]
        missions, odd = missions + 1, odd + (outcome == "aborted")
        loop.look()
    print(f"{missions} missions of {SHORT_S / 2:g} s after one another: {odd} aborted")
    grown |= _table(loop)
    return 1 if grown or odd else 0


def _long(robots: int, wall_s: float) -> dict[str, object]:
    """One mission for so long, in which a robot is killed and comes again."""
    room = ROOM.format(robots=robots, leader_speed=max(SLOWEST, 8.0 / wall_s), speed=1.0, limit_s=wall_s)
    times = [at_s * KILL_EVERY_S for at_s in range(1, int(wall_s / KILL_EVERY_S))]
    return _mission(room + "".join(KILLS.format(at_s=at_s, again_s=at_s + 10.0) for at_s in times))


def _mission(text: str) -> dict[str, object]:
    """Run it from this process; its summary."""
    with tempfile.TemporaryDirectory() as name:
        scenario = Path(name) / "soak.toml"
        scenario.write_text(text)
        bundle = scenario_file.load(scenario)
        out = Path(name) / "out"
        with claimed(out) as claim:
            plan = launcher.plan(bundle, (str(scenario),), out, claim, record=True)
            summary = launcher.run(plan, lambda _: None, lambda line: print(line, file=sys.stderr))
        return {**summary, "log_mb": round((out / "mission.mcap").stat().st_size / 1e6, 1)}


def _told(summary: dict[str, object]) -> str:
    return json.dumps({key: summary[key] for key in ("reason", "ticks", "log_mb", "realtime")})


def _table(watch: Watch) -> bool:
    """Print it; whether any process has more threads, files or sockets at the end."""
    print(f"{'process':16}{'samples':>8}{'RSS warm':>10}{'end [MB]':>10}{'MB/h':>8}{'+-':>6}", end="")
    print("".join(f"{what:>14}" for what in ("threads", "files", "sockets")))
    grown = False
    for name, samples in sorted(watch.samples.items()):
        warm_s = min(WARM_S, samples[-1].at_s / 5.0)
        warm = [one for one in samples if one.at_s >= warm_s]
        slope, interval = _slope(warm)
        print(f"{name:16}{len(warm):8}{warm[0].rss_kb / 1e3:10.1f}{warm[-1].rss_kb / 1e3:10.1f}", end="")
        print(f"{slope:8.2f}{interval:6.2f}", end="")
        quarter = max(1, len(warm) // 4)
        for what in ("threads", "files", "sockets"):
            values = [getattr(one, what) for one in warm]
            first, last = statistics.median(values[:quarter]), statistics.median(values[-quarter:])
            grown |= last > first + 1
            print(f"{f'{first:g} -> {last:g}':>14}", end="")
        print(flush=True)
    return grown


def _slope(samples: list[Sample]) -> tuple[float, float]:
    """Least squares of memory over time, and half of its 95 % interval [MB/h]."""
    if len(samples) < 5:
        return float("nan"), float("nan")
    hours = numpy.array([one.at_s / 3600.0 for one in samples])
    megabytes = numpy.array([one.rss_kb / 1e3 for one in samples])
    (slope, _), covariance = numpy.polyfit(hours, megabytes, 1, cov=True)
    return float(slope), 1.96 * float(covariance[0, 0]) ** 0.5


if __name__ == "__main__":
    sys.exit(main())
