"""Planners, gain policies, routing, propagation and programs by the names that packages give them.

A package offers each as an entry point of its group; ours are offered by this package in the same way
(pyproject.toml). Cores look nothing up: whoever makes one hands in, with its briefing, what the scenario
names. What each has to be, and how to offer one: docs/plugins.md.
"""

import difflib
import importlib
import inspect
import os
import traceback
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec.structs import asdict

from onehop.contracts.briefings import (
    Briefing,
    PluggedBriefing,
    PluggedRadioBriefing,
    RadioBriefing,
)
from onehop.contracts.errors import InputError, ScenarioError
from onehop.contracts.plugin_names import GAIN_POLICIES, PLANNERS, PROPAGATION, ROUTING
from onehop.contracts.printable import printable
from onehop.contracts.scenario import BUILT_IN, Scenario, plugins

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

PROGRAMS = "onehop.programs"


class Kind(NamedTuple):
    """What can be plugged in under a key of a scenario.

    key: of the scenario. takes: what it is called with. has: methods of what that gives.
    """

    key: str
    takes: tuple[str, ...]
    has: tuple[str, ...]


KINDS = {
    PLANNERS: Kind("planner.kind", ("briefing", "pose", "rng"), ("step",)),
    GAIN_POLICIES: Kind("gains.policy", ("briefing",), ("heard",)),
    ROUTING: Kind(
        "radio.routing", ("nic", "section", "now"),
        ("submit", "abandon", "on_packet", "on_heard", "on_overheard", "on_broadcast_sent",
         "on_acknowledged", "on_undeliverable"),
    ),
    PROPAGATION: Kind(
        "radio.propagation", ("briefing",), ("place", "row_db")
    ),
}  # fmt: skip
"""All but programs, which have a base class (onehop/programs/find.py)."""


def installed(group: str) -> "list[EntryPoint]":
    """What packages offer in a group, by name."""
    from importlib.metadata import entry_points  # 10 ms that the radio of most missions does not need

    return sorted(entry_points(group=group), key=lambda one: (one.name, one.value))


def value_of(group: str, name: str, where: str, remedy: str) -> str:
    """The "package.module:name" that a name stands for, if it is none itself. Raises InputError."""
    if ":" in name:
        return name
    offered = installed(group)
    found = sorted({one.value for one in offered if one.name == name})
    if len(found) == 1:
        return found[0]
    if found:
        raise InputError(where, f"{name!r} is offered by several packages", f"one of {', '.join(found)}")
    names = list(dict.fromkeys(one.name for one in offered))
    raise InputError(where, f"{name!r} is offered by no package", _instead(name, names, remedy))


def imported(name: str, value: str, where: str, remedy: str) -> Any:
    """The object at "package.module:name"; None if its module has none. Raises InputError."""
    module_name, _, attribute = value.partition(":")
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        raise InputError(where, f"{name!r}: {error}", remedy) from None
    except (Exception, SystemExit) as error:
        raise InputError(where, f"{name!r} cannot be imported: {_last_line(error)}", "mend it") from None
    return getattr(module, attribute, None)


def load(group: str, name: str, where: str) -> Any:
    """What a name of a group stands for, of the shape that it has to have. Raises InputError.

    where: what to call its key.
    """
    remedy = '"package.module:name", or a name that an installed package offers'
    found = imported(name, value_of(group, name, where, remedy), where, remedy)
    wrong = misshapen(KINDS[group], found)
    if wrong is not None:
        raise InputError(where, f"{name!r} {wrong}", f"one as docs/plugins.md says of {group}")
    return found


def misshapen(kind: Kind, found: Any) -> str | None:
    """What keeps an object from being a plugin of a kind; None if nothing that can be seen."""
    if not callable(found):
        return "is not there" if found is None else "is nothing that can be called"
    try:
        inspect.signature(found).bind(*kind.takes)
    except TypeError:
        return f"cannot be called with ({', '.join(kind.takes)})"
    except ValueError:  # of some callables that are not Python's nothing is known
        return None
    if isinstance(found, type):
        missing = [name for name in kind.has if not callable(getattr(found, name, None))]
        if missing:
            return f"has no method {missing[0]}"
    return None


def check_names(scenario: Scenario, origin: str) -> None:
    """See that names which a scenario gives are known here. Raises ScenarioError.

    Nothing is imported: "package.module:name" is looked for when a mission begins.
    """
    for group, name in scenario.plugins.items():
        names = list(dict.fromkeys([*BUILT_IN[group], *(one.name for one in installed(group))]))
        if ":" not in name and name not in names:
            remedy = _instead(name, names, "")
            raise ScenarioError(f"{origin}: {KINDS[group].key}", f"{name!r} is unknown", remedy)


def check(scenario: Scenario, origin: str) -> None:
    """See that all that a scenario names is there, and of the right shape. Raises InputError."""
    for group, name in scenario.plugins.items():
        load(group, name, f"{origin}: {KINDS[group].key}")


def plugged(briefing: Briefing) -> Briefing:
    """A robot's briefing with planner and gain policy that are not built in. Raises InputError."""
    found = _loaded({PLANNERS: briefing.planner.kind, GAIN_POLICIES: briefing.gains.policy})
    return PluggedBriefing(**asdict(briefing), plugins=found) if found else briefing


def plugged_radio(briefing: RadioBriefing) -> RadioBriefing:
    """The radio's, with routing and propagation that are not built in. Raises InputError."""
    radio = briefing.radio
    found = _loaded({ROUTING: radio.routing, PROPAGATION: radio.propagation})
    return PluggedRadioBriefing(**asdict(briefing), plugins=found) if found else briefing


def _loaded(names: dict[str, str]) -> dict[str, Any]:
    """What stands behind those of these names, by group, that are not built in. Raises InputError."""
    return {group: load(group, name, KINDS[group].key) for group, name in plugins(names).items()}


def _instead(name: str, names: Sequence[str], remedy: str) -> str:
    """What to say of a name that there is not."""
    near = difflib.get_close_matches(name, names, 1)
    if near:
        return f"did you mean {near[0]}?"
    known = ", ".join(map(repr, names)) or "none"
    return f"{remedy}, or one of {known}" if remedy else f"one of {known}"


def _last_line(error: BaseException) -> str:
    """What went wrong in a module, and in which line."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({os.path.basename(frames[-1].filename)}:{frames[-1].lineno})" if frames else ""
    return (
        printable("".join(traceback.format_exception_only(error)).strip().splitlines()[-1], 200) + place
    )
