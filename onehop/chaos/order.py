"""What a worker of a campaign is told to do, and the row that comes of it."""

import tempfile
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from onehop.analysis.difference import compare
from onehop.analysis.log import open_log
from onehop.campaign.process_mission import run_as_processes
from onehop.chaos.properties import CRASH, SAME_BYTES
from onehop.chaos.shrink import Shrunk, shrink
from onehop.chaos.swarm import draw_mission
from onehop.chaos.trial import Failure, Trial, tried
from onehop.contracts.errors import OnehopError
from onehop.scenario.bundle import Bundle
from onehop.wire.output_folder import LOG

Row = dict[str, Any]

Repeat = Literal["once", "twice", "processes"]


@dataclass(frozen=True, slots=True)
class MissionOrder:
    """One mission to try. name: of the seed, or of the file from which it is taken as it is.

    repeat: whether it is run once more, and how, to see that its bytes are the same.
    """

    name: str
    base: Bundle
    seed: int | None
    budget: bool
    repeat: Repeat

    def bundle(self) -> Bundle:
        """The mission: drawn by the seed, or the base as it is."""
        return self.base if self.seed is None else draw_mission(self.base, self.seed, self.budget)


@dataclass(frozen=True, slots=True)
class ShrinkOrder:
    """One failure of a mission to make small. place: among all that were found."""

    place: int
    order: MissionOrder
    failure: Failure
    most_runs: int


def try_mission(order: MissionOrder) -> Row:
    """Run a mission, once or twice, and tell what came of it."""
    bundle = order.bundle()
    with tempfile.TemporaryDirectory(prefix="onehop-chaos-") as folder:
        path = Path(folder) / LOG
        trial = tried(bundle, log=path if order.repeat != "once" else None)
        failures = list(trial.failures)
        if trial.summary is not None and order.repeat != "once":
            failures += _repeated(bundle, path, order.repeat)
    return _row(order, bundle, trial, failures)


def _repeated(bundle: Bundle, path: Path, repeat: Repeat) -> list[Failure]:
    """Run a mission again, and find the first byte that is not the same."""
    folder = path.parent / "again"
    folder.mkdir()
    again = folder / LOG
    try:
        if repeat == "processes":
            run_as_processes(bundle, folder)
        else:
            failed = tried(bundle, SAME_BYTES, again).failures
            if failed:
                return [Failure(SAME_BYTES, -1, (), f"it fails only at times: {failed[0].what}")]
        first = compare(open_log(path), open_log(again)).first
    except OnehopError as error:
        return [Failure(CRASH, -1, (), f"as processes: {error}")]
    if first is None:
        return []
    other = "as processes" if repeat == "processes" else "the second time"
    where = f"{first.channel or 'ticks'}{f', {first.field}' if first.field else ''}"
    what = f"{where}: {first.a!r:.60} in one process, {first.b!r:.60} {other}"
    return [Failure(SAME_BYTES, first.tick, (), what)]


def _row(order: MissionOrder, bundle: Bundle, trial: Trial, failures: list[Failure]) -> Row:
    scenario, summary = bundle.scenario, trial.summary or {}
    return {
        "name": order.name,
        "seed": scenario.seed,
        "repeat": order.repeat,
        "robots": len(scenario.team.robots),
        "map": _map_in_a_word(scenario.map.file, len(scenario.map.obstacles)),
        "routing": scenario.radio.routing,
        "preset": scenario.radio.preset,
        "policy": scenario.gains.policy,
        "faults": dict(Counter(fault.kind for fault in scenario.faults)),
        "outcome": summary.get("outcome", "none"),
        "reason": summary.get("reason", ""),
        "arrived": len(summary.get("arrived", ())),
        "ticks": summary.get("ticks", 0),
        "sim_s": summary.get("sim_s", 0.0),
        "wall_s": summary.get("wall_s", 0.0),
        "digest": summary.get("digest"),
        "checked": trial.checked,
        "seen": {name: count for name, count in trial.seen.items() if count},
        "failures": [asdict(failure) for failure in failures],
    }


def _map_in_a_word(file: str, obstacles: int) -> str:
    return file or f"{obstacles} obstacles"


def shrink_failure(order: ShrinkOrder) -> Shrunk:
    """Make a failure small."""
    return shrink(order.order.bundle(), order.failure, order.most_runs)
