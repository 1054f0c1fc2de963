"""A base that is none, for base_driver.py: a differential drive with physics and a laser of its own.

Nothing of it is the world's: wheels follow their command with a lag and slip, each its own; the walls
are read from the scenario's polygons, and the laser casts its rays by itself. It does not know what else
drives there, as a real base would not know of simulated robots.
"""

import math
import time
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

STEP_S = 0.005
"""Length of a step of its physics [s]."""

LAG_S = 0.15
"""Time constant with which a wheel follows its command [s]."""

TRACK = 0.3
"""Distance between its wheels [m]."""

GRIP = (0.97, 0.98)
"""What becomes of the speed of the left and the right wheel on the ground."""

PLACE_NOISE, RANGE_NOISE = 0.004, 0.01
"""Standard deviations of its localisation and of its laser [m]."""


class FakeBase:
    """body: of the briefing. scenario: a file whose map has polygons. start: "X,Y,HEADING_DEG"."""

    def __init__(self, body: dict[str, Any], scenario: str, start: str) -> None:
        self._body = body
        self._walls = walls_of(tomllib.loads(Path(scenario).read_text())["map"])
        x, y, degrees = map(float, start.split(","))
        self._x, self._y, self._heading = x, y, math.radians(degrees)
        self._wheels = [0.0, 0.0]
        self._commanded = [0.0, 0.0]
        half_view = math.radians(body["laser_fov_deg"]) / 2.0
        self._angles = np.linspace(-half_view, half_view, body["laser_beams"])
        self._random = np.random.default_rng()
        self._now_s = time.monotonic()

    def drive(self, v: float, w: float) -> None:
        self._go_on()
        self._commanded = [v - 0.5 * TRACK * w, v + 0.5 * TRACK * w]

    def read(self) -> tuple[tuple[float, float, float], tuple[float, float], Sequence[float]]:
        self._go_on()
        off_x, off_y = (PLACE_NOISE * self._random.standard_normal(2)).tolist()
        return (self._x + off_x, self._y + off_y, self._heading), self._twist(), self._ranges()

    def _twist(self) -> tuple[float, float]:
        left, right = (speed * grip for speed, grip in zip(self._wheels, GRIP, strict=True))
        return 0.5 * (left + right), (right - left) / TRACK

    def _go_on(self) -> None:
        """Let the time pass that has passed."""
        share = -math.expm1(-STEP_S / LAG_S)
        while self._now_s + STEP_S <= time.monotonic():
            self._now_s += STEP_S
            for side, commanded in enumerate(self._commanded):
                self._wheels[side] += share * (commanded - self._wheels[side])
            v, w = self._twist()
            self._heading += w * STEP_S
            x = self._x + v * STEP_S * math.cos(self._heading)
            y = self._y + v * STEP_S * math.sin(self._heading)
            if self._clearance(x, y) >= self._body["radius"]:  # else its wheels spin
                self._x, self._y = x, y

    def _clearance(self, x: float, y: float) -> float:
        start, along = self._walls[:, :2] - (x, y), self._walls[:, 2:] - self._walls[:, :2]
        share = np.clip(-(start * along).sum(1) / (along * along).sum(1), 0.0, 1.0)
        return float(np.hypot(*(start + share[:, None] * along).T).min())

    def _ranges(self) -> Sequence[float]:
        """Where each ray meets its first wall: start + s along = t ray, solved for t and s at once."""
        rays = self._heading + self._angles[:, None]
        rx, ry = np.cos(rays), np.sin(rays)
        ax, ay = self._walls[:, 0] - self._x, self._walls[:, 1] - self._y
        ex, ey = self._walls[:, 2] - self._walls[:, 0], self._walls[:, 3] - self._walls[:, 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = rx * ey - ry * ex
            reach, share = (ax * ey - ay * ex) / turn, (ax * ry - ay * rx) / turn
        hits = (reach >= 0.0) & (share >= 0.0) & (share <= 1.0)
        ranges = np.where(hits, reach, math.inf).min(1)
        ranges = np.maximum(0.0, ranges + RANGE_NOISE * self._random.standard_normal(len(ranges)))
        found: list[float] = np.where(ranges <= self._body["laser_range"], ranges, math.inf).tolist()
        return found


def walls_of(section: dict[str, Any]) -> np.ndarray:
    """Segments x0, y0, x1, y1 of a polygon map and of the wall around it, (n, 4) [m]."""
    w, h = section["width"], section["height"]
    frame = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)]
    return np.array(
        [
            (*a, *b)
            for polygon in (frame, *section.get("obstacles", []))
            for a, b in zip(polygon, (*polygon[1:], polygon[0]), strict=True)
        ],
        dtype=np.float64,
    )
