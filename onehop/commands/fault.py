"""`onehop fault`: do something bad to a mission that runs, and say how to repeat it."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from onehop.commands.output import emit_json
from onehop.contracts.errors import InputError
from onehop.contracts.fault_section import (
    DIRECTIONS,
    KINDS,
    OWN_KEYS,
    FaultSection,
    fault_in_words,
    in_toml,
)
from onehop.contracts.ranges import out_of_range
from onehop.mission.injection import inject
from onehop.mission.rendezvous import the_one_that_runs, way_into

OPTIONS = {
    "robots": "ROBOTS",
    "others": "--others",
    "duration_s": "--for",
    "x": "--x",
    "y": "--y",
    "heading_deg": "--heading",
    "radius": "--radius",
    "noise_dbm": "--noise",
    "direction": "--direction",
    "probability": "--probability",
    "delay_ticks": "--delay",
}
"""What the command line calls the keys of a fault."""


def fault(kind: str, robots: str, others: str, mission: Path | None, given: dict[str, Any],
          as_json: bool) -> int:  # fmt: skip
    """Order a fault; returns the exit status. given: keys and values, None where there is none."""
    values = {key: value for key, value in given.items() if value is not None}
    ids = {"robots": _ids("ROBOTS", robots), "others": _ids("--others", others)}
    order = _checked(kind, {**ids, **values})
    folder = the_one_that_runs() if mission is None else mission
    answer = inject(way_into(folder), order)
    if answer.refusal:
        raise InputError(f"fault {kind}", *_parted(answer.refusal))
    begun = answer.fault
    if as_json:
        emit_json(
            {
                "kind": kind,
                "robots": list(begun.robots),
                "tick": answer.tick,
                "mission": str(folder),
                "at_s": begun.at_s,
                "scenario": f"faults = [{in_toml(begun)}]",
            }
        )
    else:
        print(f"{fault_in_words(begun)}: took effect at tick {answer.tick}, {begun.at_s:g} s")
        print(f"the same in a scenario: faults = [{in_toml(begun)}]")
    return 0


def _checked(kind: str, values: dict[str, Any]) -> FaultSection:
    """The fault that was asked for. Raises InputError."""
    if kind not in KINDS:
        raise InputError(f"fault {kind}", "no kind of fault", f"one of {', '.join(KINDS)}")
    for key, value in values.items():
        if key not in OWN_KEYS[kind] and value not in ((), None):
            takes = ", ".join(OPTIONS[own] for own in OWN_KEYS[kind])
            raise InputError(f"fault {kind}", f"takes no {OPTIONS[key]}", f"it takes {takes}")
    missing = [key for key in ("x", "y") if key in OWN_KEYS[kind] and key not in values]
    if missing:
        raise InputError(f"fault {kind}", f"{OPTIONS[missing[0]]} is missing", "where [m]")
    if values.get("direction", "both") not in DIRECTIONS:
        what = f"{values['direction']!r:.60} is unknown"
        raise InputError(f"fault {kind}: --direction", what, f"one of {', '.join(DIRECTIONS)}")
    order = FaultSection(kind, **values)
    for problem in (*out_of_range(order), *replace(order, at_s=0.0).problems()):
        option = OPTIONS.get(problem.key.partition("[")[0], problem.key)
        raise InputError(f"fault {kind}: {option}", problem.what, problem.remedy)
    return order


def _parted(refusal: str) -> tuple[str, str]:
    """What is wrong, and what would be right."""
    what, _, remedy = refusal.rpartition("; ")
    return (what, remedy) if what else (remedy, "start another one with onehop run")


def _ids(option: str, text: str) -> tuple[int, ...]:
    try:
        return tuple(int(word) for word in text.split(",")) if text else ()
    except ValueError:
        raise InputError(
            f"{option} {text}", "not ids of robots", "whole numbers, e.g. 3 or 1,4"
        ) from None
