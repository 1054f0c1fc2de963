"""`onehop compose`: a mission as containers, its compose file written from the scenario."""

import os
from pathlib import Path

from onehop.contracts.errors import InputError
from onehop.mission.compose_file import Source, compose_file
from onehop.programs.find import check, search_in
from onehop.scenario import scenario_file
from onehop.wire.output_folder import explained


def compose(scenario: Path, out: Path | None) -> int:
    """Write the file, or print it; returns the exit status."""
    bundle = scenario_file.load(scenario)
    search_in(bundle.folder)
    check(bundle.scenario, str(scenario))
    if bundle.scenario.commands:
        robot = min(bundle.scenario.commands)
        problem = f"robot {robot} is a command of your own, which the image does not have"
        raise InputError(str(scenario), problem, "a team of Python programs")
    for robot in bundle.scenario.bases:
        problem = f"robot {robot} has a real base, whose driver is no container of ours"
        raise InputError(str(scenario), problem, "a simulated team, or onehop run with --bus and --keys")
    folder = Path() if out is None else out.parent
    there = os.path.relpath(scenario.parent, folder)
    programs = os.path.relpath(bundle.folder, scenario.parent)
    target = "" if out is None else f" -o {out}"
    source = Source(
        folder=there if there.startswith(".") else f"./{there}",
        file=scenario.name,
        robots=bundle.scenario.team.robots,
        programs=programs if bundle.scenario.has_own_programs() else None,
        command=f"onehop compose {scenario}{target}",
        builds=(folder / "Dockerfile").exists(),
        clock=bundle.scenario.clock.mode,
    )
    text = compose_file(source)
    if out is None:
        print(text, end="")
        return 0
    with explained(out, "a file in a folder that exists and can be written"):
        out.write_text(text)
    print(f"{out}: world, radio, recorder and {len(source.robots)} robots")
    return 0
