"""The mission in real time: the page of onehop/drivers/inline.py by a schedule, with the newest data.

At the instant at which a tick is due the last one ends, with what robots have given by then. Nobody is
waited for: a robot that has given nothing goes on for a moment (core/command_hold.py), the radio follows
the clock by itself, and the record is put together when all of it is there.
"""

import time
from dataclasses import dataclass, field

from msgspec.structs import replace

from onehop.contracts import topics
from onehop.contracts.messages import Outcome, Truth
from onehop.contracts.operation import Punctuality
from onehop.node import startup
from onehop.wire.codec import encode
from world_server.core.command_hold import CommandHold
from world_server.core.world import World
from world_server.fault_orders import FaultOrders
from world_server.mailbox import Mailbox, MissionBrokenError
from world_server.progress import ProgressReports
from world_server.realtime.bases import RealTimeBases
from world_server.realtime.faults import RealTimeFaults
from world_server.realtime.radio import RealTimeRadio
from world_server.realtime.recording import RealTimeRecording
from world_server.realtime.robots import RealTimeRobots
from world_server.realtime.schedule import Schedule
from world_server.roll_call import RollCall

LEAD_S = 0.2
"""From the arrival of the last process to the first tick [s]."""

LAST_ACCOUNT_S = 2.0
"""How long the radio may take for the last tick, when the mission is over [s]."""


@dataclass(slots=True)
class RealTime:
    """One mission and everyone who takes part in it. unanswered: ticks of robots that gave nothing."""

    world: World
    mail: Mailbox
    roll: RollCall
    schedule: Schedule
    hold: CommandHold
    radio: RealTimeRadio
    robots: RealTimeRobots
    bases: RealTimeBases
    faults: RealTimeFaults
    orders: FaultOrders
    recording: RealTimeRecording
    progress: ProgressReports
    unanswered: int = field(default=0)

    def run(self) -> Outcome:
        """Tick until the mission has an outcome. Raises MissionBrokenError."""
        self.bases.await_all()
        self.schedule.start_s = time.monotonic() + LEAD_S
        self._wait_until(self.schedule.due_s(0))
        self.world.place(self.bases.take())
        if (no_start := self.world.no_start()) is not None:
            raise MissionBrokenError(no_start)
        self._begin(None)
        outcome = None
        while outcome is None:
            truth = self.world.truth()
            self._wait_until(self.schedule.due_s(truth.tick + 1))
            self._wait_for_who_is_out_of_sight()
            late_s = self.schedule.begin(truth.tick + 1, time.monotonic())
            self._end(truth)
            outcome = self.world.outcome()
            if outcome is None:
                self._begin(late_s)
        self.radio.place(self.world.truth())  # so that it accounts for the last tick
        last = self.world.tick - 1
        self.mail.wait(lambda: self.radio.last_tick >= last, LAST_ACCOUNT_S)
        return outcome

    def broken_off(self, reason: str) -> Outcome:
        """The account of a mission that is broken off now; its last tick is the last one recorded."""
        self.recording.hand_over()
        outcome = self.world.aborted(reason)
        return replace(outcome, ticks=min(outcome.ticks, self.recording.last_tick + 1))

    @property
    def punctuality(self) -> Punctuality:
        """How well the schedule was kept so far."""
        schedule = self.schedule
        return Punctuality(
            speed=schedule.speed,
            start_s=round(schedule.start_s, 6),
            late_ticks=schedule.late_ticks,
            latest_ms=round(1e3 * schedule.latest_s, 3),
            moved_ms=round(1e3 * schedule.moved_s, 3),
            unanswered=self.unanswered,
            unrecorded_ticks=self.recording.left_out,
        )

    def _wait_until(self, due_s: float) -> None:
        self.mail.wait(lambda: False, due_s - time.monotonic())

    def _wait_for_who_is_out_of_sight(self) -> None:
        """Without router or radio nobody can do anything: the tick lasts until all are back."""
        if self.roll.settle():
            return
        self.mail.wait(self.roll.settle, startup.REUNION_S)
        if self.roll.router_is_gone:
            raise MissionBrokenError(
                f"the router is gone, and did not come back within {startup.REUNION_S:g} s"
            )
        self.roll.give_up()
        self.radio.excuse()
        self.robots.excuse()
        self.bases.excuse()

    def _end(self, truth: Truth) -> None:
        """The tick of this truth ends with what has been given."""
        failed = self.faults.go_on()
        answers = self.robots.close(truth, self.faults.starting | failed.keys())
        self.unanswered += answers.unanswered
        self.recording.end(truth.tick, answers)
        actions, by_hand = self.hold.filled(truth, answers.actions), self.orders.take(self.world)
        self.world.advance(actions, by_hand, self.bases.take())
        for robot, why in sorted({**self.bases.fenced(truth), **answers.fenced, **failed}.items()):
            self.world.fence(robot, why)
        self.bases.drive(truth.tick, self.world.drives())
        self.orders.confirm(self.world)
        self.progress.report(truth, answers.actions, self.punctuality)

    def _begin(self, late_s: float | None) -> None:
        """The next tick begins: tell the radio, then everybody who is to answer."""
        truth = self.world.truth()
        self.faults.carry_out(truth, self.orders.arrived)
        self.radio.place(truth)
        observations = {robot: encode(seen) for robot, seen in self.world.observe().items()}
        self.robots.ask(truth, observations)
        said = [(topics.obs(robot), seen) for robot, seen in observations.items()]
        said += self.bases.record(truth.tick, truth.time_ns)
        self.recording.begin(truth.tick, [(topics.TRUTH, encode(truth)), *said])
        if late_s is not None:
            self.recording.note_late(truth.tick, late_s)
