"""`onehop study thesis`: chapter 4's missions, way-finding and failing robots, and what they say.

The folder holds a campaign for each part, which is gone on with if it was stopped; study.json, and at
the end the figures and the page thesis.html.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onehop import __version__
from onehop.campaign.collection import Collection, Crashed, Order
from onehop.campaign.lines import Row
from onehop.campaign.workers import Run
from onehop.study.chapter4 import failing, figures, missions, page, shown, way_figures, ways
from onehop.study.chapter4.found import Found
from onehop.study.grid import Cell
from onehop.study.parts import Announce
from onehop.study.sweeping import TABLE, Sweep, Wanted
from onehop.wire.output_folder import explained

SUMMARY, PAGE, FIGURES, LOGS = "study.json", "thesis.html", "figures", "logs"

DELAYED = "delayed"

PARTS = {
    DELAYED: "4.2, followers delayed",
    "undelayed": "4.2, nobody delayed",
    "bounds": "4.2, perfect link and no link",
    "ways": "4.1, leaders alone",
    "failing": "4.3, robots that fail",
}
"""Name of each part in the folder, and for people."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What is to be studied. scenarios: folder of the missions. seeds: of each of the twelve cells."""

    scenarios: Path
    settings: Sequence[str]
    seeds: range

    @property
    def fewer(self) -> range:
        """The first quarter of the seeds: for what is only laid beside the twelve cells."""
        return self.seeds[: max(2, len(self.seeds) // 4)]


class ThesisStudy:
    """The study in its folder. found, summary: as far as it came, whatever ended it."""

    def __init__(self, asked: Asked, folder: Path, workers: Run, announce: Announce) -> None:
        self._asked = asked
        self._folder = folder
        self._workers = workers
        self._announce = announce
        self._bases = missions.bases(asked.scenarios, asked.settings)
        self._rate = {"missions_per_s": 0.0, "sim_s_per_s": 0.0}
        self.found = Found()
        self.crashed: list[Crashed] = []
        self.page: Path | None = None
        self.summary: dict[str, Any] | None = None

    def run(self) -> dict[str, Any]:
        """Run what the folder lacks, and give the summary. Raises InputError."""
        asked, found = self._asked, self.found
        try:
            self._sweep(DELAYED, missions.delayed, asked.seeds, found.delayed)
            self._sweep("undelayed", missions.undelayed, asked.fewer, found.undelayed)
            alone = list(ways.orders(asked.scenarios, asked.seeds))
            self._collect("ways", ways.run_way, alone, found.ways)
            dying = list(failing.orders(asked.scenarios, asked.fewer))
            self._collect("failing", failing.run_failing, dying, found.failing)
        finally:
            self.summary = self._told()
        return self.summary

    def draw(self) -> Path:
        """Draw the figures and write the page; gives the page. Raises InputError, MissionError."""
        asked, found = self._asked, self.found
        folder = self._folder / FIGURES
        with explained(folder, "a folder that can be written"):
            folder.mkdir(exist_ok=True)
        cells = missions.delayed(asked.scenarios, asked.settings, asked.seeds[0])
        logs = shown.logs(cells, found.delayed, self._folder / LOGS, self._workers)
        pictures = way_figures.draw(asked.scenarios, found.ways, folder)
        pictures += figures.draw(logs, folder)
        self.page = self._folder / PAGE
        self.summary = self._told()
        page.write(found, self.summary, pictures, asked.seeds, self.page)
        return self.page

    def _sweep(
        self,
        part: str,
        cells: Callable[[Path, Sequence[str], int], list[Cell]],
        seeds: range,
        rows: list[Row],
    ) -> None:
        """Run one sweep in a folder of its own; rows gets what there is, whatever ends it."""
        asked, folder = self._asked, self._folder / part
        with explained(folder, "a folder that can be written"):
            folder.mkdir(exist_ok=True)
        varied = cells(asked.scenarios, asked.settings, seeds[0])
        wanted = Wanted(list(self._bases.values()), varied, seeds)
        sweep = Sweep(wanted, folder, self._workers, self._announce(PARTS[part], wanted.total))
        try:
            sweep.run()
        finally:
            rows += sweep.rows
            self.crashed += sweep.crashed
            if part == DELAYED and sweep.summary is not None:
                self._rate = {key: sweep.summary[key] for key in self._rate}

    def _collect(
        self,
        part: str,
        work: Callable[[Any], Row],
        orders: Sequence[Order],
        rows: list[Row],
    ) -> None:
        """Run a part that is no sweep, with a file of its own."""
        about = {"onehop": __version__, "part": part}
        listener = self._announce(PARTS[part], len(orders))
        collection = Collection(self._folder / f"{part}.jsonl", about, self._workers, listener)
        try:
            collection.run(work, orders)
        finally:
            rows += sorted(collection.rows, key=lambda row: (str(row["values"]), row["seed"]))
            self.crashed += collection.crashed

    def _told(self) -> dict[str, Any]:
        """Write what the study says, and give it."""
        found, asked = self.found, self._asked
        twelve = len(missions.MAPS) * len(missions.ROUTINGS) * len(missions.POLICIES)
        told = {
            "missions": len(found.delayed),
            "wanted": twelve * len(asked.seeds),
            **self._rate,
            "table": str(self._folder / DELAYED / TABLE),
            "cells": found.cells(),
            "bounds": found.bound_cells(),
            "differences": found.differences(),
            "claims": [one.as_json() for one in found.judgements()],
            "page": None if self.page is None else str(self.page),
            "crashed": [{"mission": one.name, "why": one.why} for one in self.crashed],
        }
        path = self._folder / SUMMARY
        with explained(path, "a folder that can be written"):
            path.write_text(json.dumps(told, indent=1) + "\n")
        return told
