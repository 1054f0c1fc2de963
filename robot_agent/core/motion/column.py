"""When a team drives in column: narrow passages and back (thesis mode Narrow, 3.3.1)."""

from onehop.contracts.sections import RobotSection, TeamSection
from robot_agent.core.team.formation import formation, width

WIDEST_PASSAGE = 9.0
"""Passages wider than this never make a column, whatever the shape [m]: almost the laser's range."""

NARROW_AFTER = 0.5
"""A passage is narrow once it was for this long [s]; one look past a corner is not enough."""

SMALLEST_SHAPE = 3
"""A team of fewer has no shape but a column."""

ROOM_BESIDE = 2.0
"""Room that the outermost robot of a shape needs beside its middle, in robot radii: its own hull, and as
much again."""


class ColumnWatch:
    """Decides for a leader, tick by tick, whether its team drives in column."""

    def __init__(self, body: RobotSection, team: TeamSection, period: float) -> None:
        """period: of a tick [s]."""
        self._body = body
        self._team = team
        self._period = period
        self.begin()

    def begin(self) -> None:
        """No passage was seen yet."""
        self._narrow_for = self._wide_for = 0.0

    def step(self, passage: float, members: tuple[int, ...], column: bool) -> bool:
        """Whether the members shall drive in column from this tick on.

        passage: width of the passage that the leader is in or before [m]; inf in the open. column:
        whether they do so far. Back to the shape only when the last of them is through.
        """
        if len(members) < SMALLEST_SHAPE:
            return False
        passable = 2.0 * self._body.radius < passage < WIDEST_PASSAGE
        if passable and passage < self._needed(members):
            self._wide_for = 0.0
            self._narrow_for += self._period
            return column or self._narrow_for >= NARROW_AFTER
        self._narrow_for = 0.0
        self._wide_for += self._period
        length = self._team.narrow_spacing * len(members)
        return column and self._wide_for * self._body.leader_speed <= length

    def _needed(self, members: tuple[int, ...]) -> float:
        """Free width that the shape of these robots needs [m]."""
        shape = formation(members, False, self._team.spacing)
        return width(shape) + 2.0 * ROOM_BESIDE * self._body.radius
