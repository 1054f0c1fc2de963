"""The parts of a study: campaigns one after the other, each with a place of its own in one folder."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from onehop import __version__
from onehop.campaign.collection import Collection, Crashed, Order
from onehop.campaign.lines import Row
from onehop.campaign.listener import Listener
from onehop.campaign.workers import Run
from onehop.scenario.bundle import Bundle
from onehop.study.grid import Cell
from onehop.study.sweeping import Sweep, Wanted
from onehop.wire.output_folder import explained

Announce = Callable[[str, int], Listener]
"""Is told that a part of a study begins, and how much is wanted; gives who listens to it."""


OF_RUN = ("missions_per_s", "sim_s_per_s", "table")
"""What `--json` says of the run itself: how fast it was, and where the table is, None without Polars."""


def fewer(seeds: range) -> range:
    """The first quarter of the seeds: for what is only laid beside the cells that are compared."""
    return seeds[: max(2, len(seeds) // 4)]


class Parts:
    """Runs the parts of a study. names: of each part, for people. crashed: what has no row, of all."""

    def __init__(self, folder: Path, workers: Run, announce: Announce, names: Mapping[str, str]) -> None:
        self._folder = folder
        self._workers = workers
        self._announce = announce
        self._names = names
        self.crashed: list[Crashed] = []

    def sweep(
        self,
        part: str,
        bases: Sequence[Bundle],
        cells: Sequence[Cell],
        seeds: range,
        rows: list[Row],
        run: dict[str, Any] | None = None,
    ) -> None:
        """Run one sweep in a folder of its own, FOLDER/part.

        rows get the missions, and run gets what OF_RUN names, whatever ends it. Raises InputError.
        """
        folder = self._folder / part
        with explained(folder, "a folder that can be written"):
            folder.mkdir(exist_ok=True)
        wanted = Wanted(bases, cells, seeds)
        sweep = Sweep(wanted, folder, self._workers, self._announce(self._names[part], wanted.total))
        try:
            sweep.run()
        finally:
            rows += sweep.rows
            self.crashed += sweep.crashed
            if run is not None and sweep.summary is not None:
                run.update({key: sweep.summary[key] for key in OF_RUN})

    def collect(
        self,
        part: str,
        about: Mapping[str, Any],
        work: Callable[[Any], Row],
        orders: Sequence[Order],
        rows: list[Row],
    ) -> None:
        """Run what is no sweep, with a file of its own, FOLDER/part.jsonl.

        about: what must be the same to go on with it. rows: get what was run, whatever ends it. Raises
        InputError.
        """
        known = {"onehop": __version__, "part": part, **about}
        listener = self._announce(self._names[part], len(orders))
        collection = Collection(self._folder / f"{part}.jsonl", known, self._workers, listener)
        try:
            collection.run(work, orders)
        finally:
            place = {order.name: number for number, order in enumerate(orders)}
            rows += sorted(collection.rows, key=lambda row: place[row["name"]])
            self.crashed += collection.crashed
