"""`onehop study thesis`: chapter 4's missions, way-finding and failing robots, and what they say.

The folder holds a campaign for each part, which is gone on with if it was stopped; study.json, and at
the end the figures and the page thesis.html.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from onehop.campaign.collection import Crashed
from onehop.campaign.workers import Run
from onehop.scenario.bundle import Bundle
from onehop.study.chapter4 import failing, figures, missions, page, shown, way_figures, ways
from onehop.study.chapter4.found import Found
from onehop.study.parts import Announce, Parts, fewer
from onehop.wire.output_folder import explained

SUMMARY, PAGE, FIGURES, LOGS = "study.json", "thesis.html", "figures", "logs"

DELAYED, UNDELAYED, BOUNDS, WAYS, FAILING = "delayed", "undelayed", "bounds", "ways", "failing"

PARTS = {
    DELAYED: "4.2, followers delayed",
    UNDELAYED: "4.2, nobody delayed",
    BOUNDS: "4.2, perfect link and no link",
    WAYS: "4.1, leaders alone",
    FAILING: "4.3, robots that fail",
}
"""Name of each part in the folder, and for people."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What is to be studied. scenarios: folder of the missions. seeds: of each of the twelve cells."""

    scenarios: Path
    settings: Sequence[str]
    seeds: range


class ThesisStudy:
    """The study in its folder. found, summary: as far as it came, whatever ended it. page: if drawn."""

    def __init__(self, asked: Asked, folder: Path, workers: Run, announce: Announce) -> None:
        self._asked = asked
        self._folder = folder
        self._workers = workers
        self._parts = Parts(folder, workers, announce, PARTS)
        self._of_run: dict[str, Any] = {"missions_per_s": 0.0, "sim_s_per_s": 0.0, "table": None}
        self.found = Found()
        self.page: Path | None = None
        self.summary: dict[str, Any] | None = None

    @property
    def crashed(self) -> list[Crashed]:
        """Missions that have no row."""
        return self._parts.crashed

    def run(self) -> dict[str, Any]:
        """Run what the folder lacks, and give the summary. Raises InputError."""
        asked, found, parts = self._asked, self.found, self._parts
        bases = missions.bases(asked.scenarios, asked.settings)
        cells = {
            part: make(asked.scenarios, asked.settings, asked.seeds[0])
            for part, make in (
                (DELAYED, missions.delayed), (UNDELAYED, missions.undelayed), (BOUNDS, missions.bounds),
            )
        }  # fmt: skip
        alone = list(ways.orders(asked.scenarios, asked.seeds))
        dying = list(failing.orders(asked.scenarios, fewer(asked.seeds)))
        try:
            parts.sweep(DELAYED, bases, cells[DELAYED], asked.seeds, found.delayed, self._of_run)
            parts.sweep(UNDELAYED, bases, cells[UNDELAYED], fewer(asked.seeds), found.undelayed)
            parts.sweep(BOUNDS, bases, cells[BOUNDS], fewer(asked.seeds), found.bounds)
            parts.collect(WAYS, _about(alone), ways.run_way, alone, found.ways)
            parts.collect(FAILING, _about(dying), failing.run_failing, dying, found.failing)
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
        pictures = [*way_figures.draw(asked.scenarios, found.ways, folder), *figures.draw(logs, folder)]
        self.page = self._folder / PAGE
        self.summary = self._told()
        page.write(found, self.summary, pictures, asked.seeds, self.page)
        return self.page

    def _told(self) -> dict[str, Any]:
        """Write what the study says, and give it."""
        found, asked = self.found, self._asked
        twelve = len(missions.MAPS) * len(missions.ROUTINGS) * len(missions.POLICIES)
        told = {
            "missions": len(found.delayed),
            "wanted": twelve * len(asked.seeds),
            **self._of_run,
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


def _about(orders: Sequence[ways.WayOrder] | Sequence[failing.FailingOrder]) -> dict[str, Any]:
    """The scenarios of a part, but for their seeds."""
    scenarios = (replace(one.bundle.scenario, seed=1) for one in orders)
    return {"scenarios": sorted({Bundle(one, {}).scenario_json() for one in scenarios})}
