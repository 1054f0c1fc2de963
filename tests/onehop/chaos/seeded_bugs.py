"""Plausible bugs, put into a copy of the programs: after how many missions does chaos find each?

    python -m tests.onehop.chaos.seeded_bugs            all of them, as a table
    python -m tests.onehop.chaos.seeded_bugs "never yields"

A campaign that finds nothing in good programs says little by itself: it might not be able to.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[3]
PROGRAMS = ("onehop", "robot_agent", "world_server", "radio_proxy", "scenarios")


@dataclass(frozen=True, slots=True)
class Bug:
    """One mistake: in a file, this text in the place of that."""

    file: str
    right: str
    wrong: str


BUGS = {
    "the epoch of a Next is ignored": Bug(
        "robot_agent/core/team/rules.py",
        "        return waits or roster.beats(mine)\n",
        "        return waits or True\n",
    ),
    "joining makes no new epoch": Bug(
        "robot_agent/core/team/roster.py",
        "return Roster(following(towards(self.epoch, epoch)), ",
        "return Roster(self.epoch or towards(following(0), epoch), ",
    ),
    "a second copy is delivered": Bug(
        "radio_proxy/core/deliveries.py",
        "if not message.has_verdict:\n            message.has_verdict = True\n            self.record",
        "if True:\n            message.has_verdict = True\n            self.record",
    ),
    "a missing acknowledgement is not counted": Bug(
        "robot_agent/core/team/follower_ledger.py",
        "self._misses[robot] = 0 if answered else self._misses[robot] + 1",
        "self._misses[robot] = 0",
    ),
    "a leader never yields": Bug(
        "robot_agent/core/team/rules.py",
        "return Meeting.IGNORE if source in mine.members else Meeting.MERGE",
        "return Meeting.IGNORE",
    ),
    "an elected leader that is silent is waited for": Bug(
        "robot_agent/core/team/protocol.py",
        "                patience_ns = part.patience_ns\n",
        "                patience_ns = 1 << 62\n",
    ),
    "a cut stops only one direction": Bug(
        "radio_proxy/core/propagation.py",
        "[: 2 - cut.one_way]",
        "[:1]",
    ),
}


def plant(bug: Bug, folder: Path) -> None:
    """Copy the programs, with what was compiled of them, and put the bug into the copy."""
    for name in PROGRAMS:
        shutil.copytree(ROOT / name, folder / name)
    path = folder / bug.file
    text = path.read_text(encoding="utf-8")
    if text.count(bug.right) != 1:
        raise ValueError(f"{bug.file} has no such text: {bug.right}")
    path.write_text(text.replace(bug.right, bug.wrong), encoding="utf-8")


def run_in(folder: Path, *arguments: str) -> "subprocess.CompletedProcess[str]":
    """`onehop chaos` of a copy."""
    command = [sys.executable, "-m", "onehop", "chaos", *arguments]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def hunt(bug: Bug, folder: Path, runs: int, jobs: int, shrink_runs: int = 400) -> dict[str, Any]:
    """Let chaos look for a bug in the copy; what it prints as JSON."""
    plant(bug, folder)
    numbers = ("--runs", str(runs), "--jobs", str(jobs), "--shrink-runs", str(shrink_runs))
    done = run_in(folder, "scenarios/map1.toml", "--until-found", "--json", *numbers, "--out", "out")
    if done.returncode == 2 or not done.stdout:
        raise ValueError(done.stderr)
    told: dict[str, Any] = json.loads(done.stdout)
    return told


def size_of(told: dict[str, Any], folder: Path) -> str:
    """How small the first failure has become, in words."""
    path = told["failures"][0]["scenario"]
    if path is None:
        return "not shrunk"
    scenario = tomllib.loads((folder / path).read_text(encoding="utf-8"))
    faults = [fault["kind"] for fault in scenario.get("faults", [])]
    robots = scenario.get("team", {}).get("size", 6)
    return (
        f"{robots} robots, {len(faults)} faults ({', '.join(faults)}), {scenario['clock']['limit_s']} s"
    )


def main(names: Iterable[str], runs: int, jobs: int) -> None:
    print("| bug | found after | by | made small to |\n|---|---|---|---|")
    for name in names:
        with tempfile.TemporaryDirectory(prefix="onehop-bug-") as folder:
            told = hunt(BUGS[name], Path(folder), runs, jobs)
            if not told["failures"]:
                print(f"| {name} | not in {told['runs']} missions | | |", flush=True)
                continue
            by = ", ".join(sorted({failure["invariant"] for failure in told["failures"]}))
            small = size_of(told, Path(folder))
            print(f"| {name} | {told['runs']} missions | {by} | {small} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="BUG", help=f"of: {'; '.join(BUGS)}")
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    main(options.names or list(BUGS), options.runs, options.jobs)
