"""Contacts of robots with each other and with walls, each reported once: at its onset."""

import math

from onehop.contracts.arrays import FloatArray
from onehop.contracts.messages import Contact
from world_server.core.motion import NOBODY, WALL, Motion, Rows

_RELEASE_GAP = 0.02
"""Gap that ends a contact [m]: a robot that trembles at a wall has one contact with it."""

OBSTACLE = 0
"""Stands for an obstacle where Contact.other could be a robot id."""


class ContactDetector:
    """Who is in contact with whom. robots: ids in the order of the rows of poses."""

    def __init__(self, robots: tuple[int, ...], motion: Motion) -> None:
        self._robots = robots
        self._motion = motion
        self._radii: list[float] = motion.radii.tolist()
        self._in_contact: set[tuple[int, int]] = set()

    def onsets(self, poses: FloatArray, touched: Rows) -> tuple[Contact, ...]:
        """Contacts that began in the last period; touched is what Motion.advance returned."""
        self._in_contact = {pair for pair in self._in_contact if self._gap(poses, *pair) <= _RELEASE_GAP}
        onsets: list[Contact] = []
        for row, other in enumerate(touched.tolist()):
            if other == NOBODY:
                continue
            pair = (row, other) if other == WALL else (min(row, other), max(row, other))
            if pair in self._in_contact:
                continue
            self._in_contact.add(pair)
            onsets.append(self._contact(poses, row, other))
        return tuple(onsets)

    def _contact(self, poses: FloatArray, row: int, other: int) -> Contact:
        x, y = float(poses[row, 0]), float(poses[row, 1])
        if other == WALL:
            return Contact(robot=self._robots[row], other=OBSTACLE, x=x, y=y)
        x, y = 0.5 * (x + float(poses[other, 0])), 0.5 * (y + float(poses[other, 1]))
        return Contact(robot=self._robots[row], other=self._robots[other], x=x, y=y)

    def _gap(self, poses: FloatArray, one: int, other: int) -> float:
        x, y = float(poses[one, 0]), float(poses[one, 1])
        if other == WALL:
            return self._motion.wall_gap(one, x, y)
        apart = math.hypot(x - poses[other, 0], y - poses[other, 1])
        return apart - (self._radii[one] + self._radii[other])
