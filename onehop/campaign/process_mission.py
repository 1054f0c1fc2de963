"""A mission of a campaign as processes, in a program of its own: it ends with whoever started it.

    python -m onehop.campaign.process_mission SCENARIO FOLDER --lifeline FD

It runs the mission as `onehop run` does and prints the summary as JSON, without figure and viewer layer.
"""

import argparse
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from onehop.contracts.errors import MissionError, ScenarioError
from onehop.contracts.printable import printable
from onehop.mission import launcher
from onehop.node import lifeline
from onehop.scenario import scenario_file
from onehop.scenario.as_toml import as_toml
from onehop.scenario.bundle import Bundle
from onehop.wire.output_folder import claimed

LINKS = "measured-links.csv"
"""Name of a trace of measured links beside a scenario that stands for itself."""

LIMIT_S = 600.0
"""Wall-clock time that a mission may take [s]."""


def run_as_processes(bundle: Bundle, folder: Path) -> dict[str, Any]:
    """Run a mission as processes; its log is in `folder`. Raises MissionError."""
    scenario = write_scenario(bundle, folder / "scenario.toml")
    reading, writing = os.pipe()
    command = [sys.executable, "-m", __name__, str(scenario), str(folder), "--lifeline", str(reading)]
    try:
        done = subprocess.run(
            command, pass_fds=(reading,), capture_output=True, text=True, timeout=LIMIT_S, check=False
        )
    except subprocess.TimeoutExpired:
        raise MissionError(f"still runs after {LIMIT_S:g} s") from None
    finally:
        os.close(reading)
        os.close(writing)
    if done.returncode:
        raise MissionError((done.stderr.strip() or "it said nothing").splitlines()[-1])
    summary: dict[str, Any] = json.loads(done.stdout)
    return summary


def write_scenario(bundle: Bundle, path: Path, comment: str = "") -> Path:
    """Write a mission as a scenario file, with the map's files beside it.

    The programs of its robots stay where they are, and the file says where that is.
    """
    scenario = bundle.scenario
    if bundle.folder and scenario.has_own_programs():
        scenario = replace(scenario, programs=bundle.folder)
    for name, data in bundle.files.items():
        if not Path(name).is_absolute():
            (path.parent / name).parent.mkdir(parents=True, exist_ok=True)
            (path.parent / name).write_bytes(data)
    path.write_text(as_toml(scenario, comment), encoding="utf-8")
    return path


def self_contained(bundle: Bundle, where: str) -> Bundle:
    """The same mission with its map's file and its links beside it.

    Raises ScenarioError if they cannot be there.
    """
    bundle = _with_links_beside(bundle)
    own = bundle.scenario.map
    if not own.file:
        return bundle
    for name in bundle.files:
        if name != own.file and ".." in Path(name).parts:
            remedy = "an image beside the map's file, or named absolutely"
            raise ScenarioError(f"{where}: map.file", f"its image is {printable(name, 80)}", remedy)
    beside = Path(own.file).name
    files = {beside if name == own.file else name: data for name, data in bundle.files.items()}
    return replace(bundle, scenario=replace(bundle.scenario, map=replace(own, file=beside)), files=files)


def _with_links_beside(bundle: Bundle) -> Bundle:
    """The same mission with its trace of measured links as LINKS."""
    radio = bundle.scenario.radio
    if not radio.links:
        return bundle
    files = {LINKS if name == radio.links else name: data for name, data in bundle.files.items()}
    return Bundle(replace(bundle.scenario, radio=replace(radio, links=LINKS)), files)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenario", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--lifeline", type=int, required=True)
    options = parser.parse_args()
    lifeline.hold(options.lifeline)
    bundle = scenario_file.load(options.scenario)
    with claimed(options.folder) as claim:
        arguments = launcher.world_arguments(options.scenario, (), None, None, None, None)
        plan = launcher.plan(bundle, arguments, options.folder, claim, record=True)
        print(json.dumps(launcher.run(plan, lambda _: None)))


if __name__ == "__main__":
    main()
