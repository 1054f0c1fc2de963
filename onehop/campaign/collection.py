"""What a campaign wants, kept in a file: what the file lacks is run, each result added as it ends."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from onehop.campaign.lines import Lines, Row
from onehop.campaign.listener import Listener
from onehop.campaign.workers import Crash, Run


class Order(Protocol):
    """One thing to run. name: of its row, and no other's."""

    @property
    def name(self) -> str: ...


@dataclass(frozen=True, slots=True)
class Crashed:
    """What has no row, because its worker failed or died; the next call tries it again."""

    name: str
    why: str


class Collection:
    """Rows of a file, and those that are added now.

    began: the file could be gone on with. rows: of what is wanted, in the order in which they came.
    run_now: those of them that were run by this call. wall_s: how long that took [s]. All of it is there
    whatever ends the run.
    """

    def __init__(self, path: Path, about: Mapping[str, Any], workers: Run, listener: Listener) -> None:
        """about: what must be the same to go on with the file, see Lines."""
        self._path = path
        self._about = about
        self._workers = workers
        self._listener = listener
        self.began = False
        self.rows: list[Row] = []
        self.run_now: list[Row] = []
        self.crashed: list[Crashed] = []
        self.wall_s = 0.0

    def rate(self) -> dict[str, float]:
        """missions_per_s and sim_s_per_s of this call: missions, and their time [s], a second."""
        ran = max(self.wall_s, 1e-9)
        return {
            "missions_per_s": round(len(self.run_now) / ran, 4),
            "sim_s_per_s": round(sum(row["sim_s"] for row in self.run_now) / ran, 1),
        }

    def run(self, work: Callable[[Any], Row], orders: Sequence[Order]) -> None:
        """Run what is missing. work: a function of a module. Raises InputError."""
        named = {order.name: order for order in orders}
        with Lines(self._path, self._about) as lines:
            self.rows = [row for row in lines.rows if row["name"] in named]
            done = {row["name"] for row in self.rows}
            missing = [order for name, order in named.items() if name not in done]
            self.began = True
            self._listener.begin(len(done))
            started = time.monotonic()
            try:
                for one in self._workers(work, missing):
                    if isinstance(one.result, Crash):
                        self.crashed.append(Crashed(one.item.name, one.result.why))
                        continue
                    lines.add(one.result)
                    self.rows.append(one.result)
                    self.run_now.append(one.result)
                    self._listener.show(one.result)
            finally:
                self.wall_s = time.monotonic() - started
