"""Do to containers what people do to them, and see that it is what the same faults are without them.

One mission of map1, whose leader creeps so that it does not end by itself: a container is paused for a
moment, one killed, one restarted, one paused for longer than its lease, one cut from the network. The
image is there (docker/compose-demo.sh).
"""

import json
import os
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

from onehop.commands.compose import compose as write_compose_file
from onehop.contracts.messages import Truth
from onehop.drivers.replay import replay
from onehop.node.bus import LEASE_MS
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile

PROJECT = "onehop-faults"
FILE = Path(".compose-faults.yaml")
SCENARIO, CREEPING = Path("scenarios/map1.toml"), Path("runs/creeping/map1.toml")
CREEPS = "[robot]\nleader_speed = 0.05\n[clock]\nlimit_s = 3600\n"
OUT = Path("runs/compose")
LEASE_S = LEASE_MS / 1000.0
GROWN_BYTES = 200_000
"""A log of this size is that of a mission under way."""

DEADLINE_S = 240.0

DIED = "its process died"
DEPARTURES = {3: [DIED], 4: [DIED], 5: [DIED], 6: [DIED]}
"""Who leaves, and why, by what is done to it: killed, restarted, paused, cut from the network."""


def compose(*words: str) -> None:
    program = ["docker", "compose"] if _has_plugin() else ["docker-compose"]
    command = [*program, "--project-name", PROJECT, "--file", str(FILE), *words]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _has_plugin() -> bool:
    tried = subprocess.run(["docker", "compose", "version"], capture_output=True, check=False)
    return tried.returncode == 0


def docker(*words: str) -> str:
    done = subprocess.run(["docker", *words], check=True, capture_output=True, text=True)
    return done.stdout.strip()


def container(service: str) -> str:
    """Id of the container of a service."""
    labels = {"project": PROJECT, "service": service}
    filters = [f"--filter=label=com.docker.compose.{key}={value}" for key, value in labels.items()]
    return docker("ps", "--all", "--quiet", *filters)


def wait(what: str, done: Callable[[], bool]) -> None:
    deadline = time.monotonic() + DEADLINE_S
    while not done():
        if time.monotonic() > deadline:
            sys.exit(f"waited in vain until {what}")
        time.sleep(0.1)


def disturb() -> None:
    """What people do to containers, one after the other."""
    docker("pause", container("robot-2"))
    time.sleep(0.25 * LEASE_S)
    docker("unpause", container("robot-2"))
    docker("kill", container("robot-3"))
    docker("restart", "--time", "0", container("robot-4"))
    docker("pause", container("robot-5"))
    docker("network", "disconnect", f"{PROJECT}_robot-6", container("robot-6"))
    time.sleep(2.0 * LEASE_S)
    docker("unpause", container("robot-5"))
    wait("robot 4 takes part again", lambda: (4, 1) in present())


def present() -> tuple[tuple[int, int], ...]:
    """Who takes part by the log as far as it is written, each with its incarnation."""
    last = None
    for tick in LogFile(OUT / "mission.mcap").ticks():
        last = tick.get("truth") or last
    return (
        ()
        if last is None
        else tuple((one.robot, one.incarnation) for one in decode(Truth, last).present)
    )


def findings() -> list[str]:
    """What is not as it should be, from the log alone."""
    log = LogFile(OUT / "mission.mcap")
    departures: dict[int, list[str]] = defaultdict(list)
    restarts = []
    for tick in log.ticks():
        truth = decode(Truth, tick.get("truth") or b"")
        restarts += [fault.robots for fault in truth.faults if fault.kind == "restart"]
        for one in truth.departures:
            departures[one.robot].append(one.why)
    report = replay(log)
    found = []
    for what, is_so, should in (
        ("departures", dict(sorted(departures.items())), DEPARTURES),
        ("restarts", restarts, [(4,)]),
        ("present at the end", present(), ((1, 0), (2, 0), (4, 1))),
        ("divergences", report.divergences, 0),
    ):
        print(f"{what:20} {is_so}")
        if is_so != should:
            found.append(f"{what} should be {should}")
    return found


def main() -> int:
    log, summary = OUT / "mission.mcap", OUT / "summary.json"
    OUT.mkdir(parents=True, exist_ok=True)
    if os.geteuid() == 0:  # nothing runs as root
        os.chown(OUT, 1000, 1000)
    else:
        os.environ["ONEHOP_UID"] = str(os.getuid())
    log.unlink(missing_ok=True)
    summary.unlink(missing_ok=True)
    CREEPING.parent.mkdir(exist_ok=True)
    CREEPING.write_text(f"{SCENARIO.read_text()}\n{CREEPS}")
    write_compose_file(CREEPING, FILE)
    try:
        compose("up", "--detach", "--no-build")
        wait("the mission is under way", lambda: log.exists() and log.stat().st_size > GROWN_BYTES)
        disturb()
        docker("kill", "--signal", "TERM", container("world"))
        wait("the recorder has finished", summary.exists)
    finally:
        compose("down", "--volumes", "--timeout", "2")
        FILE.unlink()
    outcome = json.loads(summary.read_text())
    print(f"{'outcome':20} {outcome['outcome']}: {outcome['reason']}")
    found = findings()
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
