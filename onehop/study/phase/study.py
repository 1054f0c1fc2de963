"""`onehop study policies`: where a gain policy matters, over k_rho_min and the length of a delay.

The folder holds a sweep under the policies and one of the bounds, which are gone on with if they were
stopped; study.json, and at the end the heat maps and the page policies.html.
"""

import json
from pathlib import Path
from typing import Any

from onehop.analysis.report.canvas import save, styled
from onehop.campaign.collection import Crashed
from onehop.campaign.lines import Row
from onehop.campaign.workers import Run
from onehop.study.cell_summary import cell, changed
from onehop.study.comparison import chosen, strata
from onehop.study.page import Picture
from onehop.study.parts import Announce, Parts, fewer
from onehop.study.phase import page
from onehop.study.phase.grid import Grid
from onehop.study.phase.heat_maps import heat_maps
from onehop.wire.output_folder import explained

SUMMARY, PAGE, FIGURES = "study.json", "policies.html", "figures"

CELLS, BOUNDS = "cells", "bounds"

PARTS = {CELLS: "every policy", BOUNDS: "perfect link and no link"}
"""Name of each part in the folder, and for people."""


class PolicyStudy:
    """The study in its folder. rows, bounds, summary: as far as it came, whatever ended it."""

    def __init__(self, grid: Grid, seeds: range, folder: Path, workers: Run, announce: Announce) -> None:
        self._grid = grid
        self._seeds = seeds
        self._folder = folder
        self._parts = Parts(folder, workers, announce, PARTS)
        self._of_run: dict[str, Any] = {"missions_per_s": 0.0, "sim_s_per_s": 0.0, "table": None}
        self.rows: list[Row] = []
        self.bounds: list[Row] = []
        self.page: Path | None = None
        self.summary: dict[str, Any] | None = None

    @property
    def crashed(self) -> list[Crashed]:
        """Missions that have no row."""
        return self._parts.crashed

    def run(self) -> dict[str, Any]:
        """Run what the folder lacks, and give the summary. Raises InputError."""
        grid, seeds, bases = self._grid, self._seeds, [self._grid.base()]
        cells, bounds = grid.cells(seeds[0]), grid.bounds(seeds[0])
        try:
            self._parts.sweep(CELLS, bases, cells, seeds, self.rows, self._of_run)
            self._parts.sweep(BOUNDS, bases, bounds, fewer(seeds), self.bounds)
        finally:
            self.summary = self._told()
        return self.summary

    def draw(self) -> Path:
        """Draw the heat maps and write the page; gives the page. Raises InputError."""
        grid, folder = self._grid, self._folder / FIGURES
        with explained(folder, "a folder that can be written"):
            folder.mkdir(exist_ok=True)
        with styled():
            figure = heat_maps(self.rows, grid.k_rho_min, grid.hold_s, grid.policies)
            picture = Picture("Phase diagram", page.WHAT_TO_SEE, save(figure, folder, "policies"))
        self.page = self._folder / PAGE
        self.summary = self._told()
        page.write(grid, self.rows, self.summary, picture, self._seeds, self.page)
        return self.page

    def _told(self) -> dict[str, Any]:
        """Write what the study says, and give it."""
        grid, places = self._grid, strata(self.rows, "k_rho_min", "hold_s")
        first = grid.policies[0]
        cells = strata(self.rows, "k_rho_min", "hold_s", "policy")
        bounds = strata(self.bounds, "k_rho_min", "hold_s", "link")
        told = {
            "missions": len(self.rows),
            "wanted": len(grid.places) * len(grid.policies) * len(self._seeds),
            **self._of_run,
            "cells": [cell(where, chosen(self.rows, where)) for where in cells],
            "bounds": [cell(where, chosen(self.bounds, where)) for where in bounds],
            "differences": [
                changed(
                    {**place, "policy": policy, "against": first}, self.rows, {"policy": first},
                    {"policy": policy}, [place],
                )
                for policy in grid.policies[1:]
                for place in places
            ],
            "page": None if self.page is None else str(self.page),
            "crashed": [{"mission": one.name, "why": one.why} for one in self.crashed],
        }  # fmt: skip
        path = self._folder / SUMMARY
        with explained(path, "a folder that can be written"):
            path.write_text(json.dumps(told, indent=1) + "\n")
        return told
