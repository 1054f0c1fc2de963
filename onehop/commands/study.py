"""`onehop study`: chapter 4 of the thesis again, and where a gain policy matters."""

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from rich.console import Console

from onehop.campaign.collection import Crashed
from onehop.campaign.lines import Row
from onehop.campaign.workers import workers
from onehop.commands.output import emit_json, stdout, table
from onehop.commands.progress import ProgressLine
from onehop.mission.stops import Stopped
from onehop.study.chapter4.study import Asked, ThesisStudy
from onehop.study.in_words import told
from onehop.study.page import measured
from onehop.study.phase.grid import Grid
from onehop.study.phase.page import in_short
from onehop.study.phase.study import PolicyStudy
from onehop.wire.output_folder import held


class HowMany(NamedTuple):
    """What the command line says of how much. jobs: None for one a core. figures: and the page."""

    seeds: int
    first_seed: int
    jobs: int | None
    figures: bool

    @property
    def range(self) -> range:
        """The seeds themselves."""
        return range(self.first_seed, self.first_seed + self.seeds)


class Progress(ProgressLine):
    """Which part of a study is under way, how far it is, and how fast."""

    def __init__(self) -> None:
        super().__init__(0)
        self._part = ""

    def announce(self, part: str, total: int) -> "Progress":
        """A part begins."""
        self._part, self._total, self._done = part, total, 0
        return self

    def show(self, row: Row) -> None:  # noqa: ARG002 - a listener's method
        """One more mission is done."""
        self.count()

    def line(self) -> str:
        return f"{self._part}: {self.pace()}"


class Study(Protocol):
    """What both studies are. summary: None before they ran."""

    summary: dict[str, Any] | None

    @property
    def crashed(self) -> list[Crashed]: ...

    def run(self) -> dict[str, Any]: ...

    def draw(self) -> Path: ...


def thesis(
    scenarios: Path,
    settings: list[str],
    how_many: HowMany,
    dask: str | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Chapter 4; returns the exit status."""
    folder, progress = out or _fresh("thesis"), Progress()
    asked = Asked(scenarios, settings, how_many.range)
    study = ThesisStudy(asked, folder, workers(how_many.jobs, dask), progress.announce)
    return _run(study, folder, progress, how_many, lambda: _tell_thesis(study, as_json))


def policies(grid: Grid, how_many: HowMany, dask: str | None, out: Path | None, as_json: bool) -> int:
    """The phase diagram; returns the exit status."""
    folder, progress = out or _fresh("policies"), Progress()
    seeds, run = how_many.range, workers(how_many.jobs, dask)
    study = PolicyStudy(grid, seeds, folder, run, progress.announce)
    return _run(study, folder, progress, how_many, lambda: _tell_policies(study, grid, as_json))


def _run(
    study: Study, folder: Path, progress: Progress, how_many: HowMany, tell: Callable[[], None]
) -> int:
    """Run a study and tell what it says, also if it is stopped."""
    with held(folder), progress:
        try:
            study.run()
            if how_many.figures:
                progress.put("drawing figures …")
                study.draw()
        except Stopped:
            progress.stop()
            if study.summary is not None:
                tell()
            raise
    tell()
    return 1 if study.crashed else 0


def _fresh(name: str) -> Path:
    return Path("runs") / f"study-{name}-{time.strftime('%Y%m%d-%H%M%S')}"


class _Column(NamedTuple):
    """heading, name in `--json`, and how many of its units are one of the heading's."""

    heading: str
    name: str
    scale: float = 1.0


_COLUMNS = (
    _Column("lost", "lost_mean"), _Column("throughput kb/s", "throughput_mean_bps", 1e3),
    _Column("below s", "below_threshold_s"), _Column("error m", "error_m"),
    _Column("routing kB", "overhead_bytes", 1e3), _Column("delay ms", "delay_ms"),
)  # fmt: skip


def _tell_thesis(study: ThesisStudy, as_json: bool) -> None:
    if as_json:
        emit_json(study.summary or {})
        return
    console, summary = stdout(), study.summary or {}
    _print_cells(console, "Missions of 4.2", summary["cells"], ("map", "routing", "policy"))
    _print_cells(console, "Bounds", summary["bounds"], ("map", "link"))
    made = table("Claims of chapter 4", "claim", "measured", "seeds", "verdict")
    for one in study.found.judgements():
        made.add_row(one.claim.says, measured(one), str(one.seeds), str(one.verdict))
    console.print(made)
    _print_rest(console, summary)


def _tell_policies(study: PolicyStudy, grid: Grid, as_json: bool) -> None:
    if as_json:
        emit_json(study.summary or {})
        return
    console, summary = stdout(), study.summary or {}
    _print_cells(console, "Every place", summary["cells"], ("k_rho_min", "hold_s", "policy"))
    _print_cells(console, "Bounds", summary["bounds"], ("k_rho_min", "hold_s", "link"))
    for policy in grid.policies[1:]:
        short = in_short(grid, study.rows, policy)
        console.print(f"{policy} against {grid.policies[0]}: {short}", markup=False)
    _print_rest(console, summary)


def _print_cells(
    console: Console, title: str, cells: Sequence[dict[str, Any]], keys: tuple[str, ...]
) -> None:
    made = table(title, *keys, "seeds", *(one.heading for one in _COLUMNS))
    for cell in cells:
        values = (told(cell, one.name, one.scale) for one in _COLUMNS)
        made.add_row(*(str(cell[key]) for key in keys), str(cell["seeds"]), *values)
    if cells:
        console.print(made)


def _print_rest(console: Console, summary: dict[str, Any]) -> None:
    done, wanted = summary["missions"], summary["wanted"]
    console.print(f"missions    {done}" + (f" of {wanted}" if done < wanted else ""))
    console.print(
        f"rate        {summary['missions_per_s']:.2f} missions, "
        f"{summary['sim_s_per_s']:.0f} s of mission time a second"
    )
    for crash in summary["crashed"]:
        console.print(f"CRASHED     {crash['mission']}: {crash['why']}", markup=False)
    if summary["page"] is not None:
        console.print(f"page        {summary['page']}", markup=False)
