"""`onehop replay`: re-execute a log, compare every output, name the first that differs."""

from pathlib import Path
from typing import Any

from onehop.commands.logs import check_moment, open_with_warning, warn_of_flaws
from onehop.commands.output import emit_json
from onehop.contracts.errors import InputError
from onehop.contracts.printable import json_value, printable
from onehop.drivers.replay import Divergence, Report
from onehop.drivers.replay import replay as re_execute
from onehop.scenario.bundle import changed


def replay(
    path: Path,
    robot: int | None,
    first_s: float | None,
    last_s: float | None,
    settings: list[str],
    as_json: bool,
) -> int:
    """Re-execute robots, radio and world of a log; returns the exit status."""
    _check_stretch(first_s, last_s)
    log = open_with_warning(path).file
    scenario = log.bundle.scenario
    if robot is not None and robot not in scenario.team.robots:
        raise InputError(
            f"--robot {robot}",
            "is not in the team",
            f"one of {', '.join(map(str, scenario.team.robots))}",
        )
    if robot in scenario.commands:
        what = "is a process of somebody else's making, and has no core to run here"
        raise InputError(f"--robot {robot}", what, "another robot")
    if settings and robot is None:
        raise InputError("--set", "asks what one robot would have done", "name it with --robot")
    period = scenario.clock.period_ms / 1000.0
    report = re_execute(
        log,
        robots=None if robot is None else (robot,),
        parts=robot is None,
        first_tick=0 if first_s is None else round(first_s / period),
        last_tick=None if last_s is None else round(last_s / period),
        scenario=changed(scenario, settings) if settings else None,
    )
    if as_json:
        emit_json(_as_json(report))
    else:
        _print(report, period, bool(settings))
    warn_of_flaws(path, report.flaws)
    return 0 if report.same else 1


def _check_stretch(first_s: float | None, last_s: float | None) -> None:
    """Raises InputError for a stretch of time in which nothing can lie."""
    if first_s is not None:
        check_moment("--from", first_s)
    if last_s is not None:
        check_moment("--to", last_s)
        if first_s is not None and last_s < first_s:
            raise InputError(
                f"--from {first_s:g} --to {last_s:g}", "ends before it begins", "--from before --to"
            )


def _as_json(report: Report) -> dict[str, Any]:
    first = report.first
    return {
        "ticks": report.ticks,
        "robots": list(report.robots),
        "foreign": list(report.foreign),
        "bases": list(report.bases),
        "compared": report.compared,
        "divergences": report.divergences,
        "first": None
        if first is None
        else {
            "tick": first.tick,
            "robot": first.robot,
            "channel": first.channel,
            "field": first.field,
            "recorded": json_value(first.recorded),
            "replayed": json_value(first.replayed),
        },
        "per_channel": report.per_channel,
        "flaws": report.flaws,
    }


def _print(report: Report, period: float, what_if: bool) -> None:
    print(f"{report.ticks} ticks, {_names(report.robots)}: {report.compared} messages compared")
    if report.foreign:
        print(f"no core to run here for {_names(report.foreign)}: what they said is taken from the log")
    if report.bases:
        print(f"real base of {_names(report.bases)}: what it measured is taken from the log")
    if report.first is not None:
        print(f"{report.divergences} divergences{' under the changed setting' if what_if else ''}")
        print(f"first: {_sentence(report.first, period)}")
    elif not report.compared:
        print("nothing was compared: the log has no message of what was asked for")
    elif report.flaws:
        print("0 divergences in what was compared; it is not all that was said in the mission")
    else:
        print("0 divergences: every message is the same, byte for byte")


def _names(robots: tuple[int, ...]) -> str:
    return (
        f"robot{'s' if len(robots) > 1 else ''} {', '.join(map(str, robots))}" if robots else "no robot"
    )


def _sentence(first: Divergence, period: float) -> str:
    who = f"robot {first.robot}" if first.robot else first.channel
    where = f"tick {first.tick} ({first.tick * period:.2f} s), {who}, {first.channel}"
    if not first.field:
        return f"{where}: fails on what is recorded, {printable(str(first.replayed))}"
    return (
        f"{where}, field {printable(first.field)}: recorded {json_value(first.recorded)!r:.80}, "
        f"replayed {json_value(first.replayed)!r:.80}"
    )
