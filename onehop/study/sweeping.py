"""A sweep in its folder: which missions, on which workers, what is left of each, and what they say.

The folder holds missions.jsonl (a row each; a sweep that was stopped goes on from it), and at the end
missions.parquet, sweep.json and, if they are kept, logs.
"""

import hashlib
import json
import re
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from onehop import __version__
from onehop.campaign.collection import Collection, Crashed
from onehop.campaign.lines import Row
from onehop.campaign.listener import Listener
from onehop.campaign.process_mission import self_contained
from onehop.campaign.workers import Run, workers
from onehop.contracts.randomness import generator
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.study.grid import Axis, Cell, cells
from onehop.study.mission import Keep, MissionOrder, run_mission
from onehop.study.table import Missions
from onehop.wire.output_folder import explained, held

ROWS, TABLE, SUMMARY, LOGS = "missions.jsonl", "missions.parquet", "sweep.json", "logs"

LONGEST_NAME = 120
"""Letters of a mission's name that its log's bears."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a sweep is to run. bases: the missions that the cells vary. seeds: the same in each cell.

    processes: share of the missions that run as processes besides.
    """

    bases: Sequence[Bundle]
    cells: Sequence[Cell]
    seeds: range
    keep: Keep = "none"
    processes: float = 0.0

    @property
    def total(self) -> int:
        """How many missions."""
        return len(self.cells) * len(self.seeds)

    def about(self) -> dict[str, Any]:
        """What must be the same to go on with a sweep: everything but which values and seeds."""
        scenarios = [replace(one.scenario, seed=1) for one in self.bases]
        return {
            "onehop": __version__,
            "scenarios": [Bundle(one, {}).scenario_json() for one in scenarios],
            "files": [_digests(one) for one in self.bases],
            "over": list(self.cells[0].values),
            "keep": self.keep,
            "processes": self.processes,
        }

    def orders(self, folder: Path) -> Iterator[MissionOrder]:
        """Seed by seed, so that whenever it is stopped the cells have about the same seeds."""
        varied = self.cells
        if self.processes:
            varied = [replace(one, bundle=self_contained(one.bundle, one.name)) for one in varied]
        for seed in self.seeds:
            for cell in varied:
                name = f"{cell.name} seed={seed}".strip()
                log = (folder / LOGS / f"{_file_name(name)}.mcap").absolute()
                again = generator(seed, f"study/processes/{cell.name}").random() < self.processes
                bundle = cell.with_seed(seed)
                yield MissionOrder(name, cell.values, bundle, self.keep, log, again)


class Sweep:
    """One sweep. rows: of the missions that were run, by cell and seed. summary: what they say.

    Both are there, and written, whatever ends it; summary is None if it never began.
    """

    def __init__(self, wanted: Wanted, folder: Path, workers: Run, listener: Listener) -> None:
        self._wanted = wanted
        self._folder = folder
        self._collection = Collection(folder / ROWS, wanted.about(), workers, listener)
        self.summary: dict[str, Any] | None = None

    @property
    def rows(self) -> list[Row]:
        """By cell and seed."""
        place = {json.dumps(cell.values): number for number, cell in enumerate(self._wanted.cells)}
        return sorted(
            self._collection.rows, key=lambda row: (place[json.dumps(row["values"])], row["seed"])
        )

    @property
    def crashed(self) -> list[Crashed]:
        """Missions that have no row."""
        return self._collection.crashed

    @property
    def run_now(self) -> int:
        """How many missions this call has run."""
        return len(self._collection.run_now)

    def run(self) -> dict[str, Any]:
        """Run what the folder lacks, and give the summary. Raises InputError."""
        orders = list(self._wanted.orders(self._folder))
        if self._wanted.keep != "none":
            with explained(self._folder / LOGS, "a folder that can be written, with room for logs"):
                (self._folder / LOGS).mkdir(exist_ok=True)
        try:
            self._collection.run(run_mission, orders)
        except BaseException:
            if self._collection.began:
                self._finish()
            raise
        return self._finish()

    def missions(self) -> Missions:
        """The rows as a table."""
        return Missions(self._wanted.cells[0].values, self.rows)

    def _finish(self) -> dict[str, Any]:
        """Write the table and what it says, and give that."""
        rows = self.rows
        missions, table = Missions(self._wanted.cells[0].values, rows), self._folder / TABLE
        again = [row["as_processes"] for row in rows if row["as_processes"] is not None]
        self.summary = {
            "missions": len(rows),
            "wanted": self._wanted.total,
            **self._collection.rate(),
            "table": str(table) if missions.write_parquet(table) else None,
            "cells": missions.cells(),
            "differences": missions.differences(),
            "as_processes": dict(Counter(word.partition(":")[0] for word in again)),
            "crashed": [{"mission": one.name, "why": one.why} for one in self.crashed],
        }
        path = self._folder / SUMMARY
        with explained(path, "a folder that can be written"):
            path.write_text(json.dumps(self.summary, indent=1) + "\n")
        return self.summary


def _digests(base: Bundle) -> dict[str, str]:
    return {name: hashlib.sha256(data).hexdigest() for name, data in base.files.items()}


def _file_name(name: str) -> str:
    """What a file of this mission is called: legible, short, and like no other's."""
    legible = re.sub(r"[^\w.=-]+", "_", name)[:LONGEST_NAME]
    return f"{legible}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"


def sweep(
    scenario: Path | str,
    over: Mapping[str, Sequence[Any]],
    *,
    out: Path | str,
    seeds: int = 20,
    first_seed: int = 1,
    settings: Iterable[str] = (),
    jobs: int | None = None,
    dask: str | None = None,
    keep: Keep = "none",
    processes: float = 0.0,
) -> Missions:
    """Run every combination of values of some keys, each with the same seeds, and give the missions.

    over: values by key, e.g. {"gains.k_rho_min": [0.1, 0.3]}. out: the folder of the sweep; with one
    that has results, only what is missing is run. settings: "key.path=value", for all of them. jobs:
    processes, by default one a core; a script needs `if __name__ == "__main__":` for them. dask: address
    of a scheduler whose workers are used instead. keep, processes: as in `onehop sweep --help`.

    Raises InputError; warns of missions that have crashed.
    """
    path, folder, fixed = Path(scenario), Path(out), tuple(settings)
    axes = [Axis(key, list(values)) for key, values in over.items()]
    base = scenario_file.load(path, fixed)
    varied = cells(path, fixed, axes, first_seed)
    wanted = Wanted([base], varied, range(first_seed, first_seed + seeds), keep, processes)
    with held(folder):
        one = Sweep(wanted, folder, workers(jobs, dask), Nobody())
        one.run()
    if one.crashed:
        first = one.crashed[0]
        warnings.warn(f"{len(one.crashed)} missions crashed; {first.name}: {first.why}", stacklevel=2)
    return one.missions()


class Nobody:
    """Is told of missions, and does nothing."""

    def begin(self, before: int) -> None:
        """Nothing."""

    def show(self, row: Row) -> None:
        """Nothing."""
