"""The gain policies of the followers compared over the same seeds: JSON on stdout.

    python bench/gains.py --seeds 5 --lines runs/gains.jsonl

Every mission adds a line to the file as it ends; with the same file the program goes on.
Each policy drives the same missions: a study map on which all followers stand still for a while at 60 s,
as in the thesis (chapter 4). Per policy, medians over the seeds of
- arrival_s: simulated time until the mission ended,
- error_m: mean distance of a follower from its slot while the team drives,
- recovery_s: time after the delay until all followers were within REGAINED of their slots again,
- below_s: time that a follower's measured throughput was below the threshold, mean of the followers,
- speed_change: mean change of a follower's commanded speed from tick to tick, as m/s per second: how
  roughly it is driven; and the number of robots lost over all seeds.
"""

import argparse
import itertools
import json
import os
import statistics
from pathlib import Path
from typing import Any

from onehop.contracts.messages import Action, Carriage
from onehop.contracts.team import Mode
from onehop.drivers import inline
from onehop.scenario import scenario_file
from world_server.core.world import World

SCENARIOS = Path(__file__).parents[1] / "scenarios"
POLICIES = ("constant", "throughput", "smooth")
DELAY_AT, DELAY = 60.0, 8.0
REGAINED = 1.0
"""Distance from its slot at which a follower has caught up [m]."""


class Course:
    """What the followers of one mission did while their team drove."""

    def __init__(self) -> None:
        self.error = self.below = self.change = self.ticks = 0.0
        self.last: dict[int, float] = {}
        self.regained_s: float | None = None

    def watch(self, world: World, actions: dict[int, Action], _: Carriage) -> None:
        """Called by the driver after every tick."""
        now = world.time_ns / 1e9
        followers = [i for i, one in actions.items() if one.status.leader not in (i, 0)]
        driving = [i for i in followers if actions[i].status.mode not in (Mode.SETUP, Mode.STOPPED)]
        for robot in driving:
            action = actions[robot]
            self.ticks += 1
            self.error += action.status.error
            self.below += action.status.throughput_bps < action.status.threshold_bps
            self.change += abs(action.twist.v - self.last.get(robot, action.twist.v))
            self.last[robot] = action.twist.v
        late = any(actions[robot].status.error > REGAINED for robot in driving)
        if now > DELAY_AT + DELAY and self.regained_s is None and driving and not late:
            self.regained_s = now - DELAY_AT - DELAY


def mission(number: int, seed: int, policy: str, k_rho_min: float) -> dict[str, float]:
    """One mission."""
    hold = f'{{kind="hold", at_s={DELAY_AT}, robots=[1, 2, 4, 5, 6], duration_s={DELAY}}}'
    settings = [f"seed={seed}", f'gains.policy="{policy}"', f"faults=[{hold}]"]
    settings.append(f"gains.k_rho_min={k_rho_min}")
    bundle = scenario_file.load(SCENARIOS / f"map{number}.toml", settings)
    course = Course()
    outcome = inline.run(bundle, None, course.watch)
    period, team = bundle.scenario.clock.period_ms / 1000.0, len(bundle.scenario.team.robots)
    return {
        "arrival_s": outcome.sim_s,
        "error_m": course.error / course.ticks,
        "recovery_s": outcome.sim_s if course.regained_s is None else course.regained_s,
        "below_s": course.below * period / (team - 1),
        "speed_change": course.change / course.ticks / period,
        "lost": team - len(outcome.arrived),
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--map", type=int, default=1)
    parser.add_argument("--k-rho-min", type=float, default=1.0, help="low gain [1/s]")
    parser.add_argument("--lines", type=Path, default=os.devnull, help="one JSON line a mission")
    options = parser.parse_args()
    options.lines.parent.mkdir(parents=True, exist_ok=True)
    known = options.lines.read_text().splitlines() if options.lines.exists() else []
    done = {tuple(key): run for key, run in map(json.loads, known)}
    wanted = itertools.product([options.map], range(1, options.seeds + 1), POLICIES, [options.k_rho_min])
    with options.lines.open("a") as file:
        for key in wanted:
            if key not in done:
                done[key] = mission(*key)
                print(json.dumps((key, done[key])), file=file, flush=True)
    table: dict[str, Any] = {"map": options.map, "seeds": options.seeds, "k_rho_min": options.k_rho_min}
    for policy in POLICIES:
        runs = [
            done[options.map, seed, policy, options.k_rho_min] for seed in range(1, options.seeds + 1)
        ]
        row = {key: round(statistics.median(run[key] for run in runs), 3) for key in runs[0]}
        table[policy] = {**row, "lost": sum(run["lost"] for run in runs)}
    print(json.dumps(table, indent=1))


if __name__ == "__main__":
    main()
