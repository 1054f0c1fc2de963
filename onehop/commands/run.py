"""`onehop run`: a mission from its scenario to its outcome, with a log, a summary and a figure."""

import contextlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onehop.commands.output import emit_json, say, stdout, table
from onehop.commands.ros2 import Ros2, bridge
from onehop.contracts.errors import InputError
from onehop.mission.placement import WAIT_S, Placement, on_hosts
from onehop.mission.progress import Display
from onehop.node.startup import DEFAULT_MISSION
from onehop.programs.find import check, require_programs, search_in
from onehop.scenario import scenario_file
from onehop.scenario.bundle import Bundle
from onehop.wire.output_folder import FIGURE, REMEDY, claimed, explained
from onehop.wire.summary import punctuality_of, summary_file, write_summary


@dataclass(frozen=True, slots=True)
class Hosts:
    """Options of a mission on several hosts, as they are typed; see placement.on_hosts."""

    bus: str | None = None
    keys: Path | None = None
    remote: str = ""
    mission: str = DEFAULT_MISSION
    wait_s: float = WAIT_S
    router: str = "world"


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
    with_figure: bool,
    as_json: bool,
    program: str | None = None,
    hosts: Hosts | None = None,
    live: str | None = None,
    browser: bool = True,
    ros2: Ros2 | None = None,
) -> int:
    """Run one mission; returns the exit status.

    program: of the team, in place of the scenario's. hosts: the bus of a mission on several hosts.
    live: where the live page is served (guard.parse_address). browser: open it, if there is a screen.
    ros2: where ROS 2 nodes see it.
    """
    for option, is_given in (("--live", live is not None), ("--ros2", ros2 is not None)):
        if is_given:
            _require_what_is_shown(option, driver, record)
    if program is not None:
        settings = [*settings, f"team.program={program}"]
    bundle = scenario_file.load(
        scenario,
        settings,
        seed,
        map_file,
        scenario_file.point(start, "--start"),
        scenario_file.point(goal, "--goal"),
    )
    search_in(bundle.folder)
    check(bundle.scenario, str(scenario))
    if driver == "inline":
        require_programs(bundle.scenario, str(scenario))
    placement = _placed(hosts or Hosts(), driver, bundle)
    folder = out or _fresh_folder(bundle)
    with contextlib.ExitStack() as page, claimed(folder) as claim:
        shown = None
        if live is not None:
            from onehop.commands.live import live_page, words_of

            places = (("--map", map_file), ("--start", start), ("--goal", goal))
            words = words_of(scenario, settings, bundle.scenario.seed, places)
            is_paced = not bundle.scenario.clock.is_realtime
            shown = page.enter_context(live_page(live, browser, folder, words, is_paced))
        if ros2 is not None:
            page.enter_context(bridge(ros2, folder))
        with Display(bundle.scenario) as display:
            if driver == "inline":
                from onehop.commands.inline_run import run_inline

                with scenario_file.in_file(scenario):
                    summary = run_inline(bundle, folder, record, display.show, display.tell)
            else:
                from onehop.mission import launcher

                arguments = launcher.world_arguments(scenario, settings, seed, map_file, start, goal)
                plan = launcher.plan(bundle, arguments, folder, claim, record, placement)
                attend = launcher.nobody if shown is None else shown.attend
                summary = launcher.run(plan, display.show, display.tell, attend)
        if summary["log"] is not None:
            summary["energy"] = _energy(Path(summary["log"]))
            write_summary(folder, summary)
        if as_json:
            emit_json(summary)
        else:
            _print(summary, folder)
        if summary["log"] is not None:
            log = Path(summary["log"])
            if with_figure:
                figure = _draw(log)
                if not as_json:
                    print(f"figure      {figure}")
            if with_view:
                _add_view(log)
        if shown is not None:
            shown.stay(summary)
    return 0 if summary["outcome"] == "arrived" else 1


def _placed(hosts: Hosts, driver: str, bundle: Bundle) -> Placement | None:
    """Where the mission's processes are to run. Raises InputError."""
    bases = bundle.scenario.bases
    if hosts == Hosts():
        _require_drivers(bases)
        return None
    if driver == "inline":
        raise InputError("--driver inline", "has no bus", "leave --bus, --keys and --remote out")
    if hosts.bus is None:
        raise InputError("--bus", "missing", "where the world is to listen, e.g. tls/10.0.0.1:7447")
    robots = bundle.scenario.team.robots
    external = hosts.router == "external"
    where = hosts.bus, hosts.keys, hosts.remote, hosts.mission, hosts.wait_s
    return on_hosts(*where, robots, external, bases)


def _require_drivers(bases: Mapping[int, Sequence[str]]) -> None:
    """Raises InputError for a real base whose driver has no way in: only children get passwords."""
    for robot, command in bases.items():
        if not command:
            what = f"robot {robot} has a real base, and its driver comes to this mission from elsewhere"
            remedy = "--bus tls/HOST:PORT --keys DIR (docs/hardware.md), or base_command for one here"
            raise InputError("--bus", what, remedy)


def _require_what_is_shown(option: str, driver: str, record: bool) -> None:
    """Raises InputError for a mission that has no log while it runs."""
    if driver == "inline":
        raise InputError(option, "a mission in one process is not watched", "--driver processes")
    if not record:
        raise InputError(option, "it shows the log as it is written", "leave out --no-record")


def clock_settings(clock: str | None, speed: float | None) -> list[str]:
    """--clock and --speed, which only real time has, as settings of the scenario. Raises InputError."""
    if speed is not None and clock == "lockstep":
        raise InputError("--speed", "lock-step is as fast as it can be", "--clock realtime with it")
    if speed is not None:
        return ['clock.mode="realtime"', f"clock.speed={speed!r}"]
    return [] if clock is None else [f'clock.mode="{clock}"']


def _fresh_folder(bundle: Bundle) -> Path:
    """runs/<scenario>-<seed>-<time>: a run never overwrites another. Raises InputError."""
    stem = f"{bundle.scenario.name}-{bundle.scenario.seed}-{time.strftime('%Y%m%d-%H%M%S')}"
    folder = Path("runs") / stem
    number = 1
    with explained(folder, "give --out FOLDER, one that can be written"):
        while True:
            try:
                folder.mkdir(parents=True)
                return folder
            except FileExistsError:
                number += 1
                folder = Path("runs") / f"{stem}-{number}"


def _energy(log: Path) -> list[dict[str, Any]]:
    """What each robot has spent, driving and in its card [J], from the first tick to the last."""
    from onehop.analysis.log import open_log

    spent = open_log(log).table("energy")
    robots = sorted(set(spent["robot"].tolist()))
    kinds = ("drive_j", "radio_j")
    of = {robot: spent.of(robot) for robot in robots}
    return [
        {"robot": robot, **{kind: round(float(of[robot][kind].sum()), 1) for kind in kinds}}
        for robot in robots
    ]


def _draw(log: Path) -> Path:
    """Draw the mission's figure; returns its file."""
    from onehop.analysis.trajectory import draw_trajectory
    from onehop.wire.log_reader import LogFile

    figure = log.with_name(FIGURE)
    with explained(log.parent, REMEDY):
        draw_trajectory(LogFile(log), figure)
    return figure


def _add_view(log: Path) -> None:
    """Put the viewer layer into a sound log."""
    from onehop.analysis.log import open_log
    from onehop.analysis.view.layer import write_view

    with explained(log.parent, REMEDY):
        if not (opened := open_log(log)).torn:
            write_view(opened, log)


def _print(summary: dict[str, Any], folder: Path) -> None:
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
    punctuality = punctuality_of(summary)
    if punctuality is not None:
        console.print(f"real time   {punctuality.in_words()}")
    console.print(f"collisions  {summary['collisions']}")
    if "energy" in summary:
        driving, cards = (
            sum(entry[kind] for entry in summary["energy"]) / 1000.0 for kind in ("drive_j", "radio_j")
        )
        console.print(f"energy      {driving:.1f} kJ for driving, {cards:.1f} kJ for the radio cards")
    console.print(f"digest      {summary['digest'] or 'none: the recorder did not finish'}")
    console.print(f"log         {summary['log'] or 'none'}")
    console.print(f"summary     {summary_file(folder)}")
    if summary["outcome"] == "aborted":
        say(f"onehop run: aborted: {summary['reason']}")
