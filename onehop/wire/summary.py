"""The summary of a mission: what `onehop run` prints and summary.json holds.

One process of a mission writes the file: the launcher; without one the recorder; inline the run itself.
"""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from onehop.contracts.messages import Outcome
from onehop.wire.codec import as_map


class Process(NamedTuple):
    """One process of a mission."""

    name: str
    pid: int


def summarize(
    outcome: Outcome,
    wall_s: float,
    digest: str | None,
    log: str | None,
    processes: Iterable[Process] = (),
) -> dict[str, Any]:
    """The JSON object of `run`; wall_s is the time of the ticks alone, without start and end."""
    fields = as_map(outcome)
    rate = outcome.ticks / wall_s if wall_s > 0 else 0.0
    return {
        **{key: fields[key] for key in ("outcome", "reason", "arrived", "lost", "leaders")},
        "ticks": outcome.ticks,
        "sim_s": outcome.sim_s,
        "wall_s": round(wall_s, 3),
        "ticks_per_s": round(rate, 1),
        "real_time_factor": round(outcome.sim_s / wall_s, 2) if wall_s > 0 else 0.0,
        "processes": [process._asdict() for process in processes],
        "digest": digest,
        "log": log,
        "collisions": outcome.collisions,
    }


def summary_file(folder: Path) -> Path:
    """Where the summary of the mission lies whose output goes to `folder`."""
    return folder / "summary.json"


def write_summary(folder: Path, summary: Mapping[str, Any]) -> None:
    """Write summary.json."""
    folder.mkdir(parents=True, exist_ok=True)
    summary_file(folder).write_text(json.dumps(summary, indent=1) + "\n")
