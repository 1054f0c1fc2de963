"""Lock-step over processes, beside the bare bus: the same messages between as many processes, no work.

Prints one JSON object. `bare` is what Zenoh and these cores give at that moment for our pattern of
messages (truth, air, one percept and one action a robot; nobody simulates, records or decodes), and
`mission` what a whole recorded mission makes of it. Absolute figures drift; their ratio does not.
"""

import argparse
import json
import multiprocessing
import statistics
import tempfile
import time
from pathlib import Path

from onehop import scenario_file
from onehop.drive.bus import Bus, make_credentials, open_client, open_router
from onehop.mission import launcher
from onehop.mission.processes import free_endpoint

SCENARIO = Path(__file__).parents[1] / "scenarios" / "map1.toml"
TICKS = 2000
PERCEPT, ACTION, TRUTH = bytes(900), bytes(400), bytes(700)
"""Messages as long as those of a mission of six."""


def answer(endpoint: str, name: str, word: str, hears: str, says: str, data: bytes) -> None:
    """A process that answers every message on one key with one on another."""
    with open_client("bench", endpoint, name, word) as bus:
        bus.subscribe(hears)
        bus.subscribe("end")
        put = bus.publisher(says)
        bus.announce(name)
        while bus.inbox.get()[0] != "end":
            put(data)


def bare(robots: int) -> float:
    """Ticks a second of the bare bus."""
    names = ["radio", *(f"robot-{i}" for i in range(1, robots + 1))]
    words = make_credentials(names)
    endpoint = free_endpoint()
    spawn = multiprocessing.get_context("spawn")
    parts = [("radio", "truth", "air", bytes(60 * robots))]
    parts += [(f"robot-{i}", f"percept/{i}", f"out/{i}", ACTION) for i in range(1, robots + 1)]
    children = [
        spawn.Process(target=answer, args=(endpoint, name, words[name], *rest), daemon=True)
        for name, *rest in parts
    ]
    with open_router("bench", endpoint, words) as bus:
        bus.subscribe("out/*")
        bus.subscribe("air")
        bus.watch("alive/*")
        for child in children:
            child.start()
        for _ in children:
            bus.inbox.get(timeout=30.0)
        rate = _ticks(bus, robots)
        bus.publisher("end")(b"")
        for child in children:
            child.join(10.0)
    return rate


def _ticks(bus: Bus, robots: int) -> float:
    put_truth = bus.publisher("truth")
    put = [bus.publisher(f"percept/{i}") for i in range(1, robots + 1)]
    started = time.perf_counter()
    for _ in range(TICKS):
        put_truth(TRUTH)
        bus.inbox.get(timeout=10.0)
        for one in put:
            one(PERCEPT)
        for _ in put:
            bus.inbox.get(timeout=10.0)
    return TICKS / (time.perf_counter() - started)


def mission(robots: int, limit: float, folder: Path) -> float:
    """Ticks a second of a recorded mission."""
    settings = [f"team.size={robots}", f"clock.limit_s={limit}"]
    bundle = scenario_file.load(SCENARIO, settings)
    arguments = launcher.world_arguments(SCENARIO, settings, None, None, None, None)
    order = launcher.Order(arguments, bundle.scenario.team.robots, folder, True)
    return float(launcher.run(order, lambda _: None)["ticks_per_s"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=6)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--limit", type=float, default=120.0, help="simulated seconds of the mission")
    options = parser.parse_args()
    rates: dict[str, list[float]] = {"bare": [], "mission": []}
    with tempfile.TemporaryDirectory() as name:
        for _ in range(options.rounds):
            rates["bare"].append(bare(options.robots))
            rates["mission"].append(mission(options.robots, options.limit, Path(name)))
    medians = {key: round(statistics.median(values), 1) for key, values in rates.items()}
    result = {
        "robots": options.robots,
        "rounds": options.rounds,
        "ticks_per_s": medians,
        "mission_over_bare": round(medians["mission"] / medians["bare"], 3),
    }
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
