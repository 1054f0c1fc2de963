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

from onehop.contracts import topics
from onehop.mission import launcher
from onehop.mission.processes import free_endpoint
from onehop.node.bus import Bus, open_client, open_router
from onehop.node.identity import make_credentials
from onehop.scenario import scenario_file
from onehop.wire.output_folder import claimed

SCENARIO = Path(__file__).parents[1] / "scenarios" / "map1.toml"
TICKS = 2000
PERCEPT, ACTION, TRUTH = bytes(900), bytes(400), bytes(700)
"""Messages as long as those of a mission of six."""


def answer(endpoint: str, name: str, word: str, says: str, data: bytes) -> None:
    """A process that answers every message to it with one of its own."""
    with open_client("bench", endpoint, name, word) as bus:
        put = bus.publisher(topics.by(name, says))
        bus.announce(name)
        while bus.receive()[0] != topics.END:
            put(data)


def bare(robots: int) -> float:
    """Ticks a second of the bare bus."""
    names = [topics.RADIO, *map(topics.robot_name, range(1, robots + 1))]
    words = make_credentials(names)
    endpoint = free_endpoint()
    spawn = multiprocessing.get_context("spawn")
    parts = [(names[0], topics.CARRIED, bytes(60 * robots))]
    parts += [(name, topics.OUT, ACTION) for name in names[1:]]
    children = [
        spawn.Process(target=answer, args=(endpoint, name, words[name], *rest), daemon=True)
        for name, *rest in parts
    ]
    with open_router("bench", endpoint, words) as bus:
        bus.watch("*")
        for child in children:
            child.start()
        for _ in children:
            bus.receive()
        rate = _ticks(bus, names[1:])
        for name in names:
            bus.publisher(topics.to(name, topics.END))(b"")
        for child in children:
            child.join(10.0)
    return rate


def _ticks(bus: Bus, robots: list[str]) -> float:
    put_truth = bus.publisher(topics.to(topics.RADIO, topics.TRUTH))
    put = [bus.publisher(topics.to(name, topics.PERCEPT)) for name in robots]
    started = time.perf_counter()
    for _ in range(TICKS):
        put_truth(TRUTH)
        bus.receive()
        for one in put:
            one(PERCEPT)
        for _ in put:
            bus.receive()
    return TICKS / (time.perf_counter() - started)


def mission(robots: int, limit: float, folder: Path) -> float:
    """Ticks a second of a recorded mission."""
    settings = [f"team.size={robots}", f"clock.limit_s={limit}"]
    bundle = scenario_file.load(SCENARIO, settings)
    arguments = launcher.world_arguments(SCENARIO, settings, None, None, None, None)
    with claimed(folder) as claim:
        plan = launcher.plan(bundle, arguments, folder, claim, True)
        return float(launcher.run(plan, lambda _: None)["ticks_per_s"])


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
