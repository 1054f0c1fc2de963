"""`own-voice` and `silence`: who said what, and that the dead say nothing.

A log shows of a message's origin: that its robot was there, as the same process, and that what the world
says of it is the same. What the bus itself refuses is not in the log (docs/limits.md).
"""

import math

from onehop.checking.effects import Effect, Effects
from onehop.checking.findings import Findings
from onehop.checking.invariants import OWN_VOICE, SILENCE
from onehop.checking.snapshot import Snapshot
from onehop.contracts import topics
from onehop.contracts.geometry import Pose
from onehop.contracts.messages import Presence, TransmitRequest, Truth
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import NOISE_SIGMAS, RobotSection

ROUNDING = 1e-9
"""What the sum of a place and its noise may be off by [m, rad]."""


class Voices:
    """Compares what a robot says with what the world says of it."""

    def __init__(self, findings: Findings, scenario: Scenario) -> None:
        self._findings = findings
        self._robots = scenario.team.robots
        self._bodies = dict(zip(self._robots, scenario.bodies, strict=True))
        self._effects = Effects(scenario.clock)
        self._before: dict[int, Effect] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        before, self._before = self._before, self._effects.take(now)
        if now.truth is None:
            return
        for presence in now.running():
            self._judge_own(now, presence.robot, presence)
        self._judge_absent(now)
        if now.follows or now.tick == 0:
            self._judge_requests(now, now.truth, before)

    def _judge_own(self, now: Snapshot, robot: int, presence: Presence) -> None:
        self._findings.count(OWN_VOICE)
        seen, action = now.observations.get(robot), now.actions.get(robot)
        if action is not None and action.incarnation != presence.incarnation:
            what = (
                f"robot {robot} is incarnation {presence.incarnation}, "
                f"and incarnation {action.incarnation} speaks in its name"
            )
            said = now.exhibit(topics.out(robot), f"incarnation {action.incarnation}")
            self._findings.report(OWN_VOICE, now.tick, (robot,), what, said)
        if seen is not None and not (
            (seen.incarnation, seen.twist) == (presence.incarnation, presence.twist)
            and _can_be_told(seen.pose, presence.pose, self._bodies[robot])
        ):
            x, y = seen.pose.x, seen.pose.y
            what = f"the observation of robot {robot} is not of where and what it is"
            self._findings.report(
                OWN_VOICE, now.tick, (robot,), what,
                now.exhibit(topics.obs(robot), f"incarnation {seen.incarnation} at ({x:.3f}, {y:.3f})"),
                now.exhibit(
                    topics.TRUTH,
                    f"incarnation {presence.incarnation} at "
                    f"({presence.pose.x:.3f}, {presence.pose.y:.3f})",
                ),
            )  # fmt: skip

    def _judge_absent(self, now: Snapshot) -> None:
        running = {presence.robot for presence in now.running()}
        absent = [robot for robot in self._robots if robot not in running]
        self._findings.count(SILENCE, len(absent))
        for robot in absent:
            for key, messages in (
                (topics.out(robot), now.actions),
                (topics.obs(robot), now.observations),
                (topics.rx(robot), now.inboxes),
            ):
                if robot in messages:
                    does = "speaks" if messages is now.actions else "is told something"
                    state = "stopped" if robot in now.stopped else "not in the mission"
                    what = f"robot {robot} is {state} and {does}"
                    self._findings.report(
                        SILENCE, now.tick, (robot,), what, now.exhibit(key, "a message")
                    )

    def _judge_requests(self, now: Snapshot, truth: Truth, before: dict[int, Effect]) -> None:
        """What the world hands to the radio is what the robots handed to it in the last tick."""
        requests = {request.robot: request for request in truth.transmit_requests}
        for robot, request in requests.items():
            if robot not in now.present:
                what = f"robot {robot} is not in the mission and hands messages to the radio"
                said = now.exhibit(topics.TRUTH, f"{len(request.outbox)} messages of robot {robot}")
                self._findings.report(SILENCE, now.tick, (robot,), what, said)
        for robot, presence in now.present.items():
            done, handed = before.get(robot), requests.get(robot)
            if done is not None and done.incarnation != presence.incarnation:
                done = None
            if not _same(done, handed):
                what = f"what the world hands to the radio for robot {robot} is not what it said"
                told = "nothing" if handed is None else _in_words(handed)
                spoken = "nothing" if done is None else _in_words(done)
                self._findings.report(
                    OWN_VOICE, now.tick, (robot,), what,
                    now.exhibit(topics.TRUTH, told),
                    now.exhibit(topics.out(robot), f"in the tick before: {spoken}"),
                )  # fmt: skip


def _same(done: Effect | None, request: TransmitRequest | None) -> bool:
    if done is None or request is None:
        return request is None and done is None
    return (
        done.outbox == request.outbox
        and done.speed == request.speed
        and done.remaining_distance == request.remaining_distance
    )


def _in_words(said: Effect | TransmitRequest) -> str:
    return f"{len(said.outbox)} messages, speed {said.speed:.3f}, {said.remaining_distance:.3f} m to go"


def _can_be_told(told: Pose, true: Pose, body: RobotSection) -> bool:
    """Whether a robot's sensors can make this of where it is: within the bounds of their noise."""
    turned = math.remainder(told.heading - true.heading, math.tau)
    place, heading = body.pose_noise, math.radians(body.heading_noise_deg)
    return all(
        abs(off) <= (NOISE_SIGMAS * noise + ROUNDING if noise else 0.0)
        for off, noise in ((told.x - true.x, place), (told.y - true.y, place), (turned, heading))
    )
