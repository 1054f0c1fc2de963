"""Which faults that are ordered by hand can be carried out, and what is wrong with the others."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from onehop.contracts.errors import ScenarioError
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import Truth
from onehop.contracts.ranges import out_of_range
from onehop.maps.walls import WallMap
from world_server.core.placement import require_free

OF_PRESENT = frozenset(("kill", "stop", "continue", "hold", "blind", "slow"))
"""Kinds that need robots which take part."""


@dataclass(frozen=True, slots=True)
class Judge:
    """What orders are held against.

    robots: ids of the team. clearance: what a kidnap's target needs [m]. bases: robots with a real one.
    """

    robots: tuple[int, ...]
    walls: WallMap
    clearance: float
    bases: frozenset[int] = frozenset()

    def refusal(self, fault: FaultSection, truth: Truth) -> str | None:
        """Why a fault cannot be carried out, given who takes part now; None if it can."""
        for problem in (*out_of_range(fault), *replace(fault, at_s=0.0).problems()):
            return f"{problem.key}: {problem.what}; {problem.remedy}"
        strangers = sorted({*fault.robots, *fault.others}.difference(self.robots))
        if strangers:
            team = ", ".join(map(str, self.robots))
            return f"robots: robot {strangers[0]} is not in the team; ids of the team: {team}"
        present = [one.robot for one in truth.present]
        for robot in fault.robots:
            if fault.kind in OF_PRESENT and robot not in present:
                return f"robots: robot {robot} does not take part any more; {_those(present)}"
            if fault.kind == "continue" and robot not in truth.stopped:
                return f"robots: robot {robot} is not stopped; {_those(truth.stopped)}"
            if fault.kind == "kidnap" and robot in self.bases:
                simulated = _those(one for one in self.robots if one not in self.bases)
                what = f"robot {robot} has a real base, which nobody can put elsewhere"
                return f"robots: {what}; {simulated}"
        return self._refused_place(fault) if fault.kind == "kidnap" else None

    def _refused_place(self, fault: FaultSection) -> str | None:
        try:
            require_free(self.walls, "x, y", fault.x, fault.y, self.clearance)
        except ScenarioError as error:
            return str(error)
        return None


def _those(robots: Iterable[int]) -> str:
    """Whom an order could name instead."""
    return "one of " + (", ".join(map(str, robots)) or "nobody")
