"""4.1: a leader alone on map 1, whose corner traps it: Algorithm 2 against the original."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from onehop.campaign.lines import Row
from onehop.contracts.scenario import Scenario
from onehop.drivers.trial import TrialOutcome, run_trial
from onehop.maps.map_file import load_map
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.study.claims import Claim, Expects, Judgement, judge
from onehop.study.comparison import difference

ORIGINAL, MODIFIED = "original", "modified"
PLANNERS = (ORIGINAL, MODIFIED)

LIMIT_S = 600.0
"""Simulated time that a leader has [s]. The thesis: "did not solve local minima problem within same
time" (fig. 4.1), without the time."""

DRAWN = 10
"""Seeds whose ways are kept: figure 3.7 shows several of one map."""

_EVERY = 10
"""Ticks between two points of a way that is kept."""


@dataclass(frozen=True, slots=True)
class WayOrder:
    """One leader to let go. keep_way: write its way into the row."""

    name: str
    values: dict[str, Any]
    bundle: Bundle
    keep_way: bool


def orders(folder: Path, seeds: Sequence[int]) -> Iterator[WayOrder]:
    """Both planners with each seed. Raises InputError."""
    bundles = {planner: _bundle(folder, planner) for planner in PLANNERS}
    for number, seed in enumerate(seeds):
        for planner, bundle in bundles.items():
            seeded = Bundle(replace(bundle.scenario, seed=seed), bundle.files)
            yield WayOrder(f"{planner} seed={seed}", {"planner": planner}, seeded, number < DRAWN)


def _bundle(folder: Path, planner: str) -> Bundle:
    return scenario_file.load(
        folder / "map1.toml", [f"planner.kind={planner}", f"clock.limit_s={LIMIT_S:g}"]
    )


def run_way(order: WayOrder) -> Row:
    """Let one leader find its way."""
    scenario: Scenario = order.bundle.scenario
    trial = run_trial(scenario, load_map(scenario.map, order.bundle.files))
    points = [*trial.path[:-1:_EVERY, :2].tolist(), trial.path[-1, :2].tolist()]
    return {
        "name": order.name,
        "values": order.values,
        "seed": scenario.seed,
        "arrived": int(trial.outcome is TrialOutcome.ARRIVED),
        "answer": trial.answer,
        "sim_s": round((len(trial.path) - 1) * scenario.clock.period_ms / 1e3, 2),
        "length_m": round(trial.length, 2),
        "steps_back": sum(moment.backtrack for moment in trial.snapshots),
        "way": [[round(x, 2), round(y, 2)] for x, y in points] if order.keep_way else None,
    }


def way_claim(rows: Sequence[Row]) -> Judgement:
    """Whether Algorithm 2 leaves the corner more often than the original."""
    claim = Claim(
        "The modified PRM finds the goal past map 1's corner where the original is stuck.",
        "4.1, fig. 4.1", "arrived", Expects.MORE, "of the leaders",
    )  # fmt: skip
    found = difference(rows, "arrived", {"planner": ORIGINAL}, {"planner": MODIFIED})
    return judge(claim, found.estimate, found.seeds)
