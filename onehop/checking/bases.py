"""`motion` and `own-voice` of robots with a real base: they are where that measured them to be.

Pose and twist of the truth are those of the newest measurement in the log, and what such a robot is told
that its laser sees is nowhere farther than that measured: simulated robots can only stand before it.
"""

import numpy as np

from onehop.checking.findings import Findings
from onehop.checking.invariants import MOTION, OWN_VOICE
from onehop.checking.snapshot import Snapshot
from onehop.contracts import topics
from onehop.contracts.arrays import Ranges
from onehop.contracts.hardware import Measured
from onehop.contracts.messages import Presence
from onehop.contracts.scenario import Scenario


class RealBases:
    """Holds truth and observations against what the bases measured."""

    def __init__(self, findings: Findings, scenario: Scenario) -> None:
        self._findings = findings
        self._range = {robot: scenario.body_of(robot).laser_range for robot in scenario.bases}
        self._newest: dict[int, Measured] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        if not now.follows:
            self._newest = {}  # what was measured in ticks that are missing is not known
        self._newest.update(now.measured)
        for robot in self._range:
            presence, measured = now.present.get(robot), self._newest.get(robot)
            if presence is None or (measured is None and now.tick > 0):
                continue
            self._findings.count(MOTION)
            if measured is None:
                what = (
                    f"robot {robot} has a real base, and the mission begins without a measurement of it"
                )
                said = now.exhibit(topics.base(robot), "no message")
                self._findings.report(MOTION, now.tick, (robot,), what, said)
            else:
                self._judge_place(now, presence, measured)
                self._judge_scan(now, robot, measured)

    def _judge_place(self, now: Snapshot, presence: Presence, measured: Measured) -> None:
        if (presence.pose, presence.twist) == (measured.pose, measured.twist):
            return
        robot, pose, said = presence.robot, presence.pose, measured.pose
        what = f"robot {robot} is not where its base has measured itself to be"
        self._findings.report(
            MOTION, now.tick, (robot,), what,
            now.exhibit(topics.TRUTH, f"at ({pose.x:.3f}, {pose.y:.3f}), {pose.heading:.3f} rad"),
            now.exhibit(
                topics.base(robot), f"at ({said.x:.3f}, {said.y:.3f}), {said.heading:.3f} rad at last"
            ),
        )  # fmt: skip

    def _judge_scan(self, now: Snapshot, robot: int, measured: Measured) -> None:
        seen = now.observations.get(robot)
        if seen is None or (now.truth is not None and robot in now.truth.blind):
            return
        if not _is_before(seen.scan, measured.scan, self._range[robot]):
            what = f"robot {robot} is told of more room than its base has measured"
            said = now.exhibit(topics.obs(robot), "a scan")
            measurement = now.exhibit(topics.base(robot), "a shorter one")
            self._findings.report(OWN_VOICE, now.tick, (robot,), what, said, measurement)


def _is_before(seen: Ranges, measured: Ranges, laser_range: float) -> bool:
    """Whether a scan is nowhere farther than what was measured, as far as the laser sees."""
    if seen.shape != measured.shape:
        return False
    return bool(np.all(seen <= np.where(measured <= laser_range, measured, np.float32(np.inf))))
