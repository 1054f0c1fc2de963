"""Who leads a team, in which shape it drives, and where each robot's slot is (thesis 3.3).

Everything follows from the sorted list of ids: every robot that has the same list comes to the same
leader, shape and slots without a message (thesis Algorithm 1). Slots are in the leader's frame, x
forward, y to its left.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from onehop.contracts.team import Shape

SPACING = 4.0
"""Distance between neighbours [m]: keeps the slots of six robots within 8 m of the leader."""


@dataclass(frozen=True, slots=True)
class Slot:
    """Place of one follower in the leader's frame [m]."""

    robot: int
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class Formation:
    """Leader, shape, and the followers' slots sorted by robot id."""

    leader: int
    shape: Shape
    slots: tuple[Slot, ...]

    def slot(self, robot: int) -> Slot:
        """The slot of one follower; KeyError for a robot that has none."""
        for slot in self.slots:
            if slot.robot == robot:
                return slot
        raise KeyError(robot)


def median_leader(ids: Iterable[int]) -> int:
    """The id at the median index of the sorted team, for an even count the lower one.

    Thesis Algorithm 1, step 3: of 1..6 it is 3. ValueError for an empty team.
    """
    team = sorted(ids)
    if not team:
        raise ValueError("a team of nobody has no leader")
    return team[(len(team) - 1) // 2]


def shape_of(size: int, narrow: bool = False) -> Shape:
    """The shape that a team of this size drives in (thesis 3.3.1, 3.3.5; above six: thesis 3.8.1)."""
    if size == 1:
        return Shape.SOLO
    if size == 2 or narrow:
        return Shape.COLUMN
    if size % 2:
        return Shape.WEDGE
    return Shape.DIAMOND if size == 4 else Shape.HEXAGON


@lru_cache(maxsize=256)
def _formation(team: tuple[int, ...], narrow: bool, spacing: float) -> Formation:
    leader = median_leader(team)
    shape = shape_of(len(team), narrow)
    right = [i for i in reversed(team) if i < leader]
    left = [i for i in team if i > leader]
    if shape is Shape.COLUMN:
        slots = _column(right, left, spacing)
    elif shape is Shape.WEDGE:
        slots = _wedge(right, left, spacing)
    else:
        slots = _closed(right, left, spacing, shape)
    return Formation(leader, shape, tuple(sorted(slots, key=lambda slot: slot.robot)))


def formation(ids: Iterable[int], narrow: bool = False, spacing: float = SPACING) -> Formation:
    """Leader, shape and slots of a team of any size.

    narrow: the column of a narrow passage. spacing: distance between neighbours [m].
    ValueError for an empty team or an id that stands twice.
    """
    team = tuple(sorted(ids))
    if len(frozenset(team)) != len(team):
        raise ValueError("an id stands twice in the team")
    return _formation(team, narrow, spacing)


def _column(right: list[int], left: list[int], spacing: float) -> list[Slot]:
    """One behind the other, right and left ids in turn, the nearest id first."""
    order = []
    for j in range(max(len(right), len(left))):
        order += right[j : j + 1] + left[j : j + 1]
    return [Slot(robot, -j * spacing, 0.0) for j, robot in enumerate(order, start=1)]


def _wedge(right: list[int], left: list[int], spacing: float) -> list[Slot]:
    """A V behind the leader, both arms at 45 degrees."""
    step = spacing / math.sqrt(2.0)
    arms = [Slot(robot, -j * step, -j * step) for j, robot in enumerate(right, start=1)]
    return arms + [Slot(robot, -j * step, j * step) for j, robot in enumerate(left, start=1)]


def _closed(right: list[int], left: list[int], spacing: float, shape: Shape) -> list[Slot]:
    """Two sides of the same length; the one extra id of the left side closes the rear."""
    if not left:
        return []
    *side, last = left
    if shape is Shape.DIAMOND:
        half = spacing / math.sqrt(2.0)
        slots = [Slot(robot, -half, -half) for robot in right]
        slots += [Slot(robot, -half, half) for robot in side]
        return [*slots, Slot(last, -2.0 * half, 0.0)]
    width = spacing * math.sqrt(3.0) / 2.0
    slots = [Slot(robot, -(j - 0.5) * spacing, -width) for j, robot in enumerate(right, start=1)]
    slots += [Slot(robot, -(j - 0.5) * spacing, width) for j, robot in enumerate(side, start=1)]
    return [*slots, Slot(last, -len(right) * spacing, 0.0)]


def width(team: Formation) -> float:
    """Lateral extent of a formation, leader included [m]."""
    sides = [slot.y for slot in team.slots]
    return max([0.0, *sides]) - min([0.0, *sides])
