"""What a team makes of links as they are measured, over the same seeds: JSON on stdout.

    python bench/indoor.py --seeds 5 --lines runs/indoor.jsonl

scenarios/indoor.toml with its shadows, with a draw of 9 dB for each frame instead, with neither, and
with Rayleigh fading besides; followers that hurry by throughput, and some that never do. Every
mission adds a line to the file as it ends; with the same file the program goes on. Means over the seeds,
of what bench/gains.py says, and robots lost over all of them.
"""

import argparse
import itertools
import json
import os
import statistics
import time
from pathlib import Path

from gains import SCENARIOS, Course

from onehop.drivers import inline
from onehop.scenario import scenario_file

LINKS = {
    "shadows of places": (),
    "a draw for each frame": ("radio.spatial_shadowing_db=0", "radio.shadowing_db=9"),
    "path loss alone": ("radio.spatial_shadowing_db=0",),
    "shadows and Rayleigh fading": ('radio.fast_fading="rayleigh"',),
}
POLICIES = ("throughput", "constant")


def mission(links: str, policy: str, seed: int) -> dict[str, float]:
    """One mission."""
    settings = [f"seed={seed}", f'gains.policy="{policy}"', *LINKS[links]]
    bundle = scenario_file.load(SCENARIOS / "indoor.toml", settings)
    course, began = Course(), time.process_time()
    outcome = inline.run(bundle, None, course.watch)
    period, team = bundle.scenario.clock.period_ms / 1000.0, len(bundle.scenario.team.robots)
    return {
        "ended_s": outcome.sim_s,
        "error_m": course.error / course.ticks,
        "below_s": course.below * period / (team - 1),
        "speed_change": course.change / course.ticks / period,
        "lost": team - len(outcome.arrived),
        "cpu_s": time.process_time() - began,
    }


def main() -> None:
    """Run what the file lacks, print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--lines", type=Path, default=os.devnull, help="one JSON line a mission")
    options = parser.parse_args()
    options.lines.parent.mkdir(parents=True, exist_ok=True)
    known = options.lines.read_text().splitlines() if options.lines.exists() else []
    done = {tuple(key): run for key, run in map(json.loads, known)}
    seeds = range(1, options.seeds + 1)
    with options.lines.open("a") as file:
        for seed, links, policy in itertools.product(seeds, LINKS, POLICIES):
            key = (links, policy, seed)
            if key not in done:
                done[key] = mission(*key)
                print(json.dumps((key, done[key])), file=file, flush=True)
    table = {}
    for links, policy in itertools.product(LINKS, POLICIES):
        runs = [done[links, policy, seed] for seed in seeds]
        row = {key: round(statistics.mean(run[key] for run in runs), 2) for key in runs[0]}
        table[f"{links}, {policy}"] = {**row, "lost": sum(run["lost"] for run in runs)}
    print(json.dumps({"seeds": options.seeds, **table}, indent=1))


if __name__ == "__main__":
    main()
