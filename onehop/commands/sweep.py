"""`onehop sweep`: every combination of keys, each with the same seeds; what differs, and by how much."""

import importlib.util
import time
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

from rich.console import Console

from onehop.campaign.lines import Row
from onehop.campaign.workers import workers
from onehop.commands.output import emit_json, say, stdout, table
from onehop.commands.progress import ProgressLine
from onehop.mission.stops import Stopped
from onehop.programs.find import check, require_programs, search_in
from onehop.scenario import scenario_file
from onehop.study.grid import axis, cells
from onehop.study.in_words import interval
from onehop.study.mission import DIFFERS, FAILED, Keep
from onehop.study.sweeping import ROWS, Sweep, Wanted
from onehop.wire.output_folder import held

NO_PARQUET = (
    "Polars is not installed: pip install 'onehop[tables]', then the same command writes the table"
)


class HowMany(NamedTuple):
    """The numbers of the command line. jobs: None for one a core."""

    seeds: int
    first_seed: int
    jobs: int | None
    processes: float


class _Shown(NamedTuple):
    """How a measure is printed: its heading, and how many of its units are one of the heading's."""

    name: str
    heading: str
    scale: float = 1.0


_TABLES = (
    (
        _Shown("lost", "lost"), _Shown("sim_s", "time s"), _Shown("error_m", "error m"),
        _Shown("drive_j", "driving kJ", 1e3), _Shown("collisions", "contacts"),
    ),
    (
        _Shown("throughput_bps", "throughput kb/s", 1e3), _Shown("below_threshold_s", "below s"),
        _Shown("connected_share", "connected %", 0.01), _Shown("radio_j", "card J"),
        _Shown("delay_ms", "delay ms"), _Shown("routing_bytes", "routing kB", 1e3),
    ),
)  # fmt: skip


def sweep(
    scenario: Path,
    settings: list[str],
    over: list[str],
    how_many: HowMany,
    dask: str | None,
    out: Path | None,
    keep: Keep,
    as_json: bool,
) -> int:
    """Run a sweep; returns the exit status."""
    first, seeds = how_many.first_seed, how_many.seeds
    base = scenario_file.load(scenario, settings)
    search_in(base.folder)
    check(base.scenario, str(scenario))
    require_programs(base.scenario, str(scenario))
    varied = cells(scenario, settings, [axis(text) for text in over], first)
    wanted = Wanted([base], varied, range(first, first + seeds), keep, how_many.processes)
    folder = out or Path("runs") / f"sweep-{time.strftime('%Y%m%d-%H%M%S')}"
    if importlib.util.find_spec("polars") is None:
        say(f"{folder / ROWS} alone is written. {NO_PARQUET}")
    with held(folder), _Progress(wanted.total) as progress:
        one = Sweep(wanted, folder, workers(how_many.jobs, dask), progress)
        try:
            summary = one.run()
        except Stopped:
            progress.stop()
            if one.summary is not None:
                _tell(one.summary, as_json)
            raise
    _tell(summary, as_json)
    broken = summary["as_processes"].keys() & {DIFFERS, FAILED}
    return 1 if summary["crashed"] or broken else 0


class _Progress(ProgressLine):
    """How many missions are done, how fast, how long it takes, and how they ended."""

    def __init__(self, total: int) -> None:
        super().__init__(total)
        self._outcomes: Counter[str] = Counter()
        self._lost = 0

    def show(self, row: Row) -> None:
        """One more mission is done."""
        self._outcomes[row["outcome"]] += 1
        self._lost += row["lost"]
        self.count()

    def line(self) -> str:
        ends = [f"{count} {name}" for name, count in sorted(self._outcomes.items())]
        return f"{self.pace()}: {', '.join(ends)}, {self._lost} robots lost"


def _tell(summary: dict[str, Any], as_json: bool) -> None:
    if as_json:
        emit_json(summary)
        return
    console = stdout()
    short = _short_names(summary)
    for shown in _TABLES:
        _print_cells(console, summary["cells"], short, shown)
    for key in short:
        _print_differences(console, summary["differences"], short, key)
    done, wanted = summary["missions"], summary["wanted"]
    console.print(f"missions    {done}" + (f" of {wanted}" if done < wanted else ""))
    console.print(
        f"rate        {summary['missions_per_s']:.2f} missions, "
        f"{summary['sim_s_per_s']:.0f} s of mission time a second"
    )
    for word, count in sorted(summary["as_processes"].items()):
        console.print(f"processes   {count} {word}")
    for crash in summary["crashed"]:
        console.print(f"CRASHED     {crash['mission']}: {crash['why']}", markup=False)
    console.print(f"table       {summary['table'] or NO_PARQUET}", markup=False)


def _short_names(summary: dict[str, Any]) -> dict[str, str]:
    """The varied keys and their last parts, or the keys themselves where two would look the same."""
    keys = list(summary["cells"][0]) if summary["cells"] else []
    keys = keys[: keys.index("seeds")] if keys else []
    last = Counter(key.rpartition(".")[2] for key in keys)
    return {key: name if last[name := key.rpartition(".")[2]] == 1 else key for key in keys}


def _print_cells(
    console: Console, cells: list[dict[str, Any]], short: dict[str, str], shown: tuple[_Shown, ...]
) -> None:
    made = table(
        "Means and their 95 % intervals", *short.values(), "seeds", *(one.heading for one in shown)
    )
    for row in cells:
        values = (str(row[key]) for key in short)
        made.add_row(*values, str(row["seeds"]), *(_in_words(row, one) for one in shown))
    console.print(made)


def _print_differences(
    console: Console, differences: list[dict[str, Any]], short: dict[str, str], key: str
) -> None:
    """What changes from the first value of a key, if it has others."""
    rows = [row for row in differences if row["key"] == key]
    others = [other for other in short if other != key]
    for shown in _TABLES if rows else ():
        made = table(
            f"{short[key]} against {rows[0]['against']}, seed by seed",
            short[key], *(short[other] for other in others), "seeds", *(one.heading for one in shown),
        )  # fmt: skip
        for row in rows:
            values = (str(row[one]) for one in (key, *others, "seeds"))
            made.add_row(*values, *(_in_words(row, one) for one in shown))
        console.print(made)


def _in_words(row: dict[str, Any], shown: _Shown) -> str:
    mean, (low, high) = row[f"{shown.name}_mean"], row[f"{shown.name}_ci95"]
    return interval(mean, low, high, shown.scale)
