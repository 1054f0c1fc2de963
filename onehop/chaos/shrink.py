"""Makes a failing mission small: takes things away while the same property fails, until nothing can go.

Greedy, in passes: the mission ends where the property failed; faults go, first many at a time (delta
debugging); then robots; then obstacles; then every value that differs from its default; then the faults
that are left become shorter, rounder and of fewer robots. A pass that took something away is followed by
another one.
"""

import dataclasses
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from onehop.chaos.properties import ARRIVAL, CRASH, HANG, SAME_BYTES
from onehop.chaos.trial import Failure, Trial, tried
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.radio_section import RadioSection
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import (
    ClockSection,
    GainsSection,
    MapSection,
    PlannerSection,
    RobotSection,
    TeamSection,
)
from onehop.scenario.bundle import Bundle

Try = Callable[[Bundle, str], Trial]

MOST_RUNS = 400
"""Missions run to shrink one failure, at most."""


@dataclass(frozen=True, slots=True)
class Shrunk:
    """The smallest mission found in which a property fails. runs: missions that it took.

    is_smallest: nothing more can be taken away; else the runs were used up.
    """

    bundle: Bundle
    failure: Failure
    runs: int
    is_smallest: bool


class _SpentError(Exception):
    """There are no runs left."""


class _Search:
    """The smallest failing mission so far, and the runs that are left."""

    def __init__(self, bundle: Bundle, failure: Failure, most_runs: int, try_it: Try) -> None:
        self.bundle = bundle
        self.failure = failure
        self.runs = 0
        self._most_runs = most_runs
        self._try = try_it

    @property
    def scenario(self) -> Scenario:
        return self.bundle.scenario

    def fails(self, candidate: Scenario) -> bool:
        """Whether the same property fails in a candidate, which then is the smallest so far."""
        if candidate == self.scenario or next(candidate.problems(), None) is not None:
            return False
        if self.runs == self._most_runs:
            raise _SpentError
        self.runs += 1
        files = self.bundle.files if candidate.map.file else {}
        bundle = replace(self.bundle, scenario=candidate, files=files)
        for failure in self._try(bundle, self.failure.property).failures:
            if _cause(failure) == _cause(self.failure):
                self.bundle, self.failure = bundle, failure
                return True
        return False


def _cause(failure: Failure) -> tuple[str, str]:
    """The property; of a crash also the place in the program."""
    return failure.property, failure.what.partition(": ")[0] if failure.property == CRASH else ""


def shrink(bundle: Bundle, failure: Failure, most_runs: int = MOST_RUNS, try_it: Try = tried) -> Shrunk:
    """Make a mission small in which a property fails. try_it: runs and judges a candidate.

    One that hangs, or whose bytes differ only when it is repeated, is left as it is.
    """
    if failure.property in (HANG, SAME_BYTES):
        return Shrunk(bundle, failure, 0, is_smallest=False)
    search = _Search(bundle, failure, most_runs, try_it)
    try:
        while sum(step(search) for step in _STEPS):  # every step, whatever the others took
            pass
    except _SpentError:
        return Shrunk(search.bundle, search.failure, search.runs, is_smallest=False)
    return Shrunk(search.bundle, search.failure, search.runs, is_smallest=True)


def _end_earlier(search: _Search) -> bool:
    """At the tick after the failure; a mission that does not arrive has to be given its time."""
    if search.failure.property == ARRIVAL or search.failure.tick < 0:
        return False
    clock = search.scenario.clock
    limit_s = math.ceil((search.failure.tick + 1) * clock.period_ms / 100.0) / 10.0
    if limit_s >= clock.limit_s:
        return False
    return search.fails(replace(search.scenario, clock=replace(clock, limit_s=limit_s)))


def _fewer(
    search: _Search,
    things: Callable[[], tuple[Any, ...]],
    without: Callable[[tuple[Any, ...]], Scenario],
) -> bool:
    """Take away things, first all, then halves, and so on down to each alone."""
    took_any = False
    size = len(things())
    while size:
        first = 0
        while first < len(things()):
            now = things()
            if search.fails(without(now[:first] + now[first + size :])):
                took_any = True
            else:
                first += size
        size = min(size // 2, len(things()))
    return took_any


def _fewer_faults(search: _Search) -> bool:
    return _fewer(
        search,
        lambda: search.scenario.faults,
        lambda faults: replace(search.scenario, faults=faults),
    )


def _fewer_robots(search: _Search) -> bool:
    return _fewer(
        search,
        lambda: search.scenario.team.robots,
        lambda robots: _of_robots(search.scenario, robots),
    )


def _of_robots(scenario: Scenario, robots: tuple[int, ...]) -> Scenario:
    """The mission of these robots alone; of nobody it is left as it is."""
    if not robots:
        return scenario
    ids = () if robots == tuple(range(1, len(robots) + 1)) else robots
    team = replace(scenario.team, size=len(robots), ids=ids)
    faults = tuple(filter(None, (_fault_of(fault, robots) for fault in scenario.faults)))
    own = tuple(one for one in scenario.robots if one.id in robots)
    return replace(scenario, team=team, robots=own, faults=faults)


def _fault_of(fault: FaultSection, robots: tuple[int, ...]) -> FaultSection | None:
    """A fault that names no other robots; None if it named only others."""
    kept = tuple(robot for robot in fault.robots if robot in robots)
    others = tuple(robot for robot in fault.others if robot in robots)
    if (fault.robots and not kept) or (fault.others and not others):
        return None
    return replace(fault, robots=kept, others=others)


def _simpler_map(search: _Search) -> bool:
    """Without a file, and with fewer obstacles."""
    own = search.scenario.map
    if own.file:
        far = max(search.scenario.start.x, search.scenario.goal.x)
        high = max(search.scenario.start.y, search.scenario.goal.y)
        plain = MapSection(width=math.ceil(far) + 10.0, height=math.ceil(high) + 10.0)
        return search.fails(replace(search.scenario, map=plain))
    return _fewer(
        search,
        lambda: search.scenario.map.obstacles,
        lambda obstacles: replace(
            search.scenario, map=replace(search.scenario.map, obstacles=obstacles)
        ),
    )


_DEFAULTS: dict[str, Any] = {
    "radio": RadioSection(),
    "gains": GainsSection(),
    "team": TeamSection(),
    "robot": RobotSection(),
    "planner": PlannerSection(),
    "clock": ClockSection(),
}
_KEPT = ("size", "ids", "profile", "program", "limit_s")
"""Keys that other steps shrink, or that say what is promised at all, or who is to keep it."""


def _usual_values(search: _Search) -> bool:
    """Values that the file need not say: of a whole section, else one by one."""
    took_any = False
    for name, default in _DEFAULTS.items():
        own = getattr(search.scenario, name)
        kept = {key: getattr(own, key) for key in _KEPT if hasattr(own, key)}
        if search.fails(replace(search.scenario, **{name: replace(default, **kept)})):
            took_any = True
            continue
        for one in dataclasses.fields(default):
            own, usual = getattr(search.scenario, name), getattr(default, one.name)
            if one.name not in _KEPT and getattr(own, one.name) != usual:
                usually = replace(own, **{one.name: usual})
                took_any |= search.fails(replace(search.scenario, **{name: usually}))
    return took_any


def _plainer_faults(search: _Search) -> bool:
    took_any = False
    for place in range(len(search.scenario.faults)):
        for change in _PLAINER:
            for plainer in change(search.scenario.faults[place]):
                faults = list(search.scenario.faults)
                faults[place] = plainer
                if search.fails(replace(search.scenario, faults=tuple(faults))):
                    took_any = True
                    break
    return took_any


def _of_fewer(fault: FaultSection) -> Iterator[FaultSection]:
    if len(fault.robots) > 1:
        yield from (replace(fault, robots=(robot,)) for robot in fault.robots)
    if len(fault.others) > 1:
        yield from (replace(fault, others=(robot,)) for robot in fault.others)


def _shorter(fault: FaultSection) -> Iterator[FaultSection]:
    yield from _rounder(fault, "duration_s", least=0.1)


def _earlier(fault: FaultSection) -> Iterator[FaultSection]:
    yield from _rounder(fault, "at_s" if fault.at_s is not None else "after_s", least=0.0)


def _less_late(fault: FaultSection) -> Iterator[FaultSection]:
    for delay in (1, fault.delay_ticks // 2):
        if 0 < delay < fault.delay_ticks:
            yield replace(fault, delay_ticks=delay)


def _with(section: Any, key: str, value: Any) -> Any:
    return replace(section, **{key: value})


def _rounder(fault: FaultSection, key: str, least: float) -> Iterator[FaultSection]:
    """Values that are smaller or have fewer digits, the smallest first."""
    value = getattr(fault, key)
    for other in (
        float(math.floor(value / 2.0)),
        float(math.floor(value)),
        math.floor(value * 10.0) / 10.0,
    ):
        if least <= other < value:
            yield _with(fault, key, other)


_PLAINER = (_of_fewer, _shorter, _earlier, _less_late)

_STEPS: tuple[Callable[[_Search], bool], ...] = (
    _end_earlier,
    _fewer_faults,
    _fewer_robots,
    _simpler_map,
    _usual_values,
    _plainer_faults,
)
