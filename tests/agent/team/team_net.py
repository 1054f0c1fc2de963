"""A team of real robots on an adversarial network, without a world: what the protocol tests drive.

Robots stand in the open and go where they want. The network delivers after `delay` ticks unless the
link is cut; a test may drop, duplicate, hold back or reorder what is under way, and kill, restart or
pause robots. Everything is deterministic.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from onehop.contracts.arrays import Ranges
from onehop.contracts.briefings import Briefing, robot_briefing
from onehop.contracts.geometry import Pose, Twist, wrap_angle
from onehop.contracts.messages import BROADCAST, Action, Note, Percept, Reception
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import ClockSection, GoalSection, MapSection, TeamSection
from onehop.contracts.serial_numbers import newer
from onehop.contracts.team import Mode, Status
from robot_agent.core.planning import Guidance, Pathfinder, PlannerStatus
from robot_agent.core.robot import Robot
from robot_agent.core.team.formation import formation, median_leader

PERIOD_MS = 250
NOTHING_NEAR = np.full(181, np.inf, np.float32)
SERVICE_NS = 8_214_000


class Straight:
    """Drives straight to the goal: the trivial way-finding of a world without obstacles."""

    def __init__(self, briefing: Briefing, pose: Pose, rng: np.random.Generator) -> None:
        del pose, rng
        self._goal, self._speed = briefing.goal, briefing.body.leader_speed

    def step(self, pose: Pose, scan: Ranges) -> Guidance:
        del scan
        dx, dy = self._goal.x - pose.x, self._goal.y - pose.y
        remaining = math.hypot(dx, dy)
        bearing = wrap_angle(math.atan2(dy, dx) - pose.heading)
        arrived = remaining <= self._goal.tolerance
        twist = Twist(0.0 if arrived or abs(bearing) > 0.3 else self._speed, 2.0 * bearing)
        progress = PlannerStatus.ARRIVED if arrived else PlannerStatus.DRIVING
        return Guidance(twist, progress, remaining, math.inf, (self._goal.x, self._goal.y), ())


def straight(briefing: Briefing, pose: Pose, rng: np.random.Generator) -> Pathfinder:
    """Pathfinder maker of these tests."""
    return Straight(briefing, pose, rng)


@dataclass
class Frame:
    """One message under way."""

    due: int
    sent: int
    number: int
    source: int
    destination: int
    payload: bytes
    msdu_bytes: int

    def received(self, now_ns: int) -> Reception:
        """What its receiver gets: one hop, no retry."""
        service_ns = (self.sent + 1) * PERIOD_MS * 1_000_000 - SERVICE_NS
        return Reception(self.source, self.payload, service_ns, now_ns, 1, 1, 45.0, 0.0, self.msdu_bytes)


@dataclass
class Member:
    """One incarnation of a robot and where it stands."""

    robot: Robot
    pose: Pose
    incarnation: int
    status: Status | None = None
    epochs: list[int] = field(default_factory=list)


class TeamNet:
    """N robots, a clock, and frames under way."""

    def __init__(
        self, team: TeamSection, delay: int = 1, goal: tuple[float, float] = (500.0, 0.0)
    ) -> None:
        self.scenario = Scenario(
            name="net",
            goal=GoalSection(*goal),
            map=MapSection(width=1e3, height=1e3),
            team=team,
            clock=ClockSection(period_ms=PERIOD_MS),
        )
        self.tick = 0
        self.delay = delay
        self.ids = team.robots
        self.members = {
            i: self._member(i, Pose(4.0 * n, 3.0 * (n % 3), 0.0), 0) for n, i in enumerate(self.ids)
        }
        self.graveyard: dict[int, tuple[Pose, int]] = {}
        self.paused: dict[int, int] = {}
        self.frames: list[Frame] = []
        self.cuts: set[tuple[int, int]] = set()
        self.losing: set[tuple[int, int]] = set()
        self.notes: list[tuple[float, int, Note]] = []
        self._number = 0

    @property
    def seconds(self) -> float:
        """Time of the tick that comes next [s]."""
        return self.tick * PERIOD_MS / 1000.0

    def _member(self, robot: int, pose: Pose, incarnation: int) -> Member:
        briefing = robot_briefing(self.scenario, robot, incarnation)
        return Member(Robot(briefing, straight), pose, incarnation)

    def step(self) -> None:
        """One tick of everybody, in order of id."""
        arrived = sorted((f for f in self.frames if f.due <= self.tick), key=lambda f: (f.due, f.number))
        self.frames = [f for f in self.frames if f.due > self.tick]
        inboxes: dict[int, list[Reception]] = {i: [] for i in self.members}
        now_ns = self.tick * PERIOD_MS * 1_000_000
        for frame in arrived:
            if frame.destination in inboxes:
                reception = Reception(
                    frame.source,
                    frame.payload,
                    now_ns - SERVICE_NS,
                    now_ns,
                    1,
                    1,
                    45.0,
                    0.0,
                    frame.msdu_bytes,
                )
                inboxes[frame.destination].append(reception)
        for i in sorted(self.members):
            if self.paused.get(i, 0) > self.tick:
                continue
            member = self.members[i]
            percept = Percept(
                self.tick, now_ns, member.pose, Twist(0.0, 0.0), NOTHING_NEAR, tuple(inboxes[i])
            )
            self._take(i, member, member.robot.step(percept))
        self.tick += 1

    def _take(self, robot: int, member: Member, action: Action) -> None:
        v, w, dt = action.twist.v, action.twist.w, PERIOD_MS / 1000.0
        pose = member.pose
        heading = wrap_angle(pose.heading + w * dt)
        middle = pose.heading + 0.5 * w * dt
        member.pose = Pose(
            pose.x + v * dt * math.cos(middle), pose.y + v * dt * math.sin(middle), heading
        )
        member.status = action.status
        member.epochs.append(action.status.epoch)
        self.notes += [(self.seconds, robot, note) for note in action.notes]
        for message in action.outbox:
            receivers = self.members if message.destination == BROADCAST else (message.destination,)
            for receiver in sorted(receivers):
                link = (robot, receiver)
                if receiver != robot and link not in self.cuts and link not in self.losing:
                    self._post(robot, receiver, message.payload, message.msdu_bytes, self.delay)

    def _post(self, source: int, receiver: int, payload: bytes, size: int, delay: int) -> None:
        self._number += 1
        self.frames.append(
            Frame(self.tick + delay, self.tick, self._number, source, receiver, payload, size)
        )

    def run(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(round(seconds * 1000.0 / PERIOD_MS)):
            self.step()

    def kill(self, robot: int) -> None:
        """The robot is gone with all that it knew."""
        member = self.members.pop(robot)
        self.graveyard[robot] = (member.pose, member.incarnation)

    def restart(self, robot: int) -> None:
        """A killed robot starts again where it stood, knowing nothing."""
        pose, incarnation = self.graveyard.pop(robot)
        self.members[robot] = self._member(robot, pose, incarnation + 1)

    def cut(self, side: tuple[int, ...]) -> None:
        """Nothing passes any more between a side and the rest."""
        for a in side:
            for b in self.ids:
                if b not in side:
                    self.cuts |= {(a, b), (b, a)}

    def heal(self) -> None:
        """All links carry again."""
        self.cuts.clear()
        self.losing.clear()

    def repeat(self, frame: Frame, ticks: int) -> None:
        """A frame under way arrives once more, `ticks` later."""
        delay = frame.due - self.tick + ticks
        self._post(frame.source, frame.destination, frame.payload, frame.msdu_bytes, delay)

    def inject(self, source: int, receiver: int, payload: bytes) -> None:
        """A payload that no robot sent."""
        self._post(source, receiver, payload, 800, 0)

    # what the tests look at

    def status(self, robot: int) -> Status:
        """Last status of a robot."""
        status = self.members[robot].status
        assert status is not None
        return status

    def leaders(self) -> tuple[int, ...]:
        """Robots that act as leader, sorted."""
        return tuple(i for i in sorted(self.members) if self.status(i).leader == i)

    def agree(self) -> bool:
        """Whether all present robots obey one roster that is exactly them."""
        rosters = {(s.epoch, s.leader, s.members) for s in map(self.status, sorted(self.members))}
        return len(rosters) == 1 and next(iter(rosters))[2] == tuple(sorted(self.members))

    def describe(self) -> str:
        """Who thinks what, for a failed assertion."""
        rows = [(i, self.status(i)) for i in sorted(self.members)]
        return "; ".join(f"{i}: {s.mode.value} {s.epoch} {s.leader} {s.members}" for i, s in rows)

    def check(self) -> None:
        """Invariants of every tick: epochs, median, shape."""
        for i in sorted(self.members):
            member = self.members[i]
            status = member.status
            if status is None:
                continue
            assert len(member.epochs) < 2 or not newer(*member.epochs[-2:]), f"epoch of {i}"
            if status.mode is Mode.JOINING:
                assert status.leader != i
                continue
            assert status.leader == median_leader(status.members), f"leader of {i}"
            assert i in status.members
            shapes = {formation(status.members, narrow).shape for narrow in (False, True)}
            assert status.shape in shapes


def drive(team=None, seconds=20.0):
    """A team on its way."""
    net = TeamNet(team or TeamSection())
    net.run(seconds)
    return net


def thesis(**keys):
    """The team of the thesis's own rules."""
    return TeamSection(profile="thesis", leader_timeout=6.0, **keys)
