"""`fault-bit`: every fault of the scenario shows its effect, from the tick at which it begins.

A killed process is gone and says nothing more; a restarted robot is there as another process; a held one
is said to be held; a cut is in force and carries nothing; a jam is in force and lowers the SNR of what is
received in it. `heal`, and the end of a duration, end what they are to end.
"""

import math
from collections import Counter
from collections.abc import Iterable

from onehop.checking.airtime import Airtimes
from onehop.checking.findings import Findings
from onehop.checking.invariants import FAULT_BIT
from onehop.checking.reach import Budget
from onehop.checking.script import Script
from onehop.checking.snapshot import Snapshot
from onehop.contracts import topics
from onehop.contracts.messages import BROADCAST, Cut, DeliveryStatus, Jam, Presence, Truth, Verdict
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import FaultSection

_SIGMAS = 6.0
"""A fade above so many standard deviations is none: one draw in 10^9."""

_MARGIN_DB = 1.0
"""What a robot that drives a tick nearer may gain [dB]."""

_OVERHEAD_NS = 2_000_000
"""What routing headers may add to the airtime of a frame, at most [ns]."""


class FaultBit:
    """Holds the script of a scenario against what the log shows."""

    def __init__(self, findings: Findings, scenario: Scenario) -> None:
        self._findings = findings
        self._script = Script(scenario.faults)
        self._robots = scenario.team.robots
        self._period_ns = scenario.clock.period_ns
        self._airtimes = Airtimes(scenario.radio)
        self._budget = Budget(scenario.radio)
        self._before: dict[int, Presence] = {}
        self._killed: dict[int, int] = {}
        self._truth: Truth | None = None
        self._cut_since: dict[tuple[int, int], int] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        begun = self._script.advance(now.tick * self._period_ns)
        self._findings.count(FAULT_BIT, len(begun))
        truth = now.truth
        if truth is None or not now.follows:
            self._before, self._cut_since, self._truth = {}, {}, None
        if truth is None:
            return
        self._judge_processes(now, truth, begun)
        self._judge_held(now)
        self._judge_air(now, truth)
        if truth.cuts:
            self._track_cuts(truth)
        else:
            self._cut_since = {}
        if now.record is not None and (truth.cuts or truth.jams):
            for verdict in now.record.verdicts:
                if verdict.status is DeliveryStatus.DELIVERED:
                    self._judge_carried(now, verdict)
                    self._judge_jammed(now, truth, verdict)
        self._before, self._truth = now.present, truth

    # what happens to processes

    def _judge_processes(self, now: Snapshot, truth: Truth, begun: list[FaultSection]) -> None:
        last = {
            robot: fault.kind
            for fault in begun
            if fault.kind in ("kill", "restart")
            for robot in fault.robots
        }
        gone = {departure.robot for departure in truth.departures}
        for robot, kind in last.items():
            before, presence = self._before.get(robot), now.present.get(robot)
            if before is not None and robot not in gone:
                self._report_process(now, robot, f"the {kind} of robot {robot} ended no process")
            if kind == "kill" and before is not None:
                self._killed[robot] = before.incarnation
            elif kind == "restart" and not _is_newer_process(presence, before):
                self._report_process(now, robot, f"the restart of robot {robot} started no process")
        for robot, incarnation in self._killed.items():
            presence = now.present.get(robot)
            if presence is not None and presence.incarnation <= incarnation:
                self._report_process(now, robot, f"robot {robot} was killed and takes part")
            elif presence is None and robot in now.actions:
                self._report_process(now, robot, f"robot {robot} was killed and speaks")

    def _report_process(self, now: Snapshot, robot: int, what: str) -> None:
        presence = now.present.get(robot)
        says = "absent" if presence is None else f"present, incarnation {presence.incarnation}"
        evidence = [now.exhibit(topics.TRUTH, f"robot {robot} is {says}")]
        if robot in now.actions:
            evidence.append(now.status_of(robot))
        self._findings.report_state(FAULT_BIT, now.tick, (robot,), what, *evidence)

    def _judge_held(self, now: Snapshot) -> None:
        held = {
            robot for fault in self._script.in_force if fault.kind == "hold" for robot in fault.robots
        }
        for robot, presence in now.present.items():
            if presence.held != (robot in held):
                what = f"robot {robot} is {'held' if presence.held else 'not held'} against the script"
                said = now.exhibit(topics.TRUTH, f"held {presence.held}")
                self._findings.report_state(FAULT_BIT, now.tick, (robot,), what, said)

    # what happens to the air

    def _judge_air(self, now: Snapshot, truth: Truth) -> None:
        """The truth lists the cuts and jams of the script, and no others."""
        in_force = self._script.in_force
        cuts = [self._cut(fault) for fault in in_force if fault.kind == "cut"]
        jams = [_jam(fault) for fault in in_force if fault.kind == "jam"]
        self._compare(now, "cut", Counter(cuts), Counter(truth.cuts))
        self._compare(now, "jam", Counter(jams), Counter(truth.jams))

    def _compare(
        self, now: Snapshot, kind: str, due: Counter[Cut | Jam], found: Counter[Cut | Jam]
    ) -> None:
        for fault in due - found:
            what = f"a {kind} of the script is not in force: {fault}"
            said = now.exhibit(topics.TRUTH, f"no such {kind}")
            self._findings.report_state(FAULT_BIT, now.tick, _robots_of(fault), what, said)
        for fault in found - due:
            what = f"a {kind} is in force that the script does not have: {fault}"
            said = now.exhibit(topics.TRUTH, str(fault))
            self._findings.report_state(FAULT_BIT, now.tick, _robots_of(fault), what, said)

    def _cut(self, fault: FaultSection) -> Cut:
        others = fault.others or set(self._robots) - set(fault.robots)
        return Cut(side_a=tuple(sorted(set(fault.robots))), side_b=tuple(sorted(set(others))))

    def _track_cuts(self, truth: Truth) -> None:
        """Since when each pair of robots has been cut without a break [ns], sender first."""
        start_ns = truth.time_ns - self._period_ns
        self._cut_since = {
            pair: self._cut_since.get(pair, start_ns) for cut in truth.cuts for pair in _pairs(cut)
        }

    def _judge_carried(self, now: Snapshot, verdict: Verdict) -> None:
        """No hop of a message that arrived went over a cut."""
        is_broadcast = verdict.destination == BROADCAST
        one_hop_ns = self._airtimes.message_ns(verdict.msdu_bytes, is_broadcast, 1)
        hops = list(zip(verdict.path, verdict.path[1:], strict=False))
        for number, hop in enumerate(hops, start=1):
            since_ns = self._cut_since.get(hop)
            begin_ns = verdict.service_start_ns
            if number == len(hops):
                begin_ns = max(begin_ns, verdict.arrival_ns - one_hop_ns - _OVERHEAD_NS)
            if since_ns is not None and begin_ns >= since_ns:
                what = f"the cut between robots {hop[0]} and {hop[1]} carried a message"
                says = (
                    f"message {verdict.message} of robot {verdict.source} to robot {verdict.receiver} "
                    f"by {' '.join(map(str, verdict.path))}"
                )
                said = now.exhibit(topics.RADIO_RECORD, says)
                self._findings.report(FAULT_BIT, now.tick, hop, what, said)

    def _judge_jammed(self, now: Snapshot, truth: Truth, verdict: Verdict) -> None:
        """What arrives in a jam has no SNR that the jam would not leave it."""
        if len(verdict.path) < 2 or self._truth is None or not self._truth.jams:
            return
        sender, receiver = verdict.path[-2:]
        here, there = now.present.get(receiver), now.present.get(sender)
        if here is None or there is None:
            return
        rise_db = min(
            self._budget.jam_rise_db(one, here.pose.x, here.pose.y) for one in (truth, self._truth)
        )
        distance = math.hypot(here.pose.x - there.pose.x, here.pose.y - there.pose.y)
        fade_db = _SIGMAS * self._budget.shadowing_db + _MARGIN_DB
        most_db = self._budget.mean_snr_at(distance) - rise_db + fade_db
        if rise_db > 0.0 and verdict.snr_db > most_db:
            what = f"robot {receiver} is jammed and receives robot {sender} at {verdict.snr_db:.1f} dB"
            says = f"{distance:.1f} m, {rise_db:.1f} dB of jam: at most {most_db:.1f} dB"
            said = now.exhibit(topics.RADIO_RECORD, says)
            self._findings.report(FAULT_BIT, now.tick, (sender, receiver), what, said)


def _is_newer_process(presence: Presence | None, before: Presence | None) -> bool:
    if presence is None:
        return False
    return presence.incarnation > (before.incarnation if before is not None else 0)


def _jam(fault: FaultSection) -> Jam:
    return Jam(x=fault.x, y=fault.y, radius=fault.radius, noise_dbm=fault.noise_dbm)


def _pairs(cut: Cut) -> Iterable[tuple[int, int]]:
    for a in cut.side_a:
        for b in cut.side_b:
            if a != b:
                yield a, b
                yield b, a


def _robots_of(fault: Cut | Jam) -> tuple[int, ...]:
    return (*fault.side_a, *fault.side_b) if isinstance(fault, Cut) else ()
