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
from onehop.study.chapter4 import failing, missions, ways
from onehop.study.chapter4.claims import (
    TO_MRSR,
    TO_VARIABLE,
    ideal_claim,
    policy_claims,
    routing_claims,
)
from onehop.study.claims import Judgement
from onehop.study.comparison import chosen, strata
from onehop.study.grid import Cell
from onehop.study.parts import Announce, cell, changed
from onehop.study.sweeping import Sweep, Wanted
from onehop.wire.output_folder import explained

SUMMARY = "study.json"


@dataclass(frozen=True, slots=True)
class Asked:
    """What is to be studied. scenarios: the folder of the missions. seeds: of every cell."""

    scenarios: Path
    settings: Sequence[str]
    seeds: range


@dataclass(slots=True)
class Found:
    """Rows of each part, as far as they have been run."""

    delayed: list[Row]
    undelayed: list[Row]
    bounds: list[Row]
    ways: list[Row]
    failing: list[Row]

    def judgements(self) -> list[Judgement]:
        """Every claim of chapter 4, and what came of it."""
        found = [*policy_claims(self.delayed), *routing_claims(self.delayed)]
        found.append(ideal_claim(self.undelayed))
        found.append(ways.way_claim(self.ways))
        return [*found, *failing.failing_claims(self.failing)]

    def cells(self) -> list[dict[str, Any]]:
        """The cells of 4.2."""
        return _cells(self.delayed, "map", "routing", "policy")

    def bound_cells(self) -> list[dict[str, Any]]:
        """The same missions with a perfect link, and with none."""
        return _cells(self.bounds, "map", "link")

    def differences(self) -> list[dict[str, Any]]:
        """From constant to variable k_rho, and from MRDV to MRSR, in each cell and over all of them."""
        rows = self.delayed
        found = []
        for key, (before, after), others in (
            ("policy", TO_VARIABLE, ("map", "routing")),
            ("routing", TO_MRSR, ("map", "policy")),
        ):
            every = strata(rows, *others)
            names = {"key": key, "against": before[key], key: after[key]}
            found += [changed({**names, **one}, rows, before, after, [one]) for one in every]
            all_of_them = dict.fromkeys(others, "all")
            found.append(changed({**names, **all_of_them}, rows, before, after, every))
        return found


def _cells(rows: Sequence[Row], *keys: str) -> list[dict[str, Any]]:
    return [cell(where, chosen(rows, where)) for where in strata(rows, *keys)]


class ThesisStudy:
    """The study in its folder. found, summary: as far as it came, whatever ended it."""

    def __init__(self, asked: Asked, folder: Path, workers: Run, announce: Announce) -> None:
        self._asked = asked
        self._folder = folder
        self._workers = workers
        self._announce = announce
        self._bases = missions.bases(asked.scenarios, asked.settings)
        self._rate = {"missions_per_s": 0.0, "sim_s_per_s": 0.0}
        self.found = Found([], [], [], [], [])
        self.crashed: list[Crashed] = []
        self.summary: dict[str, Any] | None = None

    def run(self) -> dict[str, Any]:
        """Run what the folder lacks, and give the summary. Raises InputError."""
        asked, found = self._asked, self.found
        try:
            self._sweep("4.2, followers delayed", "delayed", missions.delayed, found.delayed)
            self._sweep("4.2, nobody delayed", "undelayed", missions.undelayed, found.undelayed)
            self._sweep("bounds", "bounds", missions.bounds, found.bounds)
            alone = list(ways.orders(asked.scenarios, asked.seeds))
            self._collect("4.1, leaders alone", "ways.jsonl", ways.run_way, alone, found.ways)
            dying = list(failing.orders(asked.scenarios, asked.seeds))
            self._collect(
                "4.3, robots that fail", "failing.jsonl", failing.run_failing, dying, found.failing
            )
        finally:
            self.summary = self._told()
        return self.summary

    def _sweep(
        self,
        part: str,
        name: str,
        cells: Callable[[Path, Sequence[str], int], list[Cell]],
        rows: list[Row],
    ) -> None:
        """Run one sweep in a folder of its own; rows gets what there is, whatever ends it."""
        asked, folder = self._asked, self._folder / name
        with explained(folder, "a folder that can be written"):
            folder.mkdir(exist_ok=True)
        varied = cells(asked.scenarios, asked.settings, asked.seeds[0])
        wanted = Wanted(list(self._bases.values()), varied, asked.seeds)
        sweep = Sweep(wanted, folder, self._workers, self._announce(part, wanted.total))
        try:
            sweep.run()
        finally:
            rows += sweep.rows
            self.crashed += sweep.crashed
            if name == "delayed" and sweep.summary is not None:
                self._rate = {key: sweep.summary[key] for key in self._rate}

    def _collect(
        self,
        part: str,
        name: str,
        work: Callable[[Any], Row],
        orders: Sequence[Order],
        rows: list[Row],
    ) -> None:
        """Run a part that is no sweep, with a file of its own."""
        about = {"onehop": __version__, "part": part}
        listener = self._announce(part, len(orders))
        collection = Collection(self._folder / name, about, self._workers, listener)
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
            "table": str(self._folder / "delayed" / "missions.parquet"),
            "cells": found.cells(),
            "bounds": found.bound_cells(),
            "differences": found.differences(),
            "claims": [one.as_json() for one in found.judgements()],
            "crashed": [{"mission": one.name, "why": one.why} for one in self.crashed],
        }
        path = self._folder / SUMMARY
        with explained(path, "a folder that can be written"):
            path.write_text(json.dumps(told, indent=1) + "\n")
        return told
