"""Where a kidnapped robot may be put down, and where it is when somebody else is there already."""

import math
from collections.abc import Iterable

import numpy as np

from onehop.contracts import elementary
from onehop.contracts.arrays import FloatArray
from onehop.contracts.fault_section import FaultSection
from onehop.maps.walls import WallMap
from world_server.core.placement import require_free

_GAP = 0.05
"""Gap between the bodies of a robot that is put down and the next one [m]."""

_RINGS, _DIRECTIONS = 200, 16
"""Places that are tried around a target: rings, one robot's radius apart, and points of each."""


def require_free_targets(faults: Iterable[FaultSection], walls: WallMap, inflation: float) -> None:
    """Raise ScenarioError for a kidnap to where no robot can be."""
    for number, fault in enumerate(faults):
        if fault.kind == "kidnap":
            where = f"faults[{number}].x, faults[{number}].y"
            require_free(walls, where, fault.x, fault.y, inflation)


def landing(
    fault: FaultSection, walls: WallMap, inflation: float, radius: float, bodies: FloatArray,
    radii: FloatArray,
) -> tuple[float, float, float]:  # fmt: skip
    """Pose of a kidnapped robot: the one asked for, or the next place where it touches nobody [m, rad].

    radius: of its body. bodies, radii: (n, 2) places and (n,) radii of the others [m].
    """
    apart = radius + radii
    heading = math.pi - (math.pi - math.radians(fault.heading_deg)) % math.tau
    for ring in range(_RINGS):
        for number in range(_DIRECTIONS if ring else 1):
            angle = math.tau * number / _DIRECTIONS
            x = fault.x + radius * ring * elementary.cos(angle)
            y = fault.y + radius * ring * elementary.sin(angle)
            gaps = elementary.lengths(bodies[:, 0] - x, bodies[:, 1] - y) - apart
            if np.all(gaps >= _GAP) and walls.is_free(x, y, inflation):
                return x, y, heading
    return fault.x, fault.y, heading
