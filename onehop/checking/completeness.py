"""`complete` and `digest`: whether all of the mission is in its log, once, and as it was recorded."""

from typing import Any

from onehop.checking.findings import Exhibit, Findings
from onehop.checking.invariants import COMPLETE, DIGEST
from onehop.checking.snapshot import Snapshot
from onehop.contracts import topics
from onehop.contracts.printable import printable
from onehop.contracts.sections import ClockSection
from onehop.wire.journal import Digest, WireMessage


class Completeness:
    """Every tick has its truth and radio record; of each running robot observation, inbox and action.

    One robot may lack an action: the one that was given up for it, which leaves with the next tick. In
    real time any robot may, and then it has no inbox either.
    """

    def __init__(self, findings: Findings, clock: ClockSection) -> None:
        self._findings = findings
        self._period_ns = clock.period_ns
        self._in_real_time = clock.is_realtime
        self._expected = 0
        self._without_action: dict[int, Exhibit] = {}

    def take(self, now: Snapshot) -> None:
        """One more tick."""
        if now.tick > self._expected:
            self._miss(self._expected, now.tick - 1)
        self._expected = now.tick + 1
        self._findings.count(COMPLETE)
        for key, what in now.flaws:
            self._report(now, _robots_of(key), f"{topics.wire(key)} {what}", now.exhibit(key, what))
        self._judge_departures(now)
        for key, value in ((topics.TRUTH, now.truth), (topics.RADIO_RECORD, now.record)):
            if value is None:
                self._report(
                    now, (), f"{topics.wire(key)} has no message", now.exhibit(key, "no message")
                )
            else:
                self._judge_time(now, key, value.time_ns)
        for presence in now.running():
            self._judge_robot(now, presence.robot)

    def _judge_robot(self, now: Snapshot, robot: int) -> None:
        mine = [
            (topics.obs(robot), now.observations.get(robot)),
            (topics.rx(robot), now.inboxes.get(robot)),
        ]
        if self._in_real_time:
            self._judge_answer(now, robot)
            mine.pop()
        for key, value in mine:
            if value is None:
                what = f"robot {robot} runs and has no message on {topics.wire(key)}"
                self._report(now, (robot,), what, now.exhibit(key, "no message"))
            else:
                self._judge_time(now, key, value.time_ns)
        if robot not in now.actions and not self._in_real_time:
            self._without_action[robot] = now.exhibit(topics.out(robot), "no message")

    def _judge_answer(self, now: Snapshot, robot: int) -> None:
        """An action and what its robot took in for it lie together, and are of one observation."""
        action, inbox = now.actions.get(robot), now.inboxes.get(robot)
        answered = None if action is None else action.tick
        heard = None if inbox is None else inbox.tick
        if answered != heard:
            what = f"robot {robot} answers tick {answered} with an inbox of tick {heard}"
            said = now.exhibit(topics.rx(robot), f"tick {heard}")
            self._report(now, (robot,), what, now.exhibit(topics.out(robot), f"tick {answered}"), said)
        elif inbox is not None and inbox.time_ns != inbox.tick * self._period_ns:
            self._report_time(now, topics.rx(robot), inbox.time_ns)

    def _judge_departures(self, now: Snapshot) -> None:
        """Whoever gave no action in the last tick has left in this one."""
        silent, self._without_action = self._without_action, {}
        if not now.follows or now.truth is None:
            return
        gone = {departure.robot for departure in now.truth.departures}
        for robot, exhibit in silent.items():
            if robot not in gone:
                what = f"robot {robot} gave no action and did not leave for it"
                self._findings.report(COMPLETE, now.tick - 1, (robot,), what, exhibit)

    def _judge_time(self, now: Snapshot, key: str, time_ns: int) -> None:
        if time_ns != now.tick * self._period_ns:
            self._report_time(now, key, time_ns)

    def _report_time(self, now: Snapshot, key: str, time_ns: int) -> None:
        what = f"{topics.wire(key)} says that it is {time_ns / 1e9:g} s"
        self._report(now, _robots_of(key), what, now.exhibit(key, f"time_ns {time_ns}"))

    def _miss(self, first: int, last: int) -> None:
        which = f"tick {first} is" if first == last else f"ticks {first} to {last} are"
        self._findings.report(COMPLETE, first, (), f"{which} missing")

    def _report(self, now: Snapshot, robots: tuple[int, ...], what: str, *exhibits: Exhibit) -> None:
        self._findings.report(COMPLETE, now.tick, robots, what, *exhibits)

    def finish(self, summary: dict[str, Any] | None) -> None:
        """No tick follows. summary: the outcome of a finished log."""
        if not self._expected:
            self._findings.report(COMPLETE, 0, (), "the log has not one tick")
        elif summary is not None and summary["ticks"] > self._expected:
            self._miss(self._expected, summary["ticks"] - 1)

    def on_end_of_reading(self, why: str) -> None:
        """The log cannot be read any further."""
        self._findings.report(COMPLETE, self._expected, (), f"the log cannot be read further: {why}")


class DigestCheck:
    """The digest over all messages, against the one that the mission had."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._sha = Digest()
        self._ticks = 0

    def take(self, tick: int, messages: list[WireMessage]) -> None:
        """The messages of one tick in canonical order."""
        self._sha.add(tick, messages)
        self._ticks = tick + 1

    def finish(self, summary: dict[str, Any] | None) -> None:
        """No tick follows. summary: the outcome of a finished log."""
        if summary is None:
            return
        self._findings.count(DIGEST)
        if summary["ticks"] < self._ticks:
            what = f"the log has {self._ticks} ticks, and its mission had {summary['ticks']}"
            self._findings.report(DIGEST, summary["ticks"], (), what)
        if summary["digest"] not in (None, self._sha.hex()):
            said = printable(summary["digest"], 64)
            what = f"the digest of its messages is {self._sha.hex()}, that of the mission was {said}"
            self._findings.report(DIGEST, max(0, self._ticks - 1), (), what)


def _robots_of(key: str) -> tuple[int, ...]:
    robot = key.partition("/")[2]
    return (int(robot),) if robot else ()
