"""What leaders had planned, as the page draws it: points tried, edges between them, the way taken."""

from collections import OrderedDict
from typing import Any

import numpy as np

from onehop.analysis.log import Log
from onehop.contracts.arrays import FloatArray
from onehop.drivers.planning_moments import PlanningMoments, is_known

MOST_ROBOTS = 8
"""Robots whose planning is kept at hand; few lead, and another one's is only executed again."""


class RoadMaps:
    """Of one log; they cost what the robot's program has cost, once, and only if they are asked for."""

    def __init__(self) -> None:
        self._file = 0
        self._moments: OrderedDict[int, PlanningMoments] = OrderedDict()

    def of(self, file: int, log: Log, robot: int, tick: int) -> dict[str, Any]:
        """The last planning moment of a robot by a tick, all in [cm]; empty if there is none.

        file: which file of this name the log is; another one begins anew. Raises OnehopError.
        """
        if not is_known(log.scenario, robot):
            return {}
        if file != self._file:
            self._file = file
            self._moments.clear()
        moments = self._moments.setdefault(robot, PlanningMoments(log.scenario, robot))
        self._moments.move_to_end(robot)
        while len(self._moments) > MOST_ROBOTS:
            self._moments.popitem(last=False)
        found = moments.last(log.file, tick)
        if found is None:
            return {}
        at, planned = found
        return {
            "at": at,
            "points": _centimetres(planned.samples),
            "edges": _centimetres(planned.roadmap.edges),
            "way": _centimetres(planned.way),
        }


def _centimetres(places: FloatArray) -> list[list[int]]:
    rows: list[list[int]] = np.rint(100.0 * places).astype(int).tolist()
    return rows
