"""The faults of a scenario in time: which begin with a tick, and which are in force (docs/inputs.md).

A fault begins with the first tick at or after its time. A lasting one ends after its duration, or by a
heal; whatever has lasted its time ends before the new ones begin.
"""

from dataclasses import dataclass

from onehop.contracts.sections import FaultSection
from onehop.contracts.units import nanoseconds

LASTING = frozenset(("hold", "cut", "jam"))
"""Kinds that are in force for a while; the others happen at once."""


@dataclass(frozen=True, slots=True)
class _InForce:
    fault: FaultSection
    end_ns: int | None


class Script:
    """A scenario's faults. in_force: those that last, in the order in which they began."""

    def __init__(self, faults: tuple[FaultSection, ...]) -> None:
        self._waiting = sorted(faults, key=lambda fault: fault.at_s)
        self._lasting: list[_InForce] = []

    @property
    def in_force(self) -> list[FaultSection]:
        return [one.fault for one in self._lasting]

    def advance(self, time_ns: int) -> list[FaultSection]:
        """Go on to a tick: the faults that begin with it."""
        self._lasting = [one for one in self._lasting if one.end_ns is None or one.end_ns > time_ns]
        begun: list[FaultSection] = []
        while self._waiting and nanoseconds(self._waiting[0].at_s) <= time_ns:
            begun.append(self._waiting.pop(0))
            self._begin(begun[-1])
        return begun

    def _begin(self, fault: FaultSection) -> None:
        if fault.kind == "heal":
            named = set(fault.robots)
            self._lasting = [
                one
                for one in self._lasting
                if named and named.isdisjoint({*one.fault.robots, *one.fault.others})
            ]
        elif fault.kind in LASTING:
            end_ns = nanoseconds(fault.at_s) + nanoseconds(fault.duration_s)
            self._lasting.append(_InForce(fault, end_ns if fault.duration_s else None))
