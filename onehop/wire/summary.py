"""The summary of a mission: what `onehop run` prints and summary.json holds.

The recorder writes the file when it has finished the log. A launcher writes it again with what it alone
knows, and takes from it what it has missed. Inline the run itself writes it.
"""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import msgspec

from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import LeadershipTerm, Lost, Outcome
from onehop.contracts.operation import Punctuality
from onehop.contracts.printable import printable
from onehop.wire.codec import REFUSALS, as_map
from onehop.wire.output_folder import REMEDY, SUMMARY, explained


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
    punctuality: Punctuality | None = None,
) -> dict[str, Any]:
    """The JSON object of `run`; wall_s is the time of the ticks alone, without start and end.

    punctuality: of a mission in real time, under the key `realtime`.
    """
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
        **({} if punctuality is None else {"realtime": as_map(punctuality)}),
    }


class _Summary(msgspec.Struct):
    """What every reader of a summary relies on; whatever else is in it is left as it is."""

    outcome: Literal["arrived", "failed", "aborted"]
    reason: str
    arrived: list[int]
    lost: list[Lost]
    leaders: list[LeadershipTerm]
    ticks: Annotated[int, msgspec.Meta(ge=0)]
    sim_s: float
    digest: str | None
    collisions: int
    realtime: Punctuality | None = None


def punctuality_of(summary: Mapping[str, Any]) -> Punctuality | None:
    """How a mission of real time kept its schedule; None for one in lock-step."""
    said = summary.get("realtime")
    return None if said is None else msgspec.convert(said, Punctuality)


def decode_summary(text: str) -> dict[str, Any]:
    """The inverse of json.dumps for a summary. Raises DecodeError for anything else."""
    try:
        fields: dict[str, Any] = msgspec.json.decode(text)
        msgspec.convert(fields, _Summary)
    except REFUSALS as error:
        raise DecodeError(printable(str(error))) from None
    return fields


def summary_file(folder: Path) -> Path:
    """Where the summary of the mission lies whose output goes to `folder`."""
    return folder / SUMMARY


def write_summary(folder: Path, summary: Mapping[str, Any]) -> None:
    """Write summary.json, whole or not at all. Raises InputError."""
    path = summary_file(folder)
    draft = path.with_name(path.name + ".part")
    with explained(path, REMEDY):
        draft.write_text(json.dumps(summary, indent=1) + "\n")
        draft.replace(path)


def read_summary(folder: Path) -> dict[str, Any] | None:
    """What write_summary has left in a folder; None if it has not."""
    try:
        summary: dict[str, Any] = json.loads(summary_file(folder).read_text())
    except FileNotFoundError:
        return None
    return summary
