"""The gain policy `predictive`: everybody acts on what will be, not on what the last Next said.

Ours; the thesis's follower (3.5) drives to where its slot was at the last Next, and hurries when the
throughput has already fallen. A Next comes every T = 2 s, so the slot is 2 m stale when the next one is
due, and a follower with the law v = k_rho * rho lags by v_L / k_rho besides. Four parts:

1. Aim ahead: the slot moves on with the leader's velocity between its last two words.
2. Keep pace: k_rho is raised by v_L / (2 rho), so that v = k_rho * rho + v_L / 2, which halves the lag.
3. Hurry early: k_rho_max also when the throughput, falling on as it fell, would be too low next time,
   and while the team gathers, since everybody waits then.
4. The leader slows when a follower nears the frontier, where it would hear it too weakly.

docs/policies.md has what each is worth. Differs: the leader never waits in the thesis (3.8.2), and in a
delay of 20 s drives out of everybody's reach.
"""

import math
from collections.abc import Mapping

from onehop.contracts import elementary
from onehop.contracts.briefings import Briefing
from onehop.contracts.geometry import Pose
from onehop.contracts.units import NANOSECONDS
from robot_agent.core.motion.aim import Aim, Point, Report, Situation

LONGEST_FORECAST = 2.0
"""Next periods for which a leader that is silent is taken to drive on."""

NEAR_FRONTIER_DB = 4.0
"""The leader keeps its followers this far above the receive threshold: a standard deviation of the
thesis's fading [dB]."""

ASSUMED_EXPONENT = 2.0
"""Path loss exponent by which an SNR at one distance tells that at another (free space)."""

KEPT_PACE = 0.5
"""Share of the leader's speed that a follower keeps pace with. All of it leaves no lag, and drives past
the slot whenever the leader turns; docs/policies.md has what each costs."""

FILTER_SHARE = 0.25
"""Weight of the newest answer in what a leader thinks of a link: the draw of one frame is 4 dB."""

LEAST_PACE = 0.2
"""The leader never stands for its followers: one that cannot come would hold it for ever."""


class Forecast:
    """Where a leader is by now: it drives on as between its last two words."""

    def __init__(self, period_s: float) -> None:
        """period_s: of Next."""
        self._longest_s = LONGEST_FORECAST * period_s
        self._period_s = period_s
        self._last: tuple[Point, int] | None = None
        self.velocity: Point = (0.0, 0.0)

    def hear(self, leader: Pose, told_ns: int) -> None:
        """Its last word; the same one may be said at every tick."""
        here = (leader.x, leader.y)
        last = self._last
        if last is not None and told_ns == last[1]:
            return
        self._last = here, told_ns
        if last is None:
            return
        apart_s = (told_ns - last[1]) / NANOSECONDS
        if apart_s > self._longest_s:
            self.velocity = (0.0, 0.0)
        elif apart_s > 0.25 * self._period_s:
            ahead_x, ahead_y = elementary.cos(leader.heading), elementary.sin(leader.heading)
            came = (here[0] - last[0][0]) * ahead_x + (here[1] - last[0][1]) * ahead_y
            speed = max(0.0, came / apart_s)
            self.velocity = speed * ahead_x, speed * ahead_y

    def driven(self, now_ns: int) -> Point:
        """How far it has come since its last word [m]; nowhere, if that is too long ago."""
        if self._last is None:
            return 0.0, 0.0
        age_s = (now_ns - self._last[1]) / NANOSECONDS
        if age_s > self._longest_s:
            return 0.0, 0.0
        return self.velocity[0] * age_s, self.velocity[1] * age_s


class PredictiveGain:
    """Aims ahead, keeps pace, hurries early, and as leader minds the frontier."""

    def __init__(self, briefing: Briefing) -> None:
        self._gains = briefing.gains
        self._speed = briefing.body.leader_speed
        self._period_s = briefing.team.next_period
        self._forecast = Forecast(self._period_s)
        self._needed_db = briefing.radio.least_snr_db + NEAR_FRONTIER_DB
        self._before_bps = -1.0
        self._k_rho = briefing.gains.k_rho_min
        self._last: dict[int, Report] = {}
        self._links_db: dict[int, float] = {}

    def heard(self, throughput_bps: float, threshold_bps: float) -> float:
        """k_rho_max if the throughput is too low, or will be with the next Next."""
        before = self._before_bps if self._before_bps >= 0.0 else throughput_bps
        expected = throughput_bps + min(0.0, throughput_bps - before)
        self._before_bps = throughput_bps
        low = min(throughput_bps, expected) < threshold_bps
        self._k_rho = self._gains.k_rho_max if low else self._gains.k_rho_min
        return self._k_rho

    def aim(self, situation: Situation) -> Aim:
        """The slot where it will be, at a k_rho that keeps pace with it."""
        forecast, slot, pose = self._forecast, situation.slot, situation.pose
        forecast.hear(situation.leader, situation.told_ns)
        if not situation.driving:
            return Aim(slot, self._gains.k_rho_max)
        ahead_x, ahead_y = forecast.driven(situation.now_ns)
        slot = Pose(slot.x + ahead_x, slot.y + ahead_y, slot.heading)
        if ahead_x == 0.0 and ahead_y == 0.0:
            return Aim(slot, self._k_rho)
        to_slot = (slot.x - pose.x, slot.y - pose.y)
        rho = math.hypot(*to_slot)
        if rho == 0.0:
            return Aim(slot, self._k_rho)
        velocity = forecast.velocity
        receding = (velocity[0] * to_slot[0] + velocity[1] * to_slot[1]) / rho
        k_rho = self._k_rho + KEPT_PACE * max(0.0, receding) / rho
        return Aim(slot, min(self._gains.k_rho_max, k_rho))

    def pace(self, here: Point, reports: Mapping[int, Report]) -> float:
        """So slow that by the next Next nobody who answers directly is beyond the frontier."""
        share = 1.0
        for robot, report in reports.items():
            if report.hops == 1:
                left = self._frontier(robot, report) - math.dist(here, report.place)
                share = min(share, left / (self._speed * self._period_s))
        return max(share, LEAST_PACE)

    def _frontier(self, robot: int, report: Report) -> float:
        """Distance at which a follower would be heard as weakly as may be, by how it was heard [m]."""
        if report != self._last.get(robot):
            self._last[robot] = report
            apart = max(math.dist(report.told, report.place), 1.0)
            at_1_m = report.snr_db + 10.0 * ASSUMED_EXPONENT * elementary.log10(apart)
            known = self._links_db.get(robot, at_1_m)
            self._links_db[robot] = known + FILTER_SHARE * (at_1_m - known)
        margin_db = self._links_db[robot] - self._needed_db
        return elementary.power_of_ten(margin_db / (10.0 * ASSUMED_EXPONENT))
