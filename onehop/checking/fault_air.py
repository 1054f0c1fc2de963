"""`fault-bit` on the air: a cut link carries nothing, a jam lowers SNR, a corruption alters payloads."""

import math
from collections.abc import Iterable
from itertools import pairwise

from onehop.checking.airtime import Airtimes
from onehop.checking.findings import Findings
from onehop.checking.invariants import FAULT_BIT
from onehop.checking.reach import Budget, measured
from onehop.checking.snapshot import ARRIVES, Snapshot
from onehop.contracts import topics
from onehop.contracts.link_trace import LinkTrace
from onehop.contracts.messages import BROADCAST, Cut, DeliveryStatus, Truth, Verdict
from onehop.contracts.scenario import Scenario

SIGMAS = 6.0
"""A fade above so many standard deviations is none: one draw in 10^9."""

MARGIN_DB = 1.0
"""What a robot that drives a tick nearer may gain [dB]."""

OVERHEAD_NS = 2_000_000
"""What routing headers may add to the airtime of a frame, at most [ns]."""


class FaultyAir:
    """Judges what arrives while the air is disturbed."""

    def __init__(self, findings: Findings, scenario: Scenario, trace: LinkTrace | None = None) -> None:
        self._findings = findings
        self._period_ns = scenario.clock.period_ns
        self._airtimes = Airtimes(scenario.radio)
        self._budget = Budget(scenario.radio)
        self._measured = measured(trace, scenario.radio, self._budget)
        self._before: Truth | None = None
        self._cut_since: dict[tuple[int, int], int] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        truth = now.truth
        if truth is None or not now.follows:
            self._before, self._cut_since = None, {}
        if truth is None:
            return
        start_ns = truth.time_ns - self._period_ns
        if now.record is not None and now.record.intake is not None:
            start_ns = now.record.intake.placed_ns
        self._cut_since = {
            pair: self._cut_since.get(pair, start_ns) for cut in truth.cuts for pair in _pairs(cut)
        }
        if now.record is not None and (truth.cuts or truth.jams or truth.corruptions):
            certain = {
                robot for one in truth.corruptions if one.probability >= 1.0 for robot in one.robots
            }
            for verdict in now.record.verdicts:
                if verdict.status in ARRIVES:
                    self._judge_carried(now, verdict)
                    self._judge_jammed(now, truth, verdict)
                    self._judge_corrupted(now, verdict, certain)
        self._before = truth

    def _judge_carried(self, now: Snapshot, verdict: Verdict) -> None:
        """No hop of what arrived went over a cut; of hops but the last the time is not known."""
        is_broadcast = verdict.destination == BROADCAST
        one_hop_ns = self._airtimes.message_ns(verdict.msdu_bytes, is_broadcast, 1)
        hops = list(pairwise(verdict.path))
        for number, hop in enumerate(hops, start=1):
            begin_ns = verdict.service_start_ns
            if number == len(hops):
                begin_ns = max(begin_ns, verdict.arrival_ns - one_hop_ns - OVERHEAD_NS)
            since_ns = self._cut_since.get(hop)
            if since_ns is not None and begin_ns >= since_ns:
                what = f"the cut from robot {hop[0]} to robot {hop[1]} carried a message"
                self._report(now, verdict, hop, what)

    def _judge_jammed(self, now: Snapshot, truth: Truth, verdict: Verdict) -> None:
        """What arrives in a jam has no SNR that the jam would not leave it."""
        if self._before is None or not self._before.jams or len(verdict.path) < 2:
            return
        if not self._budget.is_known:
            return
        sender, receiver = verdict.path[-2:]
        here, there = now.present.get(receiver), now.present.get(sender)
        if here is None or there is None:
            return
        x, y = here.pose.x, here.pose.y
        rise_db = min(self._budget.jam_rise_db(one, x, y) for one in (truth, self._before))
        distance = math.hypot(x - there.pose.x, y - there.pose.y)
        fade_db = SIGMAS * self._budget.shadowing_db + self._budget.best_db + MARGIN_DB
        mean_db = self._budget.mean_snr_at(distance)
        if self._measured is not None:
            times = (truth.time_ns, self._before.time_ns)
            mean_db = max(self._measured.mean_db(sender, receiver, time, mean_db) for time in times)
        most_db = mean_db - rise_db + fade_db
        if rise_db > 0.0 and verdict.snr_db > most_db:
            what = (
                f"robot {receiver} is jammed and receives robot {sender} at {verdict.snr_db:.1f} dB; "
                f"{distance:.1f} m away and with {rise_db:.1f} dB more noise {most_db:.1f} dB are most"
            )
            self._report(now, verdict, (sender, receiver), what)

    def _judge_corrupted(self, now: Snapshot, verdict: Verdict, certain: set[int]) -> None:
        """Where every payload is altered none arrives as it was."""
        robot = verdict.receiver
        if verdict.status is DeliveryStatus.DELIVERED and robot in certain and verdict.msdu_bytes:
            what = f"all that robot {robot} receives is altered, and this is not"
            self._report(now, verdict, (robot,), what)

    def _report(self, now: Snapshot, verdict: Verdict, robots: tuple[int, ...], what: str) -> None:
        says = (
            f"message {verdict.message} of robot {verdict.source} to robot {verdict.receiver} by "
            f"{' '.join(map(str, verdict.path))}: {verdict.status.value}"
        )
        said = now.exhibit(topics.RADIO_RECORD, says)
        self._findings.report(FAULT_BIT, now.tick, robots, what, said)


def _pairs(cut: Cut) -> Iterable[tuple[int, int]]:
    """Sender and receiver of every link that a cut breaks."""
    for a in cut.side_a:
        for b in cut.side_b:
            yield a, b
            if not cut.one_way:
                yield b, a
