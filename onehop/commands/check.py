"""`onehop check`: test the invariants of a mission by its log alone."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from onehop.checking import INVARIANTS, Report, judge
from onehop.checking.findings import Violation
from onehop.checking.invariants import COUNTED
from onehop.commands.logs import open_with_warning, warn_of_flaws
from onehop.commands.output import emit_json
from onehop.contracts.errors import InputError
from onehop.contracts.printable import ids_in_words, printable
from onehop.wire.log_reader import LogFile

_TOLD = 5
"""Violations of one invariant that people are told; --json has more."""


def check(path: Path, only: Sequence[str], as_json: bool) -> int:
    """Judge a log; exit status 1 if an invariant is broken."""
    for name in only:
        if name not in INVARIANTS:
            raise InputError(f"--only {name}", "is no invariant", f"one of {', '.join(INVARIANTS)}")
    log = open_with_warning(path).file
    report = judge(log, only)
    period_s = log.bundle.scenario.clock.period_ns / 1e9
    if as_json:
        emit_json(_as_json(report, period_s))
    else:
        _print(log, report, period_s)
    warn_of_flaws(path, log.flaws)
    return 0 if report.holds else 1


def _as_json(report: Report, period_s: float) -> dict[str, Any]:
    return {
        "violations": [
            {
                "invariant": one.invariant,
                "tick": one.tick,
                "at_s": round(one.tick * period_s, 9),
                "robots": list(one.robots),
                "what": one.what,
                "evidence": [exhibit._asdict() for exhibit in one.evidence],
            }
            for one in report.violations
        ],
        "checked": report.checked,
        "broken": report.broken,
        "unexercised": report.unexercised,
        "ticks": report.ticks,
    }


def _print(log: LogFile, report: Report, period_s: float) -> None:
    team = log.bundle.scenario.team
    length_s = report.ticks * period_s
    robots = f"{len(team.robots)} robot{'s' if len(team.robots) > 1 else ''}"
    print(f"{report.ticks} ticks ({length_s:.2f} s) of {robots}, profile {team.profile}")
    for name, times in report.checked.items():
        if name in report.unexercised:
            print(f"  {name:<16} {'not asked':<11} never exercised: {report.unexercised[name]}")
            continue
        broken = report.broken.get(name, 0)
        verdict = f"BROKEN {broken}x" if broken else "held"
        print(f"  {name:<16} {verdict:<11} {f'{times} {COUNTED[name]}':<30} {INVARIANTS[name]}")
    for name in report.broken:
        _print_violations(report, name, period_s)


def _print_violations(report: Report, name: str, period_s: float) -> None:
    mine = [one for one in report.violations if one.invariant == name]
    for one in mine[:_TOLD]:
        print(f"{name}: {_place(one, period_s)}: {printable(one.what)}")
        for exhibit in one.evidence:
            print(f"    tick {exhibit.tick} {exhibit.topic}: {printable(exhibit.says)}")
    if report.broken[name] > _TOLD:
        print(f"{name}: and {report.broken[name] - _TOLD} more")


def _place(violation: Violation, period_s: float) -> str:
    who = f", robots {ids_in_words(violation.robots, ', ')}" if violation.robots else ""
    return f"tick {violation.tick} ({violation.tick * period_s:.2f} s){who}"
