"""`onehop run`: a mission from its scenario to its outcome, with a log, a summary and a figure."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from onehop.commands.output import emit_json, say, stdout, table
from onehop.contracts.messages import Action, Progress, RobotProgress
from onehop.mission.progress import Display
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.wire.summary import summarize, summary_file, write_summary

SHOW_S = 0.2
"""Wall-clock time between two updates of the progress display."""


def run(
    scenario: Path,
    driver: str,
    settings: list[str],
    seed: int | None,
    map_file: Path | None,
    start: str | None,
    goal: str | None,
    out: Path | None,
    record: bool,
    with_view: bool,
    as_json: bool,
) -> int:
    """Run one mission; returns the exit status."""
    bundle = scenario_file.load(
        scenario,
        settings,
        seed,
        map_file,
        scenario_file.point(start, "--start"),
        scenario_file.point(goal, "--goal"),
    )
    folder = out or _fresh_folder(bundle)
    folder.mkdir(parents=True, exist_ok=True)
    with Display(bundle.scenario) as display:
        if driver == "inline":
            with scenario_file.in_file(scenario):
                summary = _run_inline(bundle, folder, record, display.show)
        else:
            from onehop.mission import launcher

            arguments = launcher.world_arguments(scenario, settings, seed, map_file, start, goal)
            plan = launcher.LaunchPlan(arguments, bundle.scenario.team.robots, folder, record)
            summary = launcher.run(plan, display.show, display.tell)
    figure = _draw(folder, record)
    if with_view:
        _add_view(folder / "mission.mcap")
    if as_json:
        emit_json(summary)
    else:
        _print(summary, folder, figure)
    return 0 if summary["outcome"] == "arrived" else 1


def _fresh_folder(bundle: Bundle) -> Path:
    """runs/<scenario>-<seed>-<time>: a run never overwrites another."""
    stem = f"{bundle.scenario.name}-{bundle.scenario.seed}-{time.strftime('%Y%m%d-%H%M%S')}"
    folder = Path("runs") / stem
    number = 1
    while True:
        try:
            folder.mkdir(parents=True)
            return folder
        except FileExistsError:
            number += 1
            folder = Path("runs") / f"{stem}-{number}"


def _run_inline(
    bundle: Bundle, folder: Path, record: bool, show: Callable[[Progress], None]
) -> dict[str, Any]:
    from onehop.drivers import inline
    from onehop.wire.journal import Journal, WireMessage
    from onehop.wire.log_writer import LogWriter
    from world_server.core.world import World

    path = folder / "mission.mcap"
    log = LogWriter(path, bundle, "inline") if record else None

    def write(tick: int, messages: list[WireMessage]) -> None:
        if log is not None:
            log.write(tick, messages)

    journal = Journal(write)
    next_show = 0.0

    def watch(world: World, actions: dict[int, Action]) -> None:
        nonlocal next_show
        now = time.monotonic()
        if now >= next_show:
            next_show = now + SHOW_S
            lines = tuple(
                RobotProgress(i, action.twist.v, action.status) for i, action in actions.items()
            )
            show(Progress(world.tick, world.time_ns, lines))

    started = time.monotonic()
    outcome = inline.run(bundle, journal, watch)
    wall_s = time.monotonic() - started
    summary = summarize(outcome, wall_s, journal.digest(), str(path) if record else None)
    if log is not None:
        log.close(summary)
    write_summary(folder, summary)
    return summary


def _add_view(path: Path) -> None:
    """Put the viewer layer into a sound log; a torn one is left as it is."""
    if not path.is_file():
        return
    from onehop.analysis.log import open_log
    from onehop.analysis.view.layer import write_view

    log = open_log(path)
    if not log.torn:
        write_view(log, path)


def _draw(folder: Path, record: bool) -> Path | None:
    """The figure of the mission, if there is a log to draw it from."""
    path = folder / "mission.mcap"
    if not record or not path.is_file():
        return None
    from onehop.analysis.trajectory import draw_trajectory
    from onehop.wire.log_reader import LogFile

    figure = folder / "trajectory.png"
    draw_trajectory(LogFile(path), figure)
    return figure


def _print(summary: dict[str, Any], folder: Path, figure: Path | None) -> None:
    console = stdout()
    lost = {entry["robot"]: entry for entry in summary["lost"]}
    robots = table("Robots", "robot", "outcome", "at", "why")
    for robot in sorted({*summary["arrived"], *lost}):
        if robot in lost:
            entry = lost[robot]
            robots.add_row(str(robot), "lost", f"{entry['at_s']:.1f} s", entry["why"])
        else:
            robots.add_row(str(robot), "arrived", "", "")
    terms = table("Leaders", "from", "leader", "epoch", "shape", "members")
    for term in summary["leaders"]:
        members = " ".join(map(str, term["members"]))
        terms.add_row(
            f"{term['at_s']:.1f} s", str(term["leader"]), str(term["epoch"]), term["shape"], members
        )
    if robots.row_count:
        console.print(robots)
    if terms.row_count:
        console.print(terms)
    console.print(f"outcome     {summary['outcome']}: {summary['reason']}")
    console.print(
        f"simulated   {summary['sim_s']:.1f} s in {summary['wall_s']:.1f} s: {summary['ticks']} ticks, "
        f"{summary['ticks_per_s']:.0f} a second, {summary['real_time_factor']:.1f}x real time"
    )
    console.print(f"collisions  {summary['collisions']}")
    console.print(f"digest      {summary['digest'] or 'none: the recorder did not finish'}")
    console.print(f"log         {summary['log'] or 'none'}")
    if figure is not None:
        console.print(f"figure      {figure}")
    console.print(f"summary     {summary_file(folder)}")
    if summary["outcome"] == "aborted":
        say(f"onehop run: aborted: {summary['reason']}")
