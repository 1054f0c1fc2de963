"""Robots with a real base: pose, twist and scan as it measures them, in place of motion and laser.

The world moves none of them. Each stands where its newest measurement says, and everybody else meets it
there as a disc. Its own laser sees the real room, and the simulated robots are laid over that. What is
real about it only reality decides: it has no contact with a wall, nor with another real robot, and the
noise of its sensors is its own. With a simulated robot it collides where their discs overlap.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from onehop.contracts.arrays import FloatArray
from onehop.contracts.errors import ScenarioError
from onehop.contracts.geometry import STANDSTILL, Twist
from onehop.contracts.hardware import Measured, wrong_measurement
from onehop.contracts.scenario import Scenario
from onehop.maps.walls import WallMap
from world_server.core.laser import Laser, Scans
from world_server.core.motion import NOBODY, Rows
from world_server.core.placement import require_free

BEYOND = 1.0
"""How far beyond the map's bounds a base may take itself to be [m]: what localisation may be off by."""


class Bases:
    """The real bases of a team. Without any, nothing here does anything.

    Rows are those of poses, (n, 3) [m, m, rad], and of twists, (n, 2) [m/s, rad/s], by robot id.
    """

    def __init__(self, scenario: Scenario, walls: WallMap) -> None:
        robots, bodies = scenario.team.robots, scenario.bodies
        self._rows = {robot: row for row, robot in enumerate(robots) if robot in scenario.bases}
        self._simulated = [row for row, robot in enumerate(robots) if robot not in scenario.bases]
        self._radii = np.array([body.radius for body in bodies])
        self._bodies = {robot: bodies[row] for robot, row in self._rows.items()}
        nothing = replace(walls, segments=np.empty((0, 4)))
        self._lasers = {robot: Laser(nothing, body) for robot, body in self._bodies.items()}
        self._walls, self._inflation = walls, scenario.planner.inflation
        self._robots = robots
        self._newest: dict[int, Measured] = {}
        self._commands = dict.fromkeys(self._rows, STANDSTILL)

    def __iter__(self) -> Iterator[int]:
        return iter(self._rows)

    def __contains__(self, robot: int) -> bool:
        return robot in self._rows

    def __bool__(self) -> bool:
        return bool(self._rows)

    def refusal(self, robot: int, measured: Measured) -> str | None:
        """Why a measurement cannot be taken in, in a few plain words; None if it can."""
        wrong = wrong_measurement(measured, self._bodies[robot].laser_beams)
        xmin, ymin, xmax, ymax = self._walls.bounds
        x, y = measured.pose.x, measured.pose.y
        is_near = xmin - BEYOND <= x <= xmax + BEYOND and ymin - BEYOND <= y <= ymax + BEYOND
        if wrong is None and not is_near:
            extent = f"x from {xmin:.2f} to {xmax:.2f} and y from {ymin:.2f} to {ymax:.2f}"
            wrong = f"({x:.2f}, {y:.2f}) is outside of the map, {extent}"
        return wrong

    def no_start(self, poses: FloatArray) -> str | None:
        """Why the mission cannot start where its bases stand, in one line; None if it can."""
        for robot, row in self._rows.items():
            x, y = round(float(poses[row, 0]), 3), round(float(poses[row, 1]), 3)
            try:
                require_free(self._walls, f"robot {robot} cannot start", x, y, self._inflation)
            except ScenarioError as error:
                return str(error)
            gaps = self._gaps(row, poses)
            gaps[row] = np.inf
            other = int(gaps.argmin())
            if gaps[other] < 0.0:
                place = f"its base at ({x}, {y}) stands on robot {self._robots[other]}"
                return f"robot {robot} cannot start: {place}; put either elsewhere"
        return None

    def set_off(self, twists: FloatArray) -> None:
        """Take what the robots are to be driven by out of the world's own motion."""
        for robot, row in self._rows.items():
            self._commands[robot] = Twist(*twists[row].tolist())
            twists[row] = 0.0

    def rest(self, robot: int) -> None:
        """Forget what the last process of a robot commanded."""
        self._commands[robot] = STANDSTILL

    def command(self, robot: int) -> Twist:
        """By what a robot would have been moved in the last tick."""
        return self._commands[robot]

    def place(self, measured: Mapping[int, Measured], poses: FloatArray, twists: FloatArray) -> None:
        """Take in measurements, and put everyone where the newest one says."""
        self._newest.update(measured)
        for robot, row in self._rows.items():
            pose, twist = self._newest[robot].pose, self._newest[robot].twist
            poses[row] = pose.x, pose.y, pose.heading
            twists[row] = twist.v, twist.w

    def radii(self, poses: FloatArray) -> FloatArray:
        """Radii of all bodies as obstacles, (n,) [m].

        Where a real body has come over a simulated one it counts as smaller by as much: the simulated
        robot can come no nearer, and can drive away.
        """
        radii = self._radii.copy()
        for row in self._rows.values():
            nearest = self._gaps(row, poses)[self._simulated].min(initial=0.0)
            radii[row] = max(0.0, radii[row] + nearest)
        return radii

    def touch(self, poses: FloatArray, touched: Rows) -> None:
        """Note in `touched`, (n,), which real bodies have come over simulated ones."""
        for row in self._rows.values():
            gaps = self._gaps(row, poses)
            gaps[list(self._rows.values())] = np.inf
            other = int(gaps.argmin())
            touched[row] = other if gaps[other] < 0.0 else NOBODY

    def scan(self, robot: int, poses: FloatArray) -> Scans:
        """What a robot sees, (n_beams,) float32 [m]: as measured, and simulated robots before it."""
        row, laser_range = self._rows[robot], self._bodies[robot].laser_range
        rows = [row, *self._simulated]
        own = np.zeros(1, dtype=np.int32)
        (virtual,) = self._lasers[robot].scans(poses[rows], own, self._radii[rows])
        measured = self._newest[robot].scan
        seen: Scans = np.where(measured <= laser_range, measured, np.float32(np.inf))
        seen[:] = np.minimum(seen, virtual)
        return seen

    def _gaps(self, row: int, poses: FloatArray) -> FloatArray:
        """From the rim of one body to those of all, (n,) [m]."""
        off = poses[:, :2] - poses[row, :2]
        apart = np.sqrt(off[:, 0] * off[:, 0] + off[:, 1] * off[:, 1])
        gaps: FloatArray = apart - (self._radii + self._radii[row])
        return gaps
