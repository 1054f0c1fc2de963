"""A campaign of chaos: which missions, on which workers, and what is left of each in its folder.

The folder holds missions.jsonl (a row each; a campaign that was stopped goes on from it), for each
failure that was made small a folder with its scenario file and its log, and chaos.html.
"""

import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from onehop import __version__
from onehop.campaign.lines import Lines, Row
from onehop.campaign.listener import Listener
from onehop.campaign.process_mission import write_scenario
from onehop.campaign.workers import Crash, Done, Run
from onehop.chaos.order import MissionOrder, Repeat, ShrinkOrder, shrink_failure, try_mission
from onehop.chaos.properties import CRASH
from onehop.chaos.shrink import MOST_RUNS, Shrunk
from onehop.chaos.swarm import stream
from onehop.chaos.trial import Failure, tried
from onehop.contracts.printable import ids_in_words
from onehop.scenario.bundle import Bundle
from onehop.wire.output_folder import LOG

MISSIONS, FAILURES, PAGE = "missions.jsonl", "failures", "chaos.html"

SHRUNK_EACH = 3
"""Failures of one property that are shrunk: more would tell the same."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a campaign is to try. seeds: of the missions that are drawn. corpus: missions taken as they
    are, by name. processes: share of the drawn that are run as processes as well. twice_every: of the
    rest every so many-th is run twice, 0: none.
    """

    base: Bundle
    seeds: range
    corpus: dict[str, Bundle]
    budget: bool
    processes: float
    twice_every: int

    def about(self) -> dict[str, Any]:
        """What must be the same to go on with a campaign: everything but how many."""
        return {
            "onehop": __version__,
            "scenario": self.base.scenario_json(),
            "budget": self.budget,
            "processes": self.processes,
            "twice_every": self.twice_every,
        }

    def orders(self) -> Iterator[MissionOrder]:
        """The corpus first."""
        for name, bundle in self.corpus.items():
            yield MissionOrder(name, bundle, None, self.budget, "once")
        for seed in self.seeds:
            yield MissionOrder(str(seed), self.base, seed, self.budget, self._repeat(seed))

    def _repeat(self, seed: int) -> Repeat:
        if stream(seed, "processes").random() < self.processes:
            return "processes"
        return "twice" if self.twice_every and seed % self.twice_every == 0 else "once"


@dataclass(frozen=True, slots=True)
class Found:
    """A failure, and the scenario file that repeats it, if it was shrunk."""

    name: str
    seed: int
    failure: Failure
    scenario: Path | None = None
    shrunk: Shrunk | None = None


class Hunt:
    """One campaign in its folder. rows: of the missions that were tried, in the order of the orders.

    listener: the progress display.
    """

    def __init__(self, wanted: Wanted, folder: Path, run: Run, listener: Listener) -> None:
        self._wanted = wanted
        self._folder = folder
        self._run = run
        self._listener = listener
        self.rows: list[Row] = []
        self.found: list[Found] = []
        self.wall_s = 0.0
        self.tried_now = 0

    @property
    def draws(self) -> bool:
        """Whether missions are drawn, and not only taken as they are."""
        return len(self._wanted.seeds) > 0

    def try_missions(self, until_found: bool = False) -> None:
        """Try what the folder has not; whatever ends this, `rows` has what was tried.

        until_found: end with the first mission in which something is broken.
        """
        orders = {order.name: order for order in self._wanted.orders()}
        started = time.monotonic()
        with Lines(self._folder / MISSIONS, self._wanted.about()) as lines:
            self.rows = [row for row in lines.rows if row["name"] in orders]
            done = {row["name"] for row in self.rows}
            missing = [order for name, order in orders.items() if name not in done]
            self._listener.begin(len(self.rows))
            try:
                for one in self._run(try_mission, missing):
                    row = one.result if not isinstance(one.result, Crash) else _lost(one)
                    lines.add(row)
                    self.rows.append(row)
                    self.tried_now += 1
                    self._listener.show(row)
                    if until_found and row["failures"]:
                        break
            finally:
                self.wall_s = time.monotonic() - started
                place = {name: number for number, name in enumerate(orders)}
                self.rows.sort(key=lambda row: place[row["name"]])
                self.found = [
                    Found(row["name"], row["seed"], Failure(**failure))
                    for row in self.rows
                    for failure in row["failures"]
                ]

    def shrink(self, most_runs: int = MOST_RUNS) -> None:
        """Make the first failures of each property small, and write them as scenario files."""
        orders = {order.name: order for order in self._wanted.orders()}
        seen: Counter[str] = Counter()
        work = []
        for place, one in enumerate(self.found):
            seen[one.failure.property] += 1
            if seen[one.failure.property] <= SHRUNK_EACH:
                work.append(ShrinkOrder(place, orders[one.name], one.failure, most_runs))
        for done in self._run(shrink_failure, work):
            if not isinstance(done.result, Crash):
                path = self._write(done.item.order, done.result)
                known = self.found[done.item.place]
                self.found[done.item.place] = replace(known, scenario=path, shrunk=done.result)

    def _write(self, order: MissionOrder, shrunk: Shrunk) -> Path:
        folder = self._folder / FAILURES / f"{Path(order.name).stem}-{shrunk.failure.property}"
        folder.mkdir(parents=True, exist_ok=True)
        tried(shrunk.bundle, shrunk.failure.property, folder / LOG)
        path = folder / "scenario.toml"
        return write_scenario(shrunk.bundle, path, _comment(order, shrunk, path))

    def faults(self) -> Counter[str]:
        """Faults of all missions, by kind."""
        total: Counter[str] = Counter()
        for row in self.rows:
            total.update(row["faults"])
        return total

    def total(self, of: str) -> Counter[str]:
        """Sums over missions of `checked` or `seen`."""
        total: Counter[str] = Counter()
        for row in self.rows:
            total.update(row[of])
        return total

    def robot_hours(self) -> float:
        """Simulated time of all robots together [h]."""
        return sum(float(row["robots"]) * float(row["sim_s"]) for row in self.rows) / 3600.0


def _lost(done: Done[MissionOrder, Row]) -> Row:
    """The row of a mission whose worker failed or died."""
    assert isinstance(done.result, Crash)
    order = done.item
    failure = Failure(CRASH, -1, (), done.result.why)
    return {
        "name": order.name, "seed": order.seed or order.base.scenario.seed, "repeat": order.repeat,
        "robots": 0, "map": "", "routing": "", "preset": "", "policy": "", "faults": {},
        "outcome": "none", "reason": "", "arrived": 0, "ticks": 0, "sim_s": 0.0, "wall_s": 0.0,
        "digest": None, "checked": {}, "seen": {}, "failures": [asdict(failure)],
    }  # fmt: skip


def _comment(order: MissionOrder, shrunk: Shrunk, path: Path) -> str:
    """What the file says of itself."""
    failure, before, after = shrunk.failure, order.bundle().scenario, shrunk.bundle.scenario
    at_s = failure.tick * after.clock.period_ms / 1000.0
    who = f", robots {ids_in_words(failure.robots)}" if failure.robots else ""
    sizes = (
        f"{len(before.faults)} faults -> {len(after.faults)}, "
        f"{len(before.team.robots)} robots -> {len(after.team.robots)}, "
        f"{len(before.map.obstacles)} obstacles -> {len(after.map.obstacles)}"
    )
    spent = "the runs were used up" if shrunk.runs else "left as it was"
    end = "nothing more can be taken away" if shrunk.is_smallest else spent
    return (
        f"{failure.property} at {at_s:.2f} s{who}: {failure.what}\n"
        f"From {order.name} ({sizes}; {shrunk.runs} runs, {end}).\n"
        f"Again:  onehop chaos {path} --as-is\n"
        f"See it: onehop run {path} --driver inline\n"
    )
