"""Many missions on the study maps: how many touch anything, and how many arrive whole. JSON on stdout.

    python bench/campaign.py --seeds 100 --lines runs/quiet.jsonl
    python bench/campaign.py --seeds 20 --faults --lines runs/faults.jsonl

One process, the inline driver, nothing recorded. With --lines every mission adds a line to the file as
it ends, and the program started again with the same file goes on where it was stopped. Delete the file
after a change of the rules: a line belongs to the program that wrote it.

With --faults each seed draws its own: one robot killed, one killed and started again, a cut of the team
into two parts, and one robot held still, each at a random time of the first 150 s.
"""

import argparse
import json
import os
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from onehop.contracts.messages import Action, Carriage
from onehop.contracts.randomness import generator
from onehop.drivers import inline
from onehop.scenario import scenario_file
from world_server.core.world import World

SCENARIOS = Path(__file__).parents[1] / "scenarios"
MAPS = (1, 2, 3)
TEAM = 6


def fault(kind: str, at: float, robots: Iterable[int], **more: object) -> str:
    """One fault as a TOML table."""
    keys = {"at_s": round(at, 2), "robots": [int(robot) for robot in robots], **more}
    return f'{{kind = "{kind}", ' + ", ".join(f"{key} = {value}" for key, value in keys.items()) + "}"


def faults(seed: int) -> list[str]:
    """The faults of one seed."""
    rng = generator(seed, "campaign/faults")
    ids = [int(robot) for robot in rng.permutation(TEAM) + 1]
    killed, again, held, side = ids[0], ids[1], ids[2], sorted(ids[: 2 + int(rng.integers(2))])
    at = rng.uniform(20.0, 150.0, 4)
    return [
        fault("kill", at[0], [killed]),
        fault("kill", at[1], [again]),
        fault("restart", at[1] + rng.uniform(5.0, 20.0), [again]),
        fault("cut", at[2], side, others=sorted(set(ids) - set(side)), duration_s=15),
        fault("hold", at[3], [held], duration_s=10),
    ]


class Witness:
    """Where and when robots touched something, and what followers measured of their links."""

    def __init__(self) -> None:
        self.contacts: list[dict[str, float]] = []
        self.measured = 0
        self.sum_bps = 0.0

    def throughput_bps(self) -> float | None:
        """Mean over followers and ticks, lost messages as 0 [bit/s]."""
        return round(self.sum_bps / self.measured) if self.measured else None

    def watch(self, world: World, actions: dict[int, Action], _: Carriage) -> None:
        """Called by the driver after every tick."""
        for action in actions.values():
            if action.status.throughput_bps >= 0.0:
                self.measured += 1
                self.sum_bps += action.status.throughput_bps
        for one in world.truth().contacts:
            place = {"robot": one.robot, "other": one.other, "x": round(one.x, 2), "y": round(one.y, 2)}
            self.contacts.append({"at_s": world.time_ns / 1e9, **place})


def mission(number: int, seed: int, with_faults: bool) -> dict[str, Any]:
    """One mission and what became of it."""
    settings = [f"seed={seed}"]
    if with_faults:
        settings.append(f"faults=[{', '.join(faults(seed))}]")
    bundle = scenario_file.load(SCENARIOS / f"map{number}.toml", settings)
    witness, began = Witness(), time.process_time()
    outcome = inline.run(bundle, None, witness.watch)
    return {
        "map": number,
        "seed": seed,
        "outcome": outcome.outcome,
        "reason": outcome.reason,
        "arrived": outcome.arrived,
        "lost": [{"robot": one.robot, "at_s": one.at_s, "why": one.why} for one in outcome.lost],
        "sim_s": outcome.sim_s,
        "collisions": outcome.collisions,
        "contacts": witness.contacts,
        "throughput_bps": witness.throughput_bps(),
        "cpu_s": round(time.process_time() - began, 1),
    }


def summary(lines: list[dict[str, Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    """One row for each map."""
    for number in MAPS:
        mine = [line for line in lines if line["map"] == number]
        if not mine:
            continue
        times = sorted(line["sim_s"] for line in mine if line["outcome"] == "arrived")
        measured = [line["throughput_bps"] for line in mine if line["throughput_bps"] is not None]
        yield (
            f"map{number}",
            {
                "missions": len(mine),
                "arrived": len(times),
                "arrived_whole": sum(len(line["arrived"]) == TEAM for line in mine),
                "contacts": sum(line["collisions"] for line in mine),
                "not_whole": {
                    line["seed"]: list(line["arrived"]) for line in mine if len(line["arrived"]) < TEAM
                },
                "lost": sum(len(line["lost"]) for line in mine),
                "median_s": times[len(times) // 2] if times else None,
                "longest_s": times[-1] if times else None,
                "mean_throughput_bps": round(sum(measured) / len(measured)) if measured else None,
            },
        )


def main() -> None:
    """Run what the file lacks, print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--maps", type=int, nargs="+", default=list(MAPS))
    parser.add_argument("--faults", action="store_true")
    parser.add_argument("--lines", type=Path, default=os.devnull, help="one JSON line a mission")
    options = parser.parse_args()
    options.lines.parent.mkdir(parents=True, exist_ok=True)
    known = options.lines.read_text().splitlines() if options.lines.exists() else []
    lines = [json.loads(line) for line in known]
    done = {(line["map"], line["seed"]) for line in lines}
    wanted = [(number, seed) for seed in range(1, options.seeds + 1) for number in options.maps]
    with options.lines.open("a") as file:
        for number, seed in wanted:
            if (number, seed) not in done:
                lines.append(mission(number, seed, options.faults))
                print(json.dumps(lines[-1]), file=file, flush=True)
    print(json.dumps(dict(summary(lines)), indent=1))


if __name__ == "__main__":
    main()
