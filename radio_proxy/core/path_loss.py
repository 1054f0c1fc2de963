"""What a signal loses between two places on the mean, and the interface for other models of it.

The built-in model, "log-distance": path loss by distance, walls on the straight way, and the shadowing
of the two places (thesis 3.7.1; docs/links.md).
"""

import math
from collections.abc import Callable, Sequence
from typing import Protocol

from onehop.contracts import elementary
from onehop.contracts.briefings import RadioBriefing
from radio_proxy.core.link_budget import LinkBudget, link_budget
from radio_proxy.core.shadowing import Shadowing, shadowing

SILENT_DB = -200.0
"""SNR of what cannot be received at all: cut off, absent, or out of reach [dB]."""

OWN_DB = 200.0
"""A station's own emission drowns everything else in its receiver [dB]."""

Wall = tuple[float, float, float, float]
Place = tuple[float, float]


class PropagationModel(Protocol):
    """Mean SNR between the stations of a mission, which are its robots by rising id.

    It is pure: the same places give the same rows. Jams and cuts, the draw for each frame, fast fading
    and links that were measured come on top of it.
    """

    def place(self, places: Sequence[Place | None]) -> None:
        """Where the stations are from now on [m]; None: absent."""
        ...

    def row_db(self, sender: int) -> list[float]:
        """Mean SNR at every station of what a present one emits [dB]; SILENT_DB: nothing. Its own value
        is not looked at."""
        ...


ModelMaker = Callable[[RadioBriefing], PropagationModel]
"""Makes a model of what the radio may know of a mission."""


def walls_crossed(walls: tuple[Wall, ...], x0: float, y0: float, x1: float, y1: float) -> int:
    """How many wall segments the straight path between two points crosses, whichever way it is taken."""
    if (x0, y0) > (x1, y1):
        x0, y0, x1, y1 = x1, y1, x0, y0
    count = 0
    for ax, ay, bx, by in walls:
        side_a = (x1 - x0) * (ay - y0) - (y1 - y0) * (ax - x0)
        side_b = (x1 - x0) * (by - y0) - (y1 - y0) * (bx - x0)
        if (side_a > 0.0) == (side_b > 0.0):
            continue
        side_0 = (bx - ax) * (y0 - ay) - (by - ay) * (x0 - ax)
        side_1 = (bx - ax) * (y1 - ay) - (by - ay) * (x1 - ax)
        count += (side_0 > 0.0) != (side_1 > 0.0)
    return count


class LogDistance:
    """The built-in model. field: shadowing of places, if there is any."""

    def __init__(
        self, budget: LinkBudget, walls: tuple[Wall, ...], field: Shadowing | None = None
    ) -> None:
        self._budget = budget
        self._reach = budget.reach
        self._walls = walls if budget.wall_loss_db else ()
        self._shadowing = field
        self._places: Sequence[Place | None] = ()
        self._cells: dict[tuple[int, int], list[tuple[int, float, float]]] = {}
        self._near: dict[tuple[int, int], list[tuple[int, float, float]]] = {}

    def place(self, places: Sequence[Place | None]) -> None:
        """Where the stations are from now on [m]; None: absent."""
        self._places, self._cells, self._near = places, {}, {}
        reach = self._reach
        for station, place in enumerate(places):
            if place is not None:
                x, y = place
                cell = math.floor(x / reach), math.floor(y / reach)
                self._cells.setdefault(cell, []).append((station, x, y))
        if self._shadowing is not None:
            self._shadowing.place([place or (0.0, 0.0) for place in places])

    def row_db(self, sender: int) -> list[float]:
        """The path loss of LinkBudget.mean_snr_db, by squared distances, for all in reach."""
        row = [SILENT_DB] * len(self._places)
        budget, reach = self._budget, self._reach
        nearest = budget.reference_distance * budget.reference_distance
        reference_db, slope_db = budget.snr_reference_db, 5.0 * budget.exponent
        here = self._places[sender]
        assert here is not None, "who is absent does not transmit"
        x, y = here
        shadows = self._shadowing.row_db(sender) if self._shadowing is not None else None
        for other, there_x, there_y in self._stations_near(x, y):
            east, north = there_x - x, there_y - y
            square = east * east + north * north
            if square <= nearest:
                row[other] = reference_db
            elif square <= reach * reach:
                row[other] = reference_db - slope_db * elementary.log10(square / nearest)
            else:
                continue
            if shadows is not None:
                row[other] += shadows[other]
            if self._walls:
                crossed = walls_crossed(self._walls, x, y, there_x, there_y)
                row[other] -= crossed * budget.wall_loss_db
        return row

    def _stations_near(self, x: float, y: float) -> list[tuple[int, float, float]]:
        """Stations and their places: all that are in reach of a place, and a few more."""
        column, line = cell = math.floor(x / self._reach), math.floor(y / self._reach)
        near = self._near.get(cell)
        if near is None:
            around = [(column + dx, line + dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1)]
            near = self._near[cell] = [one for each in around for one in self._cells.get(each, ())]
        return near


class HeldToRange:
    """A model that is not ours: what it says is held to what the radio can carry."""

    def __init__(self, model: PropagationModel) -> None:
        self._model = model
        self._places: Sequence[Place | None] = ()

    def place(self, places: Sequence[Place | None]) -> None:
        """Where the stations are from now on [m]."""
        self._places = places
        self._model.place(places)

    def row_db(self, sender: int) -> list[float]:
        """Its row; silent where nobody is, or for what is no number.

        Raises ValueError for a row of another length.
        """
        row = self._model.row_db(sender)
        if len(row) != len(self._places):
            raise ValueError(
                f"radio.propagation gave {len(row)} values for {len(self._places)} stations"
            )
        return [
            SILENT_DB if place is None or value != value else held(float(value))
            for value, place in zip(row, self._places, strict=True)
        ]


def held(snr_db: float) -> float:
    """An SNR between two robots as the radio can carry it: from silence to below its own emission."""
    return min(max(snr_db, SILENT_DB), OWN_DB - 1.0)


def log_distance(briefing: RadioBriefing) -> PropagationModel:
    """The built-in model of a mission."""
    budget = link_budget(briefing.radio)
    return LogDistance(budget, briefing.walls, shadowing(budget, briefing.seed))


BUILT_IN: dict[str, ModelMaker] = {"log-distance": log_distance}
