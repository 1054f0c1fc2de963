"""`onehop chaos`: random missions, each judged from its log; failures are made small."""

import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from onehop.campaign.lines import Row
from onehop.campaign.process_mission import self_contained
from onehop.campaign.workers import workers
from onehop.chaos import account
from onehop.chaos.hunt import PAGE, Hunt, Wanted
from onehop.chaos.page import write_page
from onehop.commands.output import emit_json, stdout, table
from onehop.commands.progress import ProgressLine
from onehop.contracts.errors import InputError
from onehop.mission.stops import Stopped
from onehop.programs.find import check, require_programs, search_in
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.wire.output_folder import explained, held


class HowMany(NamedTuple):
    """The numbers of the command line. jobs: None for one a core."""

    runs: int
    first_seed: int
    jobs: int | None
    processes: float
    twice_every: int
    until_found: bool
    shrink_runs: int


def chaos(
    scenario: Path,
    settings: list[str],
    how_many: HowMany,
    dask: str | None,
    out: Path | None,
    corpus: Path | None,
    as_is: bool,
    budget: bool,
    as_json: bool,
) -> int:
    """Run a campaign; returns the exit status."""
    base = _loaded(scenario, settings)
    taken = _corpus(corpus) if corpus is not None else {}
    if as_is:
        taken[scenario.name] = base
    first, runs = how_many.first_seed, 0 if as_is else how_many.runs
    wanted = Wanted(
        base, range(first, first + runs), taken, budget, how_many.processes, how_many.twice_every
    )
    folder = out or Path("runs") / f"chaos-{time.strftime('%Y%m%d-%H%M%S')}"
    with held(folder), _Progress(len(taken) + runs) as progress:
        hunt = Hunt(wanted, folder, workers(how_many.jobs, dask), progress)
        try:
            hunt.try_missions(how_many.until_found)
            if how_many.shrink_runs and hunt.found:
                progress.say_shrinking(len(hunt.found))
                hunt.shrink(how_many.shrink_runs)
        except Stopped:
            _tell(hunt, folder, as_json)
            raise
    _tell(hunt, folder, as_json)
    return account.exit_status(hunt)


def _corpus(folder: Path) -> dict[str, Bundle]:
    """Every scenario file of a folder, by name. Raises InputError."""
    with explained(folder, "a folder with scenario files"):
        paths = sorted(path for path in folder.iterdir() if path.suffix == ".toml")
    if not paths:
        raise InputError(f"--corpus {folder}", "has no scenario file", "files that end in .toml")
    return {path.name: _loaded(path) for path in paths}


def _loaded(path: Path, settings: Sequence[str] = ()) -> Bundle:
    """A scenario file whose programs are there, with its map beside it. Raises InputError."""
    bundle = scenario_file.load(path, settings)
    search_in(bundle.folder)
    check(bundle.scenario, str(path))
    require_programs(bundle.scenario, str(path))
    return self_contained(bundle, str(path))


class _Progress(ProgressLine):
    """How many missions are done, how fast, and what was found."""

    def __init__(self, total: int) -> None:
        super().__init__(total)
        self._found: Counter[str] = Counter()
        self._outcomes: Counter[str] = Counter()

    def show(self, row: Row) -> None:
        """One more mission is done."""
        self._outcomes[row["outcome"]] += 1
        self._found.update(failure["property"] for failure in row["failures"])
        self.count()

    def say_shrinking(self, found: int) -> None:
        """The missions are done; failures are made small."""
        self.put(f"making {found} failures small")

    def line(self) -> str:
        kinds = [f"{count} {name}" for name, count in sorted(self._found.items())]
        ends = [f"{count} {name}" for name, count in sorted(self._outcomes.items())]
        found = ", ".join(kinds) or "nothing broken"
        return f"{self.pace()}: {', '.join(ends)}; {found}"


def _tell(hunt: Hunt, folder: Path, as_json: bool) -> None:
    page = write_page(hunt, folder / PAGE)
    told = {**account.as_json(hunt), "page": str(page)}
    if as_json:
        emit_json(told)
        return
    console = stdout()
    properties = table("What must hold", "property", "judged in", "broken in", "says")
    properties.columns[-1].justify = "left"
    for line in account.property_lines(hunt):
        properties.add_row(line.name, str(line.judged), str(line.broken or "-"), line.says)
    console.print(properties)
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in sorted(told["outcomes"].items()))
    faults = ", ".join(f"{count} {kind}" for kind, count in told["faults"].items())
    repeated = told["repeated"]
    console.print(f"missions    {told['runs']}: {outcomes or 'none'}; {told['robot_hours']} robot-hours")
    console.print(f"rate        {told['missions_per_s']:.2f} missions a second")
    console.print(f"faults      {faults or 'none'}")
    console.print(f"repeated    {repeated['twice']} twice, {repeated['processes']} as processes")
    if hunt.draws:
        never = ", ".join(told["never"]) or "nothing: all has happened that should"
        console.print(f"never       {never}")
    for one in hunt.found:
        console.print(
            f"BROKEN      {one.failure.property} in {one.name}: {one.failure.what}", markup=False
        )
        if one.scenario is not None:
            console.print(f"            again: onehop chaos {one.scenario} --as-is", markup=False)
    console.print(f"page        {page}")
