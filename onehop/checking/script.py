"""The faults of a mission in time: which are due, and which are in force (docs/faults.md).

A fault of the scenario with a time begins with the first tick at or after it. A lasting one ends after
its duration, or by a heal; whatever has lasted its time ends before others begin.
"""

from dataclasses import dataclass, replace

from onehop.contracts.fault_section import FaultSection
from onehop.contracts.units import nanoseconds

OF_ONE_ROBOT = frozenset(("hold", "stop", "blind", "slow"))
"""Lasting kinds that each robot suffers by itself."""

OF_ONE_PROCESS = frozenset(("stop", "slow"))
"""Those of them that end with the process."""

LASTING = OF_ONE_ROBOT | {"cut", "corrupt", "jam"}
"""Kinds that are in force for a while; the others happen at once."""


def told(fault: FaultSection) -> FaultSection:
    """A fault but for when it is to begin: what scenario and truth say of it alike."""
    robots, others = tuple(sorted(set(fault.robots))), tuple(sorted(set(fault.others)))
    return replace(fault, robots=robots, others=others, at_s=0.0, on="", nth=1, after_s=0.0)


class Schedule:
    """The faults of a scenario that have a time of their own."""

    def __init__(self, faults: tuple[FaultSection, ...]) -> None:
        self._waiting = [fault for fault in faults if fault.at_s is not None]

    def due(self, time_ns: int) -> list[FaultSection]:
        """Those that begin now, each once."""
        due = [one for one in self._waiting if nanoseconds(one.at_s or 0.0) <= time_ns]
        self._waiting = [one for one in self._waiting if one not in due]
        return list(dict.fromkeys(map(told, due)))


@dataclass(frozen=True, slots=True)
class _InForce:
    fault: FaultSection
    end_ns: int | None


class ForceField:
    """The faults that are in force, in the order in which they began."""

    def __init__(self) -> None:
        self._lasting: list[_InForce] = []

    def of_kind(self, kind: str) -> list[FaultSection]:
        """Those of one kind."""
        return [one.fault for one in self._lasting if one.fault.kind == kind]

    def whom(self, kind: str) -> set[int]:
        """The robots that suffer from one kind."""
        return {robot for fault in self.of_kind(kind) for robot in fault.robots}

    def expire(self, time_ns: int) -> None:
        """What has lasted its time ends."""
        self._lasting = [one for one in self._lasting if one.end_ns is None or one.end_ns > time_ns]

    def begin(self, fault: FaultSection, time_ns: int) -> None:
        """A fault begins."""
        if fault.kind == "heal":
            self._heal(frozenset(fault.robots))
        elif fault.kind == "continue":
            self._release(frozenset(fault.robots), frozenset(("stop",)))
        elif fault.kind in LASTING:
            end_ns = time_ns + nanoseconds(fault.duration_s) if fault.duration_s else None
            self._lasting.append(_InForce(fault, end_ns))

    def on_end_of_process(self, robot: int) -> None:
        """What befell a process is over with it."""
        self._release(frozenset((robot,)), OF_ONE_PROCESS)

    def _heal(self, robots: frozenset[int]) -> None:
        """Everything ends, or what concerns these robots; a jam concerns nobody by name."""
        if not robots:
            self._lasting = []
            return
        self._release(robots, OF_ONE_ROBOT)
        self._lasting = [
            one
            for one in self._lasting
            if one.fault.kind in OF_ONE_ROBOT
            or robots.isdisjoint({*one.fault.robots, *one.fault.others})
        ]

    def _release(self, robots: frozenset[int], kinds: frozenset[str]) -> None:
        """These kinds let go of these robots."""
        still = []
        for one in self._lasting:
            if one.fault.kind not in kinds:
                still.append(one)
            elif left := tuple(robot for robot in one.fault.robots if robot not in robots):
                still.append(replace(one, fault=replace(one.fault, robots=left)))
        self._lasting = still
