"""`motion` and `no-collision`: where bodies are from tick to tick, and what they touch (thesis eq. 3.3).

Walls are those of a polygon map, read from the scenario; those of a map file are left to the contacts
that the world logs, and to bodies that overlap. A real base moves as reality lets it (bases.py), and
what it touches of walls and of other real ones nobody here can know.
"""

import math
from typing import Any

import numpy as np

from onehop.checking.effects import Effect, Effects
from onehop.checking.findings import Findings
from onehop.checking.invariants import MOTION, NO_COLLISION
from onehop.checking.snapshot import Snapshot
from onehop.contracts import topics
from onehop.contracts.arrays import FloatArray
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Presence, Truth
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import MapSection

ROUNDING = 1e-6
"""What sums of floating-point numbers may be off by [m, rad]."""


class Motion:
    """No body moves farther than its command and its motors allow; nor while it is held or nobody's."""

    def __init__(self, findings: Findings, scenario: Scenario) -> None:
        self._findings = findings
        self._period = scenario.clock.period_ns / 1e9
        self._bodies = dict(zip(scenario.team.robots, scenario.bodies, strict=True))
        self._simulated = frozenset(scenario.team.robots).difference(scenario.bases)
        self._effects = Effects(scenario.clock)
        self._poses: dict[int, Pose] = {}
        self._driven: dict[int, tuple[float, float]] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        if now.truth is None or not now.follows:
            self._poses, self._driven = {}, {}
        if now.truth is None:
            return
        effects = self._effects.take(now)
        for robot in kidnapped(now.truth):
            self._poses.pop(robot, None)
        for robot, presence in now.present.items():
            if robot not in self._simulated:
                continue
            before = self._poses.get(robot)
            if before is not None:
                self._findings.count(MOTION)
                self._judge(now, presence, before, self._driven.get(robot, (0.0, 0.0)))
            self._poses[robot] = presence.pose
            self._driven[robot] = self._drive(effects.get(robot), presence)

    def _drive(self, effect: Effect | None, presence: Presence) -> tuple[float, float]:
        """How far a robot can come in a period [m], and turn [rad]: as commanded, within its motors.

        Who leaves after it has said so still drives that period; then its body stands.
        """
        if effect is None or presence.held or effect.incarnation != presence.incarnation:
            return 0.0, 0.0
        body = self._bodies[presence.robot]
        v = min(abs(effect.twist.v), body.max_speed)
        w = min(abs(effect.twist.w), body.max_turn_rate)
        return v * self._period, w * self._period

    def _judge(
        self, now: Snapshot, presence: Presence, before: Pose, driven: tuple[float, float]
    ) -> None:
        pose, robot = presence.pose, presence.robot
        moved = math.hypot(pose.x - before.x, pose.y - before.y)
        turned = abs(math.remainder(pose.heading - before.heading, math.tau))
        far, turn = driven
        wrong = None
        if not moved <= far + ROUNDING:
            wrong = f"robot {robot} moved {moved:.4f} m in a tick in which it could move {far:.4f} m"
        elif not turned <= turn + ROUNDING:
            wrong = (
                f"robot {robot} turned {turned:.4f} rad in a tick in which it could turn {turn:.4f} rad"
            )
        if wrong is not None:
            was = f"({before.x:.3f}, {before.y:.3f}), {before.heading:.3f} rad"
            is_now = f"({pose.x:.3f}, {pose.y:.3f}), {pose.heading:.3f} rad"
            said = now.exhibit(topics.TRUTH, f"robot {robot} from {was} to {is_now}")
            self._findings.report(MOTION, now.tick, (robot,), wrong, said)


class Collisions:
    """No contact is logged, no two bodies overlap, and none lies over a wall of a polygon map.

    Who leaves drives for one more period before its body stands; where exactly, the log does not say.
    """

    def __init__(self, findings: Findings, scenario: Scenario) -> None:
        self._findings = findings
        bodies = dict(zip(scenario.team.robots, scenario.bodies, strict=True))
        period_s = scenario.clock.period_ns / 1e9
        self._radius = {robot: body.radius for robot, body in bodies.items()}
        self._last_drive = {
            robot: 0.0 if robot in scenario.bases else body.max_speed * period_s
            for robot, body in bodies.items()
        }
        self._real = frozenset(scenario.bases)
        self._walls = wall_segments(scenario.map)
        self._bodies: dict[int, tuple[float, float]] = {}
        self._contacts = 0
        self._tick = 0

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        if now.truth is None:
            return
        self._tick = now.tick
        self._findings.count(NO_COLLISION, len(now.present))
        self._judge_contacts(now, now.truth)
        for robot in kidnapped(now.truth):
            self._bodies.pop(robot, None)
        for robot, presence in now.present.items():  # who has left stays where it was
            self._bodies[robot] = presence.pose.x, presence.pose.y
        for robot, measured in now.measured.items():  # but a real one, which is carried or rolls on
            self._bodies[robot] = measured.pose.x, measured.pose.y
        self._judge_bodies(now)

    def _judge_contacts(self, now: Snapshot, truth: Truth) -> None:
        self._contacts += len(truth.contacts)
        for contact in truth.contacts:
            other = f"robot {contact.other}" if contact.other else "an obstacle"
            what = f"robot {contact.robot} touches {other} at ({contact.x:.2f}, {contact.y:.2f})"
            robots = (contact.robot, contact.other) if contact.other else (contact.robot,)
            said = now.exhibit(topics.TRUTH, "a contact")
            self._findings.report(NO_COLLISION, now.tick, robots, what, said)

    def _judge_bodies(self, now: Snapshot) -> None:
        if not self._bodies:
            return
        robots = list(self._bodies)
        drives = np.array([0.0 if robot in now.present else self._last_drive[robot] for robot in robots])
        radii = np.array([self._radius[robot] for robot in robots])
        places = np.array(list(self._bodies.values()))
        apart = places[:, None, :] - places[None, :, :]
        gaps = np.hypot(apart[..., 0], apart[..., 1]) - (radii[:, None] + radii[None, :])
        doubt = ROUNDING + drives[:, None] + drives[None, :]
        real = np.array([robot in self._real for robot in robots])
        gaps[real[:, None] & real[None, :]] = math.inf
        for a, b in np.argwhere(np.triu(gaps < -doubt, k=1)).tolist():
            pair = robots[a], robots[b]
            self._report_overlap(now, pair, f"the bodies of robots {pair[0]} and {pair[1]} overlap")
        if len(self._walls):
            near = distances_to(self._walls, places).min(axis=1) < radii - ROUNDING - drives
            for a in np.flatnonzero(near & ~real).tolist():
                self._report_overlap(now, (robots[a],), f"the body of robot {robots[a]} is in a wall")

    def _report_overlap(self, now: Snapshot, robots: tuple[int, ...], what: str) -> None:
        evidence = [
            now.exhibit(topics.TRUTH, f"robot {robot} at ({x:.3f}, {y:.3f})")
            for robot, (x, y) in ((robot, self._bodies[robot]) for robot in robots)
        ]
        self._findings.report_state(NO_COLLISION, now.tick, robots, what, *evidence)

    def finish(self, summary: dict[str, Any] | None, is_whole: bool) -> None:
        """No tick follows. The last period's contacts are in no truth; the outcome counts them."""
        if summary is not None and is_whole and summary["collisions"] != self._contacts:
            what = f"the outcome counts {summary['collisions']} contacts, the log {self._contacts}"
            self._findings.report(NO_COLLISION, self._tick, (), what)


def kidnapped(truth: Truth) -> list[int]:
    """Robots whose bodies somebody puts elsewhere at this tick."""
    return [robot for fault in truth.faults if fault.kind == "kidnap" for robot in fault.robots]


def wall_segments(section: MapSection) -> FloatArray:
    """The walls of a polygon map as segments x0, y0, x1, y1, (n, 4) [m]; none of a map file."""
    if section.file:
        return np.empty((0, 4))
    w, h = section.width, section.height
    frame = ((0.0, 0.0), (w, 0.0), (w, h), (0.0, h))
    return np.array(
        [
            (*a, *b)
            for polygon in (frame, *section.obstacles)
            for a, b in zip(polygon, (*polygon[1:], polygon[0]), strict=True)
        ]
    )


def distances_to(segments: FloatArray, points: FloatArray) -> FloatArray:
    """Distance of each of p points from each of n segments, (p, n) [m]."""
    start, along = segments[:, :2], segments[:, 2:] - segments[:, :2]
    length2 = np.maximum((along * along).sum(axis=1), 1e-300)
    off = points[:, None, :] - start[None, :, :]
    share = np.clip((off * along).sum(axis=2) / length2, 0.0, 1.0)
    rest = off - share[..., None] * along
    nearest: FloatArray = np.hypot(rest[..., 0], rest[..., 1])
    return nearest
