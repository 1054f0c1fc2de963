"""`fault-bit`: every fault shows its effect, from the tick at which it begins to its end.

The truth tells which faults begin, by script, by hand, or after an event. Here it is held against the
scenario (what is due, begins), and against itself and the robots: a killed process is gone, a restarted
robot is another process, a stopped one says nothing, a held one is held, a blind one sees nothing, a
kidnapped one is elsewhere, and cuts, jams, corruptions and delays are in force exactly as long as they
are to be. What they do to messages is in fault_air.py, what to motors in motion.py.
"""

import math
from collections import Counter
from collections.abc import Iterable

import numpy as np

from onehop.checking.findings import Findings
from onehop.checking.invariants import FAULT_BIT
from onehop.checking.script import ForceField, Schedule, told
from onehop.checking.snapshot import Snapshot
from onehop.contracts import topics
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import Corruption, Cut, Jam, Presence, Slow, Truth
from onehop.contracts.scenario import Scenario

BESIDE = 20
"""Radii of the largest body within which a kidnapped robot is put down where somebody else stands."""

State = int | Cut | Jam | Corruption | Slow


class FaultBit:
    """Holds what the log shows against the faults that are to be in force."""

    def __init__(self, findings: Findings, scenario: Scenario) -> None:
        self._findings = findings
        self._schedule = Schedule(scenario.faults)
        self._force = ForceField()
        self._robots = scenario.team.robots
        self._period_ns = scenario.clock.period_ns
        self._beside = BESIDE * max(body.radius for body in scenario.bodies)
        self._before: dict[int, Presence] = {}
        self._killed: dict[int, int] = {}
        self._is_known = True

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        time_ns = now.tick * self._period_ns
        due = self._schedule.due(time_ns)
        truth = now.truth
        if truth is None or (now.tick > 0 and not now.follows):
            self._before, self._is_known = {}, False  # what began in ticks that are missing is not known
        if truth is None:
            return
        if now.follows or now.tick == 0:
            self._judge_due(now, truth, due)
        self._findings.count(FAULT_BIT, len(truth.faults))
        self._enforce(truth, time_ns)
        self._judge_processes(now, truth)
        self._judge_robots(now, truth)
        if self._is_known:
            for what, expected, found in self._states(now, truth):
                self._compare(now, what, list(expected), list(found))
        self._before = now.present

    def _judge_due(self, now: Snapshot, truth: Truth, due: list[FaultSection]) -> None:
        begun = [told(fault) for fault in truth.faults]
        for fault in due:
            if fault not in begun:
                what = f"a fault of the scenario does not begin: {_in_words(fault)}"
                said = now.exhibit(topics.TRUTH, f"{len(begun)} faults begin")
                self._findings.report(FAULT_BIT, now.tick, fault.robots, what, said)

    def _enforce(self, truth: Truth, time_ns: int) -> None:
        """Bring into force what begins."""
        self._force.expire(time_ns)
        ended: set[int] = set()
        for fault in truth.faults:
            self._force.begin(fault, time_ns)
            if fault.kind in ("kill", "restart"):
                for robot in fault.robots:
                    if fault.kind == "restart" or robot in self._before:
                        self._force.on_end_of_process(robot)
                        ended.add(robot)
        for departure in truth.departures:
            if departure.robot not in ended:
                self._force.on_end_of_process(departure.robot)

    # processes and robots

    def _judge_processes(self, now: Snapshot, truth: Truth) -> None:
        last = {
            robot: fault.kind
            for fault in truth.faults
            if fault.kind in ("kill", "restart")
            for robot in fault.robots
        }
        gone = {departure.robot for departure in truth.departures}
        for robot, kind in last.items():
            before, presence = self._before.get(robot), now.present.get(robot)
            if before is not None and robot not in gone:
                self._report_robot(now, robot, f"the {kind} of robot {robot} ended no process")
            if kind == "kill" and before is not None:
                self._killed[robot] = before.incarnation
            elif kind == "restart" and not _is_newer_process(presence, before):
                self._report_robot(now, robot, f"the restart of robot {robot} started no process")
        for robot, incarnation in self._killed.items():
            presence = now.present.get(robot)
            if presence is not None and presence.incarnation <= incarnation:
                self._report_robot(now, robot, f"robot {robot} was killed and takes part")
            elif presence is None and robot in now.actions:
                self._report_robot(now, robot, f"robot {robot} was killed and speaks")

    def _judge_robots(self, now: Snapshot, truth: Truth) -> None:
        for robot in truth.stopped:
            if robot in now.actions:
                self._report_robot(now, robot, f"robot {robot} is stopped and speaks")
        for robot in truth.blind:
            seen = now.observations.get(robot)
            if seen is not None and not np.isposinf(seen.scan).all():
                self._report_robot(now, robot, f"robot {robot} is blind and its laser sees something")
        for fault in truth.faults:
            presence = now.present.get(fault.robots[0]) if fault.kind == "kidnap" else None
            if presence is None:
                continue
            off = math.hypot(presence.pose.x - fault.x, presence.pose.y - fault.y)
            if off > self._beside:
                what = f"robot {presence.robot} is {off:.2f} m from where it was kidnapped to"
                self._report_robot(now, presence.robot, what)

    def _report_robot(self, now: Snapshot, robot: int, what: str) -> None:
        presence = now.present.get(robot)
        says = f"robot {robot} is absent"
        if presence is not None:
            x, y = presence.pose.x, presence.pose.y
            says = f"robot {robot} is present, incarnation {presence.incarnation}, at ({x:.2f}, {y:.2f})"
        evidence = [now.exhibit(topics.TRUTH, says)]
        if robot in now.actions:
            evidence.append(now.status_of(robot))
        self._findings.report_state(FAULT_BIT, now.tick, (robot,), what, *evidence)

    # what is in force

    def _states(
        self, now: Snapshot, truth: Truth
    ) -> Iterable[tuple[str, Iterable[State], Iterable[State]]]:
        """Each state that faults bring about: as it is to be, and as the truth has it."""
        force, present = self._force, now.present
        yield "hold", force.whom("hold") & present.keys(), (i for i in present if present[i].held)
        yield "stop", force.whom("stop") & present.keys(), truth.stopped
        yield "blindness", force.whom("blind") & present.keys(), truth.blind
        yield "delay", self._delays(), truth.slow
        yield "cut", map(self._cut, force.of_kind("cut")), truth.cuts
        yield "jam", map(_jam, force.of_kind("jam")), truth.jams
        yield "corruption", map(self._corruption, force.of_kind("corrupt")), truth.corruptions

    def _compare(self, now: Snapshot, what: str, expected: list[State], found: list[State]) -> None:
        if expected == found:
            return
        to_be, is_so = Counter(expected), Counter(found)
        for state in to_be - is_so:
            wrong = f"a {what} that is to be in force is not: {state}"
            said = now.exhibit(topics.TRUTH, f"no such {what}")
            self._findings.report_state(FAULT_BIT, now.tick, _robots_of(state), wrong, said)
        for state in is_so - to_be:
            wrong = f"a {what} is in force that nobody ordered, or that is over: {state}"
            said = now.exhibit(topics.TRUTH, str(state))
            self._findings.report_state(FAULT_BIT, now.tick, _robots_of(state), wrong, said)

    def _delays(self) -> Iterable[Slow]:
        delays: dict[int, int] = {}
        for fault in self._force.of_kind("slow"):
            for robot in fault.robots:
                delays[robot] = max(fault.delay_ticks, delays.get(robot, 0))
        return (Slow(robot, delay) for robot, delay in delays.items())

    def _cut(self, fault: FaultSection) -> Cut:
        mine = tuple(sorted(set(fault.robots)))
        others = tuple(sorted(set(fault.others) or set(self._robots) - set(mine)))
        if fault.direction == "to":
            return Cut(side_a=others, side_b=mine, one_way=True)
        return Cut(side_a=mine, side_b=others, one_way=fault.direction == "from")

    def _corruption(self, fault: FaultSection) -> Corruption:
        return Corruption(fault.robots or self._robots, fault.probability)


def _is_newer_process(presence: Presence | None, before: Presence | None) -> bool:
    if presence is None:
        return False
    return presence.incarnation > (before.incarnation if before is not None else 0)


def _jam(fault: FaultSection) -> Jam:
    return Jam(x=fault.x, y=fault.y, radius=fault.radius, noise_dbm=fault.noise_dbm)


def _robots_of(state: State) -> tuple[int, ...]:
    match state:
        case int():
            return (state,)
        case Cut():
            return (*state.side_a, *state.side_b)
        case Corruption():
            return state.robots
        case Slow():
            return (state.robot,)
        case Jam():
            return ()


def _in_words(fault: FaultSection) -> str:
    keys = {key: value for key, value in fault.given().items() if key != "at_s"}
    return ", ".join([fault.kind, *(f"{key} {value}" for key, value in keys.items())])
